"""Curves along which orbits lose a symmetry: half an orbit is a map whose curves are known."""

from __future__ import annotations

import pytest
from loci_of_orbits import assert_at, henon_fixed_point, labels, studied

from contwalk.branch import Branch

pytestmark = pytest.mark.slow

# Kicked forth and back, x -> -s H(s x) with s = 1, -1, 1, ...: half an orbit is a fixed point of H, which is
# Henon's map with a third state that is multiplied by m = -0.9 - 0.2 al.
PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

def still(t, x, p, dx):
    dx[0] = 0.0 * x[0]
    dx[1] = 0.0 * x[1]
    dx[2] = 0.0 * x[2]

def clock(t, x, p):
    return (t % 1.0) - 0.5

def kick(t, x, p, x_plus):
    s = math.cos(math.pi * (t - 0.5))
    x_plus[0] = -x[1]
    x_plus[1] = -s * (p.al - p.be * s * x[0] - x[1] * x[1])
    x_plus[2] = (0.9 + 0.2 * p.al) * x[2] - x[2] ** 3

def inversion(t, x, p, image):
    image[0], image[1], image[2] = -x[0], -x[1], -x[2]

SYSTEM = System(
    "forth_and_back",
    states=(State("x", scale=1.0), State("y", scale=1.0), State("z", scale=1.0)),
    parameters=(Parameter("al", 0.2), Parameter("be", 0.5)),
    modes=(Mode("still", still),),
    transitions=(Transition("kick", "still", "still", clock, "rising", reset=kick),),
    symmetries=(Symmetry("inversion", "spatial", inversion),),
    period=lambda p: 2.0,
)
"""
RUN = """
system: ./halves.py
accuracy: 1e-10
start: {{simulate: {{state: {{x: {x}, y: {x}, z: 0}}, until: 0}}}}
continue: {{parameter: al, range: [0.1, 3.5]}}
engine: {{max_share: 0.03125}}
loci: {{with: be, range: [0.2, 1.5], of: all, follow: all}}
diagram: none
output: halves.h5
"""


@pytest.fixture(scope="module")
def curves(tmp_path_factory: pytest.TempPathFactory) -> list[Branch]:
    """All curves of a study along al at be = 0.5, and of what begins on them."""
    run = RUN.format(x=henon_fixed_point(0.2, 0.5))
    _, branches, _ = studied(tmp_path_factory.mktemp("halves"), "halves", PLUGIN, run)
    return [b for b in branches if b.info.problem == "locus"]


def test_no_curve_is_one_of_doublings(curves: list[Branch]) -> None:
    """And each is followed once, whichever point led to it."""
    assert sorted(b.info.settings["of"] for b in curves) == ["BP", "BP", "NS"]
    assert {b.outcome.status for b in curves} == {"complete"}


def test_what_lies_on_two_curves_is_found_from_both(curves: list[Branch]) -> None:
    """PDNS where the third state's curve al = 0.5 meets that of tori, be = 1; R2 where Henon's does."""
    tori = next(b for b in curves if b.info.settings["of"] == "NS")
    upright, bent = sorted((b for b in curves if b.info.settings["of"] == "BP"), key=labels)
    assert (labels(upright), labels(tori), labels(bent)) == (["PDNS"], ["PDNS", "R2", "R3"], ["R2"])
    for curve in (upright, tori):
        assert_at(curve, "PDNS", [(0.5, 1.0)])
    for curve in (tori, bent):
        assert_at(curve, "R2", [(3.0, 1.0)])


def test_counts_change_at_what_is_told_and_nowhere_else(curves: list[Branch]) -> None:
    """But along neutral saddles: the curve of tori goes on as these beyond R2."""
    for curve in (b for b in curves if b.info.settings["of"] == "BP"):
        told = [p for p in curve.special_points if p.unstable_before != p.unstable_after]
        assert all(p.label in ("PDNS", "R2") for p in told)
        changes = [i for i in range(1, len(curve)) if curve["unstable"][i] != curve["unstable"][i - 1]]
        assert len(changes) == len(told)
