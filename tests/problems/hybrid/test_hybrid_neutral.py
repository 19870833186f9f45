"""Families of orbits: a wheel that may stand anywhere along its slope, and goes on along it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, branch_of, machine, opened

from contwalk.diagram.opening import Opening
from contwalk.system import Neutral, System, Transition

WALKED = 100.0 * ACCURACY


def wheel(position: bool) -> System:
    """A rimless wheel; with its position s, which grows by the rolling and that nothing depends on."""

    def roll(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = math.sin(x[0])
        if position:
            dx[2] = x[1] * math.cos(x[0]) - 0.3 * (x[2] - x[2])

    def strike(t, x, p, after):
        after[0] = x[0] - 0.8
        after[1] = 0.7 * x[1]
        if position:
            after[2] = x[2] - 2.0 * math.sin(0.4) * math.cos(p.gamma)  # the hub, from the foot that stands

    def along(t, x, p, v):
        v[0], v[1], v[2] = 0.0, 0.0, 1.0

    return machine(
        ["theta", "omega_", "s"] if position else ["theta", "omega_"],
        {"gamma": 0.15},
        {"rolling": roll},
        [Transition("strike", "rolling", "rolling", lambda t, x, p: p.gamma + 0.4 - x[0], reset=strike)],
        neutral=(Neutral("slide", along),) if position else (),
    )


def test_the_place_along_the_slope_is_held():
    """s is the same after a step, wherever it began: a multiplier one, which is left out of the spectrum."""
    without = branch_of(wheel(False), "gamma", (0.14, 0.2), [-0.25, 0.4], until="settled")
    for place in (0.0, 3.0):
        branch = branch_of(wheel(True), "gamma", (0.14, 0.2), [-0.25, 0.4, place], until="settled")
        assert branch.outcome.reason == "bound"
        assert branch.points["spectrum"].shape[1] == 1
        np.testing.assert_allclose(branch.points["spectrum"][:, 0], 0.49, rtol=0, atol=10.0 * WALKED)
        assert np.all(branch["unstable"] == 0)
        ends = [branch["period"][0], branch["period"][-1]]
        assert sorted(ends) == pytest.approx(
            sorted([without["period"][0], without["period"][-1]]), rel=WALKED
        )


def marked(slope: float, drag: float = 0.0) -> System:
    """The wheel with its place s, whose `strike` depends on it where slope > 0; fields do where drag > 0."""

    def roll(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = math.sin(x[0])
        dx[2] = -drag * x[2]

    def strike(t, x, p, after):
        after[0] = x[0] - 0.8
        after[1] = 0.7 * x[1]
        after[2] = (1.0 - slope) * x[2]

    def along(t, x, p, v):
        v[0], v[1], v[2] = 0.0, 0.0, 1.0

    return machine(
        ["theta", "omega_", "s"],
        {"gamma": 0.15},
        {"rolling": roll},
        [Transition("strike", "rolling", "rolling", lambda t, x, p: p.gamma + 0.4 - x[0], reset=strike)],
        neutral=(Neutral("slide", along),),
    )


@pytest.mark.parametrize(("slope", "drag", "told"), [(0.5, 0.0, True), (0.0, 0.0, False), (0.5, 0.1, False)])
def test_a_direction_that_an_event_breaks_is_told_once(slope, drag, told):
    """Where fields break it as well, as a parameter may make them, it was not meant to be neutral there."""
    found = opened(marked(slope, drag), "gamma", [-0.25, 0.4, 0.5], until="settled")
    assert isinstance(found, Opening)
    sentence = "The direction 'slide' is not neutral on this branch: 'strike' breaks it"
    assert found.message.count(sentence) == int(told)
    assert len(found.problem.pins) == int(not slope)
    if told:
        assert "test_hybrid_neutral.py, line " in found.message
