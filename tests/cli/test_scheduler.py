"""`--scheduler`: a cluster of dask.distributed computes; what it cannot do is told."""

from __future__ import annotations

import importlib.util

import pytest
from test_margins import made_oscillator, oscillator

__all__ = ["made_oscillator", "oscillator"]


def test_without_the_extra_it_says_what_to_install(contwalk, oscillator, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "distributed" else found(name)
    )
    done = contwalk("margins", "oscillator.yaml", "--scheduler", "tcp://127.0.0.1:1")
    assert done.code == 2
    assert "contwalk[distributed]" in done.err
    assert not list(oscillator.glob("*_margins.h5"))


def test_what_is_no_address_is_told_before_anything_is_tried(contwalk, oscillator):
    done = contwalk("margins", "oscillator.yaml", "--scheduler", "nonsense")
    assert done.code == 2
    assert "it names no port" in " ".join(done.err.split())
    assert "Traceback" not in done.err


def test_processes_here_beside_a_cluster_are_refused(contwalk, oscillator):
    done = contwalk("margins", "oscillator.yaml", "--scheduler", "tcp://127.0.0.1:1", "--jobs", "2")
    assert done.code == 2
    assert "Give one of them" in done.err


class Backwards:
    """Computes the last task first, and each twice, as a cluster may that has lost a worker."""

    def map(self, function, tasks):
        found = {k: (function(task), function(task))[1] for k, task in reversed(list(enumerate(tasks)))}
        return [found[k] for k in sorted(found)]


def test_any_object_with_map_leaves_the_same_bytes(contwalk, oscillator):
    from contwalk.workflow.margins import margins
    from contwalk.workflow.run_file.margins import read_margins

    assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 0
    files = [oscillator / f"oscillator_margins.{suffix}" for suffix in ("h5", "csv")]
    whole = [file.read_bytes() for file in files]
    margins(read_margins("oscillator.yaml"), executor=Backwards(), force=True, figures=False)
    assert [file.read_bytes() for file in files] == whole


def test_a_cluster_leaves_the_same_bytes_with_a_worker_killed(contwalk, oscillator):
    """Runs where the extra is installed."""
    distributed = pytest.importorskip("distributed")
    assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 0
    whole = (oscillator / "oscillator_margins.h5").read_bytes()
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        cluster.workers[0].process.process.kill()
        done = contwalk(
            "margins", "oscillator.yaml", "--no-figures", "--force", "--scheduler", cluster.scheduler_address
        )
    assert done.code == 0
    assert (oscillator / "oscillator_margins.h5").read_bytes() == whole
