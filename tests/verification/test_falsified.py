"""Records that were changed by hand, all of which are told; and the same records as they are, which agree."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from falsifying import ends, points, rows
from hybrid_runs import branch_of, machine
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import Mode, Parameter, State, System, Transition
from contwalk.verification.checking import checked, records_of
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, Finding

RANGES = {"b": (-0.24, 1.0), "mu": (-0.3, 0.2), "a": (-3.0, 3.0), "lift": (1.1, 2.4), "r": (2.5, 3.4)}


def takens(t, x, p, dx):
    """Cycles of a Hopf point at b = 0 that end at a saddle's loop near b = 0.21."""
    dx[0] = x[1]
    dx[1] = -p.b - x[0] + x[0] ** 2 - x[0] * x[1]


def folding(t, x, p, dx):
    """r' = r (mu + r^2 - r^4): cycles from a Hopf point at 0, which fold at mu = -1/4."""
    r2 = x[0] ** 2 + x[1] ** 2
    growth = p.mu + r2 - r2**2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def ring(t, x, p, dx):
    """x^2 + a^2 = 1: a closed branch with two folds."""
    dx[0] = x[0] ** 2 + p.a**2 - 1.0


def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0


def height(t, x, p):
    return x[0] - p.lift * math.sin(t)


def bounce(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = p.lift * math.cos(t) - 0.5 * (x[1] - p.lift * math.cos(t))


BALL = machine(
    "yv",
    {"lift": 1.2},
    {"flight": fall},
    [
        Transition("impact", "flight", "flight", height, reset=bounce),
        Transition("ceiling", "flight", "flight", lambda t, x, p: 6.0 - x[0], role="watched"),
        Transition("speed", "flight", "flight", lambda t, x, p: 40.0 - x[1], role="watched"),
    ],
    period=lambda p: 2.0 * math.pi,
)


def logistic(t, x, p, x_plus):
    x_plus[0] = p.r * x[0] * (1.0 - x[0])


LOGISTIC = System(
    "logistic",
    states=(State("x"),),
    parameters=(Parameter("r", 2.8),),
    modes=(Mode("map", logistic, kind="map"),),
)


@pytest.fixture(scope="module")
def studies() -> list[tuple[System, list[Branch]]]:
    """Equilibria with their cycles, a closed branch, and a ball on a table that doubles its period."""
    found = []
    for field, states, free, start in ((takens, "xy", "b", 2 * [0.0]), (folding, "xy", "mu", 2 * [0.0])):
        system = small_system(field, states, {free: -0.1})
        rest = cw.Equilibrium(system, system.defaults(), free)
        branch = cw.continue_branch(rest, start, RANGES[free])
        found.append((system, [branch, cw.switch_branch(rest, branch, "HB1", range=RANGES[free])]))
    system = small_system(ring, "x", {"a": 0.0})
    rings = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "a"), [-1.0], RANGES["a"])
    cycles = branch_of(LOGISTIC, "r", RANGES["r"], [0.6], until=100.0)
    balls = branch_of(BALL, "lift", RANGES["lift"], [1.0, 3.0], until="settled", events={"GR": "ignore"})
    return [*found, (system, [rings]), (LOGISTIC, [cycles]), (BALL, [balls])]


def verdicts(system: System, branch: Branch, record: SpecialPoint | int) -> list[Finding]:
    """What is found of one record."""
    return checked(system, [(branch, record)], RANGES, math.inf)


def test_records_as_they_are_agree(studies):
    for system, branches in studies:
        for each in checked(system, records_of(branches), RANGES, 3.0):
            assert each.verdict == AGREES, each


def test_falsified_records_are_told(studies):
    count = 0
    for system, branches in studies:
        for branch in branches:
            wrong = [(what, branch, each) for p in branch.special_points for what, each in points(branch, p)]
            wrong += [(what, branch, each) for what, each in ends(branch)]
            wrong += [(what, changed, row) for what, changed, row in rows(branch)]
            for what, changed, record in wrong:
                found = verdicts(system, changed, record)
                # Of what was moved by some roundings it is told, too, that these cannot be told apart.
                told = [each.verdict == DISAGREES for each in found]
                assert any(told) or found[0].verdict == CANNOT_TELL, (what, found)
                count += 1
    assert count > 100


def test_multipliers_that_mean_nothing_are_not_agreed_with(studies):
    system, (branch,) = studies[-1]
    (point,) = labelled(branch, "PD")
    (found,) = verdicts(system, branch, replace(point, trivial_error=0.77))
    assert (found.verdict, "off by 0.77" in found.reason) == (CANNOT_TELL, True)


def test_a_branch_that_has_just_begun_is_not_closed(studies):
    """Newton's method goes back from its last row to its start, which is near, but behind it."""
    system, (branch,) = studies[2]
    (end,) = labelled(branch, "EP")
    assert end.kind == "closed"
    short = replace(branch, points=branch.points[:3])
    (found,) = verdicts(system, short, replace(end, index=2, s=short.points["s"][-1]))
    assert (found.verdict, found.reason) == (DISAGREES, "its last step leads away from its start")


def test_cycles_of_maps_are_iterated(studies):
    system, (branch,) = studies[-2]
    (point,) = labelled(branch, "PD")  # at r = 3
    found = verdicts(system, branch, point) + verdicts(system, branch, 1)
    assert {(each.method, each.verdict) for each in found} == {("iteration", AGREES)}
    assert abs(found[0].recomputed - 3.0) <= 1e-12


def test_a_row_that_claims_more_than_a_check_sees_is_not_agreed_with(studies):
    """The second computation is known to its tolerance, whatever the row says."""
    system, (branch,) = studies[-1]
    assert verdicts(system, branch, 5)[0].verdict == AGREES
    points_ = branch.points.copy()
    points_["error"][5] = 0.0
    found = verdicts(system, replace(branch, points=points_), 5)[0]
    assert (found.verdict, "only" in found.reason) == (CANNOT_TELL, True), found
