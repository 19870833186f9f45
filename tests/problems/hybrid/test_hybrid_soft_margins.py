"""Margins of legs that soft transitions cut into pieces, and guards that turn just where a piece ends.

A clock: a mass on a spring gets a kick k each time it passes its middle upwards, and a damper holds it while
it moves down, and only then. From the top A it falls to the depth A q, q = exp(-pi zeta / sqrt(1 - zeta^2)),
and without the damper passes the middle with the speed A q; so A = A q + k. It is lowest exactly where the
damper lets go.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, branch_of, diagram, machine, solution

from contwalk.problems.hybrid.limits import Limit
from contwalk.system import System, Transition

ZETA, GAP, TOP = 0.2, 1.0, 3.0
Q = math.exp(-math.pi * ZETA / math.sqrt(1.0 - ZETA**2))
TOUCHES = GAP * (1.0 - Q) / Q  # the kick with which the depth is the gap
WALKED = 100.0 * ACCURACY  # orbits are walked to a hundred times the accuracy


def free(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0]


def damped(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - 2.0 * ZETA * x[1]


def kick(t, x, p, after):
    after[0], after[1] = x[0], x[1] + p.k


def rebound(t, x, p, after):
    after[0], after[1] = x[0], -0.5 * x[1]


def clearance(t, x, p):
    return GAP + x[0]


def slack(t, x, p):
    return TOP - x[1]


def clock(stopped: Sequence[str]) -> System:
    """The clock with a stop below, met in some modes; in all of them the speed upwards is watched."""
    modes = {"low": free, "high": free, "falling": damped}
    return machine(
        ["x", "v"],
        {"k": 0.8 * TOUCHES},
        modes,
        [
            Transition("tick", "low", "high", lambda t, x, p: -x[0], reset=kick),
            Transition("damp", "high", "falling", lambda t, x, p: x[1], role="soft"),
            Transition("release", "falling", "low", lambda t, x, p: -x[1], role="soft"),
            *[Transition("stop", mode, "low", clearance, reset=rebound, level=True) for mode in stopped],
            *[Transition("fast", mode, mode, slack, role="watched") for mode in modes],
        ],
    )


def start(k: float) -> dict:
    return {"state": [0.0, k / (1.0 - Q)], "parameters": {"k": k}, "mode": "high"}


STOPPED = [("falling",), ("low",), ("falling", "low"), ("high", "falling", "low")]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("stopped", STOPPED)
def test_depth_is_seen_whatever_the_sign_of_rounding_where_the_damper_lets_go(stopped: Sequence[str]) -> None:
    system = clock(stopped)
    for k in np.linspace(0.3, 0.98, 12) * TOUCHES:
        problem, z = solution(system, "k", **start(float(k)))
        found = problem.margins(z).least("stop")
        assert abs(found - (GAP - Q * k / (1.0 - Q))) < WALKED, k


@pytest.mark.drawn(2)
@pytest.mark.parametrize("max_step", [0.1, 0.043, 0.0171])
@pytest.mark.parametrize("stopped", STOPPED)
def test_touching_the_stop_is_located_whatever_the_steps(stopped: Sequence[str], max_step: float) -> None:
    given = clock(stopped), "k", (0.9 * TOUCHES, 1.1 * TOUCHES)
    branch = branch_of(*given, **start(0.95 * TOUCHES), direction="up", max_step=max_step)
    (touch,) = [p for p in branch.special_points if p.label == "GR"]
    assert touch.kind == "interior"
    assert_met(touch, "k", TOUCHES)
    assert branch.outcome.reason == "grazing"
    assert np.all(branch["admissible"])


@pytest.mark.long
def test_a_limit_that_a_step_ends_at_is_told_once() -> None:
    # Sixteen steps of equal length in the parameter lead from the start to the limit.
    given = clock(("low",)), "k", (0.9 * TOUCHES, 1.1 * TOUCHES)
    branch = branch_of(*given, **start(0.95 * TOUCHES), events={"GR": "ignore"}, max_step=0.02)
    assert len([p for p in branch.special_points if p.label == "GR"]) == 1
    # No step ends where two sets of steps may see two signs: but for the point itself none is that near.
    assert np.sum(np.abs(branch["k"] / TOUCHES - 1.0) < 1e-6) == 1


@pytest.mark.drawn(1)
@pytest.mark.parametrize("stopped", STOPPED)
def test_beyond_it_orbits_are_told_not_admissible(stopped: Sequence[str]) -> None:
    given = clock(stopped), "k", (0.9 * TOUCHES, 1.1 * TOUCHES)
    branch = branch_of(*given, **start(0.95 * TOUCHES), events={"GR": "ignore"}, max_step=0.02)
    assert len([p for p in branch.special_points if p.label == "GR"]) == 1
    apart = branch["k"] / TOUCHES - 1.0
    sure = np.abs(apart) > 1e-7  # at the point itself it is zero to rounding
    assert np.array_equal(branch["admissible"][sure], apart[sure] < 0.0)
    assert sure.sum() > 10


def test_the_motion_that_meets_the_stop_goes_on_from_there_and_leads_back() -> None:
    given = clock(("falling",)), "k", (0.9 * TOUCHES, 1.2 * TOUCHES)
    options = {"direction": "up", "events": {"GR": "switch"}, "follow": ("GR",)}
    _, meets = diagram(*given, **start(0.95 * TOUCHES), **options)
    assert sorted(meets.info.signature) == ["stop", "tick"]
    (lost,) = [p for p in meets.special_points if p.label == "GR"]
    assert lost.kind == "terminal"
    assert_met(lost, "k", TOUCHES)
    # What lies beyond is looked at, although the damper lets go in the same instant.
    assert "cannot be taken up again" not in meets.outcome.message


def test_margins_at_the_start_and_the_end_of_a_leg_are_those_of_its_first_and_last_piece() -> None:
    k = 0.8 * TOUCHES
    top = k / (1.0 - Q)
    problem, z = solution(clock(()), "k", **start(k))
    margins = problem.margins(z)
    (leg,) = problem.itinerary.legs
    assert leg.name == "tick"
    for test, expected in (("start", TOP - top), ("end", TOP - Q * top)):
        value = margins.values[margins.limits.index(Limit("AZ", "fast", "fast", 0, test, False))]
        assert abs(value - expected) < WALKED


def test_a_watched_number_that_is_too_small_right_after_the_kick_is_located() -> None:
    limit = TOP * (1.0 - Q)
    branch = branch_of(clock(()), "k", (0.9 * limit, 1.1 * limit), **start(0.95 * limit), direction="up")
    (point,) = [p for p in branch.special_points if p.label == "AZ"]
    assert point.kind == "fast"
    assert_met(point, "k", limit)


def test_a_quiet_orbit_that_begins_where_a_guard_turns_has_its_margin() -> None:
    """Without damping the mass follows the force: it is nearest to the stop as the period begins."""

    def field(t, x, p, dx):
        dx[0], dx[1] = x[1], p.force * math.cos(p.omega * t) - x[0]

    omega = 0.6
    stop = Transition("stop", "free", "free", lambda t, x, p: 1.0 - x[0], reset=rebound)
    system = machine(
        ["x", "v"],
        {"force": 0.3, "omega": omega},
        {"free": field},
        [stop],
        period=lambda p: 2.0 * math.pi / p.omega,
    )
    for force in np.linspace(0.05, 0.6, 12):
        top = force / (1.0 - omega**2)
        problem, z = solution(system, "force", [top, 0.0], {"force": float(force)})
        assert abs(problem.margins(z).least("stop") - (1.0 - top)) < WALKED, force
