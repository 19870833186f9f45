"""Starts on doubled orbits, and on one of a pair without the symmetry: what they come from is followed."""

from __future__ import annotations

import pytest
from loci_of_orbits import studied

from contwalk.branch import Branch, SpecialPoint

HEAD = """
import math
from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition


def odd(t, x, p, out):
    out[0], out[1] = -x[0], -x[1]

"""
# x'' + 0.2 x' + x + x^3 = 25 cos w t
DUFFING = (
    HEAD
    + """
def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = 25.0 * math.cos(p.w * t) - 0.2 * x[1] - x[0] - x[0] ** 3


SYSTEM = System(
    "duffing",
    states=(State("x"), State("v")),
    parameters=(Parameter("w", 1.5),),
    modes=(Mode("only", field),),
    symmetries=(Symmetry("odd", "spatial", odd),),
    period=lambda p: 2.0 * math.pi / p.w,
)
"""
)
# x'' + 0.1 x' + x = 8 cos w t between walls at +-1, restitution 0.7.
WALLS = (
    HEAD
    + """
def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = 8.0 * math.cos(p.w * t) - x[0] - 0.1 * x[1]


def bounce(t, x, p, after):
    after[0], after[1] = x[0], -0.7 * x[1]


SYSTEM = System(
    "walls",
    states=(State("x", "", 1.0), State("v", "", 1.0)),
    parameters=(Parameter("w", 3.0),),
    modes=(Mode("free", free),),
    transitions=(
        Transition("right", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),
        Transition("left", "free", "free", lambda t, x, p: x[0] + 1.0, reset=bounce),
    ),
    symmetries=(Symmetry("odd", "spatial", odd, events={"right": "left", "left": "right"}),),
    period=lambda p: 2.0 * math.pi / p.w,
)
"""
)
RUN = """
system: ./{name}.py
start: {{simulate: {{state: {{x: {x}, v: {v}}}, until: settled}}}}
continue: {{parameter: w, range: [{low}, {high}], direction: {way}}}
diagram: {{follow: [BP, PD], depth: {depth}}}
output: {name}.h5
"""


def value(point: SpecialPoint) -> float:
    """The value of the free parameter at a point."""
    return float(point.parameters["w"])


def told(branches: list[Branch]) -> list[tuple[str, list[tuple[str, str]]]]:
    """Where each branch begins, and labels and kinds of its special points but for ends."""
    points = [[(p.label, p.kind or "") for p in b.special_points if p.label != "EP"] for b in branches]
    return list(zip((b.info.origin for b in branches), points, strict=True))


def test_the_orbits_that_a_doubled_one_comes_from_are_followed(tmp_path):
    """The doubled orbit settles; that of one period lacks the symmetry too, and comes from one with it."""
    run = RUN.format(name="duffing", x=4.2, v=0.1, low=1.19, high=1.7, way="both", depth=2)
    _, branches, _ = studied(tmp_path, "duffing", DUFFING, run)
    first, once = branches[:2]
    assert first.info.subharmonic == 2
    meets, again = (p for p in first.special_points if p.label == "BP")
    assert once.info.origin == f"b1/{meets.name}"
    assert once.info.parent is None
    assert once.info.subharmonic == 1
    doublings = [p for p in once.special_points if p.label == "PD"]
    assert len(doublings) == 2
    for point, doubled in zip(doublings, (meets, again), strict=True):
        assert value(point) == pytest.approx(value(doubled), abs=point.error + doubled.error)
        assert 2.0 * point.period == pytest.approx(doubled.period, rel=1e-8)
    (whole,) = [b for b in branches if b.info.closure == "odd"]
    assert whole.info.parent is None
    assert [p.kind for p in whole.special_points if p.label == "BP"] == ["symmetry-breaking"]
    # Each once: that the first leaves its parent there is known.
    assert [b.info.subharmonic for b in branches if b.info.closure == "full"].count(2) == 1


def test_the_impacts_that_a_pair_comes_from_are_followed(tmp_path):
    """Orbits that hit the walls unlike come from the one that hits both alike."""
    run = RUN.format(name="walls", x=0.0, v=0.0, low=2.9, high=3.6, way="forward", depth=1)
    _, branches, _ = studied(tmp_path, "walls", WALLS, run)
    assert told(branches) == [
        ("the simulation", [("BP", "pitchfork")]),
        ("b1/BP1", [("BP", "symmetry-breaking")]),
    ]
    # Both ways, whatever the run's direction: it begins in the middle of what there is.
    assert [p["free"][0] for p in branches[1].points[[0, -1]]] == [2.9, 3.6]
    first, whole = (next(p for p in b.special_points if p.label == "BP") for b in branches)
    assert value(whole) == pytest.approx(value(first), abs=whole.error + first.error)
    assert 2.0 * whole.period == pytest.approx(first.period, rel=1e-8)
