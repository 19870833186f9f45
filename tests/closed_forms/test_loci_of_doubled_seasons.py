"""Curves of doublings and tori of orbits that have been doubled before, in a seasonally forced food chain.

Prey and predator with a half saturation that the season moves: Kuznetsov, Muratori, Rinaldi, Int. J.
Bifurcation and Chaos 2 (1992) 117. Nothing of it is known in closed form, but what two curves have in common
must agree, multipliers at resonances are roots of one, and a curve is found once.
"""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied
from scipy.integrate import solve_ivp

pytestmark = [pytest.mark.slow, pytest.mark.long]

PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    b = p.b0 * (1.0 + p.eps * math.sin(2.0 * math.pi * t))
    eaten = 4.0 * math.pi * x[0] * x[1] / (b + x[0])
    dx[0] = 2.0 * math.pi * x[0] * (1.0 - x[0]) - eaten
    dx[1] = eaten - 2.0 * math.pi * x[1]

SYSTEM = System(
    "seasons",
    states=(State("prey", "", 1.0, "prey"), State("predator", "", 1.0, "predator")),
    parameters=(
        Parameter("b0", 0.45, "", (0.01, 1.0), "half saturation"),
        Parameter("eps", 0.4, "", (0.0, 2.0), "how much the season moves it"),
    ),
    modes=(Mode("field", field),),
    period=lambda p: 1.0,
)
"""
RUN = """
contwalk: 1
system: ./seasons.py
accuracy: 1e-8
start: {simulate: {state: {prey: 0.45, predator: 0.25}, until: settled}}
continue: {parameter: b0, range: [0.15, 0.6], direction: both, max_points: 110}
engine: {max_share: 0.03125}
diagram: {follow: [PD], depth: 2}
loci: {with: eps, range: [0.01, 1.0], of: [PD], follow: all}
figures: []
"""


@pytest.fixture(scope="module")
def branches(tmp_path_factory):
    """The curves of the study, by what they are of and how often the period is doubled."""
    _, found, _ = studied(tmp_path_factory.mktemp("seasons"), "seasons", PLUGIN, RUN)
    return [b for b in found if b.info.problem == "locus"]


def test_each_curve_is_followed_once(branches):
    """The doublings of the twice doubled orbit lie on one curve, whose points are known to 4e-6 only."""
    of = sorted((b.info.settings["of"], b.info.subharmonic) for b in branches)
    assert of == [("NS", 2), ("NS", 4), ("NS", 8), ("PD", 2), ("PD", 4)]


def test_nothing_is_told_but_resonances(branches):
    """Beside R2 and R3 the tori's coefficient is a small difference of large terms, and no zero of it is."""
    labels = {p.label for b in branches for p in b.special_points}
    assert labels == {"R1", "R2", "R3", "R4", "EP"}
    assert all(p.status == "located" for b in branches for p in b.special_points)


def test_points_on_two_curves_agree(branches):
    for times in (2, 4):
        doublings = _points(branches, "PD", times, "R2")
        tori = _points(branches, "NS", times, "R2")
        assert len(doublings) == 1
        apart = [
            max(
                abs(t.parameters[n] - doublings[0].parameters[n]) / (t.errors[n] + doublings[0].errors[n])
                for n in t.errors
            )
            for t in tori
        ]
        assert min(apart) <= 1.0


def test_multipliers_at_resonances_are_roots_of_one(branches):
    """By another integrator: SciPy's DOP853 at 1e-13, from the stored orbit."""
    for label, order in (("R3", 3), ("R4", 4)):
        (point,) = _points(branches, "NS", 2, label)
        multipliers = _multipliers(point, 2.0)
        np.testing.assert_allclose(multipliers**order, 1.0, atol=1e-7)


def _points(branches, of, times, label):
    chosen = [b for b in branches if (b.info.settings["of"], b.info.subharmonic) == (of, times)]
    return [p for b in chosen for p in b.special_points if p.label == label]


def _multipliers(point, period):
    p = point.parameters

    def field(t, y):
        x, v = y[:2], y[2:].reshape(2, 2)
        b = p["b0"] * (1.0 + p["eps"] * np.sin(2.0 * np.pi * t))
        share = 4.0 * np.pi / (b + x[0])
        eaten, by_prey, by_predator = share * x[0] * x[1], share * b * x[1] / (b + x[0]), share * x[0]
        a = np.array(
            [
                [2.0 * np.pi * (1.0 - 2.0 * x[0]) - by_prey, -by_predator],
                [by_prey, by_predator - 2.0 * np.pi],
            ]
        )
        dx = [2.0 * np.pi * x[0] * (1.0 - x[0]) - eaten, eaten - 2.0 * np.pi * x[1]]
        return np.concatenate([dx, (a @ v).ravel()])

    start = np.concatenate([[point.state[name] for name in ("prey", "predator")], np.eye(2).ravel()])
    end = solve_ivp(field, (0.0, period), start, method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    np.testing.assert_allclose(end[:2], start[:2], atol=1e-8)
    return np.linalg.eigvals(end[2:].reshape(2, 2))
