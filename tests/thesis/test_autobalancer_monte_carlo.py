"""Fig. 17 of Paper 1: revolutions until the rotor stays balanced, over random loads and angles."""

from __future__ import annotations

import math

import pytest
from autobalancer_figures import RUNS

from contwalk.storage.trajectory import read_samples
from contwalk.workflow.run_file.sample import read_sampling
from contwalk.workflow.sampling import sample

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

# Verified means and their standard errors, 20 000 motions each.
VERIFIED = {1: (12.03, 0.055), 2: (9.352, 0.037), 3: (7.301, 0.015)}


@pytest.mark.parametrize("system", [*(pytest.param(system, marks=pytest.mark.long) for system in (1, 2)), 3])
def test_the_mean_is_the_verified_one(system, tmp_path):
    name = f"autobalancer_monte_carlo_system{system}"
    run = read_sampling(RUNS / f"{name}.yaml", output=str(tmp_path / "run.h5"))
    assert run.sampling.count == 10_000
    result = sample(run, figures=False)
    mean, error = VERIFIED[system]
    # Both means are random; three standard errors of their difference.
    assert abs(result.summary.mean - mean) < 3.0 * math.hypot(error, result.summary.error)
    # 10 000 samples against 20 000 of the same distribution
    assert result.summary.error == pytest.approx(error * math.sqrt(2.0), rel=0.1)
    assert result.summary.measured == 10_000
    assert result.summary.failed == 0
    stored = read_samples(result.files[0])
    assert stored.values.mean() == pytest.approx(result.summary.mean)
    # What is never settled has a load near zero, or near full load: both ends are slow.
    loads = stored.draws[~stored.settled, stored.drawn.index("m")] / 0.02
    assert ((loads < 0.06) | (loads > 0.99)).all()
    assert len(loads) == result.summary.never_settled


def test_the_table_names_the_run_files():
    table = (RUNS / "README.md").read_text(encoding="utf-8")
    for system in VERIFIED:
        assert f"| `autobalancer_monte_carlo_system{system}` |" in table
