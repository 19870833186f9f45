"""The doubled orbits of an oscillator that meets a second spring softly, from one doubling to the next."""

from __future__ import annotations

import pytest
from hybrid_runs import diagram
from test_loci_through_soft_transitions import FORCE, STATE, system

from contwalk.branch import Branch


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
