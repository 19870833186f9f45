"""Marked periods of orbits: values and extrema of the duration, where it is known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, branch_of, machine
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import StartError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import Symmetry, System, Transition
from contwalk.verification.points import checked_point

MOST = 0.3  # where the pace w = 1 + (lam - 0.3)^2 is least, and the period largest
SLOWER = 1.5  # the pace at which the period is marked
RANGE = (-2.0, 2.5)


def pace(lam):
    return 1.0 + (lam - MOST) ** 2


def turning(t, x, p, dx):
    """The unit circle attracts, and is gone round in 2 pi / w."""
    growth, w = 1.0 - x[0] ** 2 - x[1] ** 2, pace(p.lam)
    dx[0] = growth * x[0] - w * x[1]
    dx[1] = w * x[0] + growth * x[1]


def inverted(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def cycle(closed_by_half: bool) -> System:
    symmetries = (Symmetry("inversion", "spatial", inverted),) if closed_by_half else ()
    return small_system(turning, "xy", {"lam": 0.0}, symmetries=symmetries)


def relaxation() -> System:
    """Rises at the rate 1.5 w, falls at the rate 3 w, between 0 and 1: the period is 1 / w."""

    def rises(t, x, p, dx):
        dx[0] = 1.5 * pace(p.lam) + 0.0 * x[0]

    def falls(t, x, p, dx):
        dx[0] = -3.0 * pace(p.lam) + 0.0 * x[0]

    return machine(
        ["x"],
        {"lam": 0.0},
        {"rise": rises, "fall": falls},
        [
            Transition("full", "rise", "fall", lambda t, x, p: 1.0 - x[0]),
            Transition("empty", "fall", "rise", lambda t, x, p: x[0]),
        ],
    )


def circle_in_halves() -> System:
    """`turning`, with a mode for either side of x = 0 and nothing that happens between them."""
    return machine(
        ["x", "y"],
        {"lam": 0.0},
        {"right": turning, "left": turning},
        [
            Transition("to_left", "right", "left", lambda t, x, p: x[0], role="soft"),
            Transition("to_right", "left", "right", lambda t, x, p: -x[0], role="soft"),
        ],
    )


def marks(whole: float) -> dict[str, list[float | str]]:
    return {"period": [whole / SLOWER, "extremum"]}


def check(branch: Branch, whole: float) -> None:
    """All marks of a branch whose closure lasts `whole` / w."""
    points = sorted(labelled(branch, "UZ"), key=lambda point: point.parameters["lam"])
    assert [point.kind for point in points] == ["observable", "extremum", "observable"]
    apart = math.sqrt(SLOWER - 1.0)
    for point, truth in zip(points, (MOST - apart, MOST, MOST + apart), strict=True):
        assert_met(point, "lam", truth)
        assert point.period == pytest.approx(branch["period"][point.index], rel=1e-15)  # legs added up
        assert point.period == pytest.approx(whole / pace(truth), rel=ACCURACY)


def verify(branch: Branch, system: System, whole: float) -> None:
    """Every mark is found again by another method."""
    for point in labelled(branch, "UZ"):
        again = checked_point(system, branch, point)
        assert not again.failed, again


@pytest.mark.drawn(1)
@pytest.mark.parametrize("half", [False, True])
def test_of_a_smooth_cycle(half: bool) -> None:
    """Of one that is closed up to a symmetry half the cycle counts, as in the column `period`."""
    system, full = cycle(half), 2.0 * math.pi
    whole = full / (2 if half else 1)
    problem = cw.PeriodicOrbit(system, {"lam": 0.0}, "lam", discretization=Discretization(accuracy=ACCURACY))
    branch = cw.continue_branch(problem, [1.0, 0.0], RANGE, marks=marks(whole), period=full / pace(0.0))
    assert branch.info.closure == ("inversion" if half else "full")
    check(branch, whole)
    verify(branch, system, whole)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("system", "state", "whole"),
    [(relaxation(), [0.5], 1.0), (circle_in_halves(), [1.0, 0.0], 2.0 * math.pi)],
    ids=["events", "soft"],
)
def test_of_a_machine_with_events(system: System, state: list[float], whole: float) -> None:
    branch = branch_of(system, "lam", RANGE, state, until="settled", marks=marks(whole))
    check(branch, whole)
    verify(branch, system, whole)


def swept() -> System:
    """A linear machine whose forcing goes on at the pace w."""

    def field(t, x, p, dx):
        dx[0] = -x[0] + np.cos(pace(p.lam) * t)

    return small_system(field, "x", {"lam": 0.0}, period=lambda p: 2.0 * math.pi / pace(p.lam))


def test_of_a_forced_machine_whose_period_is_a_function_of_the_parameter() -> None:
    whole, system = 2.0 * math.pi, swept()
    problem = cw.PeriodicOrbit(system, {"lam": 0.0}, "lam", discretization=Discretization(accuracy=ACCURACY))
    branch = cw.continue_branch(problem, [0.5], RANGE, marks=marks(whole), until="settled")
    check(branch, whole)


def test_a_forced_machine_whose_period_stands_still_has_no_such_mark() -> None:
    def field(t, x, p, dx):
        dx[0] = -x[0] + p.lam * np.cos(t)

    system = small_system(field, "x", {"lam": 1.0}, period=lambda p: 2.0 * math.pi)
    problem = cw.PeriodicOrbit(system, {"lam": 1.0}, "lam")
    wanted = {"period": [3.0, "extremum"]}
    branch = cw.continue_branch(problem, [0.5], (0.5, 2.0), marks=wanted, until="settled")
    assert branch.outcome.reason == "bound"
    assert not labelled(branch, "UZ")


def test_a_branch_ends_at_a_period() -> None:
    whole, apart = 2.0 * math.pi, math.sqrt(SLOWER - 1.0)
    problem = cw.PeriodicOrbit(cycle(False), {"lam": 0.0}, "lam")
    stop = {"period": (whole / SLOWER,)}
    branch = cw.continue_branch(problem, [1.0, 0.0], RANGE, period=whole / pace(0.0), stop_at=stop)
    assert branch.outcome.reason == "stop_at"
    assert branch["lam"][[0, -1]] == pytest.approx([MOST - apart, MOST + apart], rel=1e-9)


def test_equilibria_have_no_period() -> None:
    problem = small_problem(turning, "xy", {"lam": 0.0}, "lam")
    with pytest.raises(StartError, match="'period' is not watched"):
        cw.continue_branch(problem, [0.0, 0.0], RANGE, marks={"period": [1.0]})
