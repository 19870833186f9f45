"""The doubled orbits of an oscillator that meets a second spring softly, from one doubling to the next."""

from __future__ import annotations

import math

import pytest
from hybrid_runs import diagram, machine
from test_loci_through_soft_transitions import FORCE, STATE, system

from contwalk.branch import Branch
from contwalk.system import Transition


def named(branch: Branch, label: str) -> list[float]:
    return [point.parameters["omega"] for point in branch.special_points if point.label == label]


@pytest.mark.slow
def test_they_end_where_they_are_single_again() -> None:
    parent, doubled = diagram(
        system("soft"),
        "omega",
        (0.45, 0.6),
        STATE,
        {"force": FORCE, "omega": 0.5},
        until="settled",
        events={"GR": "ignore"},
        follow=["PD"],
        depth=1,
        max_points=120,
    )
    first, second = named(parent, "PD")
    assert (doubled.outcome.reason, len(named(doubled, "LP"))) == ("rejoined", 0)
    (back,) = (point for point in doubled.special_points if point.label == "BP")
    assert doubled.info.parent[0] == parent.name
    (other,) = (point for point in parent.special_points if point.parameters["omega"] == second)
    assert abs(back.parameters["omega"] - second) <= back.error + other.error
    assert first < min(doubled["omega"][1:-1])


def stop(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = math.cos(p.omega * t) - 0.1 * x[1] - 21.0 * x[0]


def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = math.cos(p.omega * t) - 0.1 * x[1] - x[0]


def wall(t, x, p):
    return x[0]


def test_no_fold_lies_where_they_are_born_within_a_leg() -> None:
    """They begin in contact: the leg in the middle is their last one and their first one together.

    On steps that are not alike in both halves the pitchfork of orbits of two periods unfolds, and a fold lies
    2e-10 beside the doubling, within what both are known to.
    """
    bilinear = machine(
        ["q", "v"],
        {"omega": 1.2},
        {"free": free, "stop": stop},
        [
            Transition("touch", "free", "stop", wall, "rising", role="soft"),
            Transition("leave", "stop", "free", wall, "falling", role="soft"),
        ],
        period=lambda p: 2.0 * math.pi / p.omega,
    )
    parent, doubled = diagram(
        bilinear,
        "omega",
        (1.07, 1.2),
        [0.0, 0.0],
        mode="free",
        until="settled",
        accuracy=1e-8,
        follow=["PD"],
        depth=1,
    )
    assert len(named(parent, "PD")) == 1
    folds = named(doubled, "LP")
    assert max(folds, default=0.0) < named(parent, "PD")[0] - 1e-6
    assert list(doubled["unstable"][:8]) == [0] * 8
