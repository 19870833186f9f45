"""Curves of period doublings through soft transitions: an oscillator that meets a second spring."""

from __future__ import annotations

from functools import cache

import pytest
from hybrid_runs import diagram
from loci_of_orbits import FINE
from test_loci_through_soft_transitions import FORCE, STATE, system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

pytestmark = pytest.mark.slow

RANGES = {"omega": (0.45, 0.6), "force": (0.4, 0.6)}
CUT = 0.52


@cache
def branch(force: float) -> Branch:
    """Orbits along the frequency, with the two doublings that bound an interval of doubled ones."""
    found = diagram(
        system("soft"),
        "omega",
        RANGES["omega"],
        STATE,
        {"force": force, "omega": 0.5},
        until="settled",
        events={"GR": "ignore"},
    )
    return found[0]


def doublings(of: Branch) -> list[SpecialPoint]:
    return sorted((p for p in of.special_points if p.label == "PD"), key=lambda p: p.parameters["omega"])


@pytest.mark.long
@pytest.mark.parametrize("which", [0, 1])
def test_the_curve_has_the_doublings_of_branches_at_other_forces(which) -> None:
    begun = doublings(branch(FORCE))[which]
    curve = cw.continue_locus(
        system("soft"),
        branch(FORCE),
        begun.name,
        RANGES,
        events={"GR": "ignore"},
        marks={"force": [CUT]},
        **FINE,
    )
    assert curve.info.settings["of"] == "PD"
    marked = [p for p in curve.special_points if p.label == "UZ"]
    alone = doublings(branch(CUT))
    assert marked
    for point in marked:
        near = min(alone, key=lambda p: abs(p.parameters["omega"] - point.parameters["omega"]))
        error = near.error + point.errors["omega"]
        assert abs(near.parameters["omega"] - point.parameters["omega"]) <= error < 1e-8
