"""Curves of orbits go on where two of their events change their order, if these commute; else they end there.

A quantity decays slowly until the phase phi and fast after it, and once a second it becomes r x (1 - x); at
half time something else is counted. Its multiplier is 2 - r exp(phi - 2), whichever of hurrying and counting
comes first: doublings lie at r = 3 exp(2 - phi), with a change of order at phi = 1/2.

Two quantities that push each other do not commute: doublings of one order are elsewhere than those of the
other.
"""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import WALKED, parameters_of, studied

COMMUTING = """
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

TURN = 2.0 * np.pi


def slow(t, x, p, dx):
    dx[0], dx[1] = -x[0], -x[1]


def fast(t, x, p, dx):
    dx[0], dx[1] = -2.0 * x[0], -x[1]


def counted(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], x[1] + 1.0


def grown(t, x, p, x_plus):
    x_plus[0], x_plus[1] = p.r * x[0] * (1.0 - x[0]), x[1]


def half(t, x, p):
    return -np.sin(TURN * t)


SYSTEM = System(
    "commuting",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 13.6), Parameter("phi", 0.46)),
    modes=(Mode("slow", slow), Mode("fast", fast)),
    transitions=(
        Transition("grows", "fast", "slow", lambda t, x, p: np.sin(TURN * t), "rising", reset=grown),
        Transition("hurries", "slow", "fast", lambda t, x, p: np.sin(TURN * (t - p.phi)), "rising"),
        Transition("counts", "slow", "slow", half, "rising", reset=counted),
        Transition("counts", "fast", "fast", half, "rising", reset=counted),
    ),
    period=lambda p: 1.0,
)
"""
ALONG_R = """
contwalk: 1
system: ./commuting.py
accuracy: 1e-9
start: {simulate: {state: {x: 0.6, y: 1.0}, until: settled}}
continue: {parameter: r, range: [12.5, 14.5], direction: up}
diagram: none
loci: {with: phi, range: [0.44, 0.56], of: [PD], follow: none}
"""
PUSHING = """
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

TURN = 2.0 * np.pi


def relaxing(t, x, p, dx):
    dx[0], dx[1] = 1.0 - x[0], 1.0 - x[1]


def first(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0] + 0.5 * (x[1] - 1.0), x[1]


def second(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], x[1] + 0.5 * (x[0] - 1.0)


def turned(t, x, p, x_plus):
    off = x[0] - 1.0
    x_plus[0], x_plus[1] = 1.0 - p.c * off + 0.3 * off**3, 1.0 + 0.5 * (x[1] - 1.0)


def push(t, x, p):
    return np.sin(TURN * (t - p.phi))


SYSTEM = System(
    "pushing",
    states=(State("x"), State("y")),
    parameters=(Parameter("c", 2.6), Parameter("phi", 0.46)),
    modes=(Mode("only", relaxing),),
    transitions=(
        Transition("first", "only", "only", push, "rising", reset=first),
        Transition("second", "only", "only", lambda t, x, p: -np.sin(TURN * t), "rising", reset=second),
        Transition("turns", "only", "only", lambda t, x, p: np.sin(TURN * t), "rising", reset=turned),
    ),
    period=lambda p: 1.0,
)
"""
ALONG_C = """
contwalk: 1
system: ./pushing.py
accuracy: 1e-9
start: {simulate: {state: {x: 1.1, y: 0.9}, until: settled}}
continue: {parameter: c, range: [2.5, 3.0], direction: up}
diagram: none
loci: {with: phi, range: [0.44, 0.56], of: [PD], follow: none}
"""


def curves(found):
    """The curves in two parameters of a study."""
    return [branch for branch in found if branch.info.problem == "locus"]


def test_doublings_go_on_with_the_other_order(tmp_path):
    _, found, _ = studied(tmp_path, "commuting", COMMUTING, ALONG_R)
    one, other = curves(found)
    assert [np.ptp(b["phi"]) for b in (one, other)] == pytest.approx([0.06, 0.06], abs=1e-8)
    assert one.info.settings["of"] == other.info.settings["of"] == "PD"
    for curve in (one, other):
        truth = 3.0 * np.exp(2.0 - curve["phi"])
        assert np.max(np.abs(curve["r"] / truth - 1.0)) < WALKED  # the accuracy of steps of a walk
    (place,) = parameters_of(one, "OC")
    assert place == pytest.approx((3.0 * np.exp(1.5), 0.5), rel=1e-9)  # the accuracy that is asked for
    assert other.outcome.reason == "bound"
    assert float(other["phi"].max()) == pytest.approx(0.56)


@pytest.mark.long
def test_curves_whose_multipliers_jump_end_there(tmp_path):
    _, found, _ = studied(tmp_path, "pushing", PUSHING, ALONG_C)
    (curve,) = curves(found)
    inverse = np.exp(-1.0)
    truth = (1.0 + 0.625 * inverse) / (inverse + 0.5 * inverse**2)
    assert np.max(np.abs(curve["c"] / truth - 1.0)) < WALKED
    assert curve.outcome.reason == "order_change"
    assert "No curve goes on beyond it" in curve.outcome.message
    assert "their multipliers are others" in curve.outcome.message
