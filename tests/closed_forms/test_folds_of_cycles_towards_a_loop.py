"""Folds of cycles from a generalized Hopf point towards a homoclinic loop, where orbits are cut on the way.

Wilson and Cowan's pair of populations with the numbers of Hoppensteadt and Izhikevich, Weakly Connected
Neural Networks (1997), section 2.2. It is its own image: (E, I, P, Q) -> (1 - E, 1 - I, -P, -12 - Q).
"""

from __future__ import annotations

import numpy as np
import pytest
from demo_ab import AB
from loci_of_orbits import studied
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.slow

PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = -x[0] + 1.0 / (1.0 + math.exp(-(10.0 * x[0] - 10.0 * x[1] + p.P)))
    dx[1] = -x[1] + 1.0 / (1.0 + math.exp(-(10.0 * x[0] + 2.0 * x[1] + p.Q)))

SYSTEM = System(
    "populations",
    states=(State("E", "", 1.0, "excitatory"), State("I", "", 1.0, "inhibitory")),
    parameters=(
        Parameter("P", 0.0, "", (-100.0, 100.0), "input"),
        Parameter("Q", 0.0, "", (-100.0, 100.0), "input"),
    ),
    modes=(Mode("field", field),),
)
"""
RUN = """
contwalk: 1
system: ./populations.py
start: {simulate: {state: {E: 0, I: 0}, until: settled}}
parameters: {P: -8, Q: -6}
continue: {parameter: P, range: [-10, 10], max_points: 250}
diagram: {follow: none}
loci: {with: Q, range: [-12, 4], of: [LP], follow: all}
figures: []
"""
AB_RUN = """
system: ./ab.py
start: {state: {u1: 0.0, u2: 0.0}}
parameters: {p2: 14.0}
continue: {parameter: p1, range: [0.0, 2.0]}
diagram: {follow: none, depth: 2}
loci: {with: p2, range: [2.0, 30.0], of: [HB], follow: [GH]}
figures: []
"""


@pytest.mark.long
def test_folds_end_where_they_come_to_a_loop(tmp_path):
    """They went back to where they began, told as `shrunk`; or jumped to what is no solution, `rejoined`; or
    crept to and fro, and had used up 250 points at P = 3.787 and -3.774.

    The folds end on a homoclinic orbit whose saddle is neutral, where P is 3.71: the period grows like one
    over the distance from there.
    """
    _, found, _ = studied(tmp_path, "populations", PLUGIN, RUN)
    folds = [b for b in found if b.info.settings.get("of_problem") == "periodic_orbit"]
    assert [curve.outcome.reason for curve in folds] == ["homoclinic", "homoclinic"]
    for curve in folds:
        assert len(curve.points) < 100  # 51 and 60; 250 where they crept
        period = curve.points["period"]
        assert len(curve.unknowns(len(curve.points) - 1)) > len(curve.unknowns(0))  # cut on the way
        assert np.all(np.diff(period) > 0.0)
        assert period[-1] > 20.0
        assert abs(curve["P"][-1]) > 3.71


@pytest.mark.long
def test_folds_along_a_canard_are_followed_on_finer_steps_in_more_segments(tmp_path):
    """Deviations grow by 1e8 there, and the folds crept in steps of 1e-3 and less, to a period of 13."""
    _, found, _ = studied(tmp_path, "ab", AB, AB_RUN)
    (curve,) = [b for b in found if b.info.settings.get("of_problem") == "periodic_orbit"]
    assert curve.outcome.reason == "no_convergence"
    assert "however fine the steps are" in curve.outcome.message
    period = curve.points["period"]
    assert len(curve.points) < 250  # 160
    assert period[-1] > 16.0
    assert np.nanmax(curve.points["error"][period > 4.0]) < 0.02  # ended at a hundredth; it was 1.4
    row = int(np.argmin(np.abs(period - 12.0)))
    gap, determinant = _returned(curve, row)
    assert gap < 1e-3  # 1e-10 of the steps here grows by 1e7 on the way
    assert abs(np.log(determinant)) < 1e-3  # both multipliers are one, to what the orbit is known to


def _returned(curve, row: int) -> tuple[float, float]:
    """How far the orbit of a row misses itself, and the product of its multipliers, by SciPy's DOP853."""
    p1, p2 = curve["p1"][row], curve["p2"][row]

    def field(t, y):
        e = np.exp(y[1])
        rate = p1 * (1.0 - y[0]) * e
        divergence = -1.0 - p1 * e - 4.0 + p2 * rate
        return [-y[0] + rate, -4.0 * y[1] + p2 * rate, divergence]

    state = [*(curve["u1"][row], curve["u2"][row]), 0.0]
    end = solve_ivp(field, (0.0, curve.points["period"][row]), state, method="DOP853", rtol=1e-13, atol=1e-15)
    last = end.y[:, -1]
    return float(np.abs(last[:2] - state[:2]).max()), float(np.exp(last[2]))
