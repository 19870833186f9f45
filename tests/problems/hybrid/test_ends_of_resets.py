"""Where families of orbits with a reset end: beside an equilibrium, or in no time. Closed forms."""

from __future__ import annotations

import re

import pytest
from resets import study, told_limit

SADDLE = "dx[0] = x[0]; dx[1] = -2.0 * x[1]", "x_plus[0] = p.I + 0.5 * x[1]; x_plus[1] = 1.0"


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("machine", "limit"),
    [
        # v' = I - v fires at 1: T = ln(I / (I - 1)), and the equilibrium I reaches the threshold at I = 1
        (("dx[0] = p.I - x[0]", "x_plus[0] = 0.0", "v", "{v: 0.1}", 1.5, 0.5, 2.0, 1.0), 1.0),
        # v' = v^2 + I, reset to 1/2: the unstable equilibrium sqrt(-I) reaches the reset at I = -1/4
        (("dx[0] = x[0] ** 2 + p.I", "x_plus[0] = 0.5", "v", "{v: 0.6}", 0.5, -0.5, 1.0, 5.0), -0.25),
        # x' = x, y' = -2 y, reset to (I + y / 2, 1): I = u - u^2 / 2 with u = exp(-T)
        ((*SADDLE, "xy", "{x: 0.2, y: 1.0}", 0.2, -0.2, 0.3, 1.0), 0.0),
    ],
    ids=["leaky", "quadratic", "saddle"],
)
def test_a_reset_beside_an_equilibrium_ends_as_homoclinic(tmp_path, machine, limit):
    branch = study(tmp_path, *machine)
    end = min((p for p in branch.special_points if p.label == "EP"), key=lambda p: p.parameters["I"])
    assert end.kind == "homoclinic"
    value, error = told_limit(branch)
    assert abs(value - limit) <= error
    assert error < 1e-7  # on the finest steps; deviations grow like exp(T)
    assert branch["I"].min() > limit
    assert not [p for p in branch.special_points if p.kind == "unlocated"]


def test_events_that_come_to_follow_at_once_end_as_shrunk(tmp_path):
    # the saddle above: T = 0, u = 1 at I = 1/2
    branch = study(tmp_path, *SADDLE, "xy", "{x: 0.2, y: 1.0}", 0.2, 0.1, 0.6, 1.0)
    end = max((p for p in branch.special_points if p.label == "EP"), key=lambda p: p.parameters["I"])
    assert end.kind == "shrunk"
    found = re.search(r"near I = (\S+) \+- ([^\s:]+):", branch.outcome.message)
    assert found, branch.outcome.message
    assert abs(float(found[1]) - 0.5) <= float(found[2]) <= 1e-6
    assert abs(branch["I"].max() - 0.5) < 1e-3  # T, and with it the way to 1/2, is the last step's


def test_a_guard_right_before_a_pole_is_told(tmp_path):
    # An adaptive exponential neuron that fires at 0 mV: the pole is 3e-10 ms later, 2 / (0.1 exp(25))
    field = (
        "dx[0] = (-10.0 * (x[0] + 70.0) + 20.0 * math.exp((x[0] + 50.0) / 2.0) - x[1] + p.I) / 200.0; "
        "dx[1] = (2.0 * (x[0] + 70.0) - x[1]) / 30.0"
    )
    reset = "x_plus[0] = -58.0; x_plus[1] = x[1] + 60.0"
    branch = study(tmp_path, field, reset, "Vw", "{V: -60.0, w: 0.0}", 500.0, 400.0, 600.0, 0.0)
    assert branch.outcome.status == "failed"
    assert "after 'spike', as a spike does that runs to a pole" in branch.outcome.message
    assert "Let the guard act earlier" in branch.outcome.message
