"""Spiking neurons with a reset whose period runs off where a saddle-node has gone. Limits in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from resets import study, told_limit

pytestmark = pytest.mark.slow

QUADRATIC = "dx[0] = x[0] ** 2 + p.I", "x_plus[0] = -1.0", "v", "{v: -0.9}"
# With u at 0.3 v the equilibria meet at v = 0.15, I = 0.15^2.
ADAPTING = (
    "dx[0] = x[0] ** 2 + p.I - x[1]; dx[1] = 2.0 * (0.3 * x[0] - x[1])",
    "x_plus[0] = -1.0; x_plus[1] = x[1] + 0.1",
    "vu",
    "{v: -0.9, u: 0.0}",
)
# (v + 65) / 10 - 0.2 exp((v + 50) / 2) is largest where exp(.) = 1, at v = -50: 1.5 - 0.2.
EXPONENTIAL = (
    "dx[0] = -(x[0] + 65.0) / 10.0 + 0.2 * math.exp((x[0] + 50.0) / 2.0) + p.I",
    "x_plus[0] = -60.0",
    "v",
    "{v: -60.0}",
)
# With w at 2 (V + 70), 12 (V + 70) - 20 exp((V + 50) / 2) is largest where exp(.) = 1.2.
ADAPTIVE_EXPONENTIAL = (
    "dx[0] = (-10.0 * (x[0] + 70.0) + 20.0 * math.exp((x[0] + 50.0) / 2.0) - x[1] + p.I) / 200.0; "
    "dx[1] = (2.0 * (x[0] + 70.0) - x[1]) / 30.0",
    "x_plus[0] = -58.0; x_plus[1] = x[1] + 10.0",
    "Vw",
    "{V: -60.0, w: 0.0}",
)


@pytest.mark.parametrize(
    ("machine", "value", "bounds", "peak", "limit"),
    [
        (QUADRATIC, 0.1, (-0.5, 0.2), 5.0, 0.0),
        pytest.param(ADAPTING, 0.1, (-0.5, 0.2), 5.0, 0.0225, marks=pytest.mark.long),
        pytest.param(EXPONENTIAL, 1.5, (-1.0, 1.6), -30.0, 1.3, marks=pytest.mark.long),
        pytest.param(
            ADAPTIVE_EXPONENTIAL,
            235.0,
            (50.0, 240.0),
            -30.0,
            240.0 + 24.0 * math.log(1.2) - 24.0,
            marks=pytest.mark.long,
        ),
    ],
    ids=["quadratic", "fast adaptation", "exponential", "adaptive exponential"],
)
def test_a_neuron_near_rheobase_ends_as_homoclinic(tmp_path, machine, value, bounds, peak, limit):
    branch = study(tmp_path, *machine, value, *bounds, peak, max_points=200)
    end = min((p for p in branch.special_points if p.label == "EP"), key=lambda p: p.parameters["I"])
    assert end.kind == "homoclinic", branch.outcome.message
    told, error = told_limit(branch)
    assert abs(told - limit) <= error
    assert error <= 1e-7 * max(limit, 1.0)
    assert branch["I"].min() > limit
    # The last steps grow the period by a tenth, as those of orbits without a spike do.
    periods = np.sort(branch["period"])
    assert np.all(periods[-20:] / periods[-21:-1] > 1.08)
    assert not [p for p in branch.special_points if p.kind == "unlocated"]


def test_far_out_the_period_is_that_of_the_closed_form(tmp_path):
    # v' = v^2 + I from -1 to 5 takes (atan(5 / k) + atan(1 / k)) / k with k = sqrt(I)
    branch = study(tmp_path, *QUADRATIC, 0.1, -0.5, 0.2, 5.0, max_points=200)
    root = np.sqrt(branch["I"])
    exact = (np.arctan(5.0 / root) + np.arctan(1.0 / root)) / root
    assert branch["period"].max() > 3e4
    # Where the parameter is far above its own error.
    known = branch["I"] > 1e-6
    assert branch["period"][known] == pytest.approx(exact[known], rel=1e-5)
