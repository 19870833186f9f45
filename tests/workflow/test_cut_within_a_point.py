"""Runs that are cut between a special point's row and its record go on to the same diagram, bit by bit."""

from __future__ import annotations

import shutil

import pytest
from killed_runs import FORK_PLUGIN, assert_same

from contwalk.storage.records import RecordLog
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

pytestmark = pytest.mark.slow

# Several points lie on one step, at the start, beside the pitchfork, and on both halves that it bears.
FORK = """
system: ./fork.py
start: {state: {x: 0.0, y: -0.5}}
continue: {parameter: mu, range: [-0.6, 0.4]}
mark: {mu: [-0.5, 0.001, 0.0013, 0.1], max_re: [-0.001]}
engine: {step: 0.05}
"""
ORBITS = """
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.0030, 0.0065], direction: backward, max_points: 30}
diagram: {follow: [HB, PD], depth: 2}
mark: {delta: [0.0045]}
"""
WHEEL = """
system: rimless_wheel
parameters: {gamma: 0.1}
start: {simulate: {state: {theta: -0.2, omega_: 1.5}, until: settled}}
continue: {parameter: gamma, range: [0.08, 0.12], max_points: 12}
mark: {gamma: [0.09, 0.1, 0.11]}
"""


@pytest.mark.parametrize("study", [FORK, ORBITS, WHEEL], ids=["fork", "orbits", "wheel"])
def test_a_special_point_without_its_record_is_found_again(tmp_path, monkeypatch, study):
    (tmp_path / "fork.py").write_text(FORK_PLUGIN, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(study, encoding="utf-8")
    whole, cuts, append = tmp_path / "whole.h5", [], RecordLog.append

    def copied_before(log, records):
        if "record" in (log.dtype.names or ()):
            cuts.append(tmp_path / f"cut{len(cuts)}.h5")
            shutil.copyfile(whole, cuts[-1])
        append(log, records)

    with monkeypatch.context() as patch:
        patch.setattr(RecordLog, "append", copied_before)
        run(read_run_file(tmp_path / "run.yaml", output=str(whole)), figures=False)
    assert len(cuts) >= 3
    for cut in cuts:
        run(read_run_file(tmp_path / "run.yaml", output=str(cut)), figures=False, resume=True)
        assert_same(whole, cut)
