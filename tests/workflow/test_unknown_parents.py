"""Starts on doubled orbits, and on one of a pair without the symmetry: what they come from is followed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from loci_of_orbits import studied
from scipy.integrate import solve_ivp

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


@pytest.mark.long
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


@pytest.mark.long
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


# x' = 1 - x^2 - y^2 + cos(t) / 10, y' = (lam - x) y, and y changes its sign once a period.
FLIPPED = """
import math
from contwalk.system import Mode, Parameter, State, System, Transition


def field(t, x, p, dx):
    dx[0] = 1.0 - x[0] ** 2 - x[1] ** 2 + 0.1 * math.cos(t)
    dx[1] = (p.lam - x[0]) * x[1]


def flip(t, x, p, after):
    after[0], after[1] = x[0], -x[1]


SYSTEM = System(
    "flipped",
    states=(State("x"), State("y")),
    parameters=(Parameter("lam", 0.5),),
    modes=(Mode("only", field),),
    transitions=(Transition("flip", "only", "only", lambda t, x, p: math.sin(t), "rising", flip),),
    period=lambda p: 2.0 * math.pi,
)
"""
# The same without an event: the plane of y and what decays across it is turned by half a turn a period.
TURNED = """
import math
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    c, s = math.cos(0.5 * t), math.sin(0.5 * t)
    along, across = c * x[1] + s * x[2], c * x[2] - s * x[1]
    dx[0] = 1.0 - x[0] ** 2 - along**2 + 0.1 * math.cos(t)
    a, b = (p.lam - x[0]) * along - 0.5 * across, 0.5 * along - across
    dx[1], dx[2] = a * c - b * s, a * s + b * c


SYSTEM = System(
    "turned",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("lam", 0.5),),
    modes=(Mode("only", field),),
    period=lambda p: 2.0 * math.pi,
)
"""
FAMILIES = """
system: ./{name}.py
start: {{simulate: {{state: {{{state}}}, until: settled}}}}
continue: {{parameter: lam, range: [-1.1, 1.1]}}
diagram: {{follow: [BP, PD], depth: 4}}
output: {name}.h5
"""


@pytest.mark.parametrize(
    ("name", "plugin", "state"),
    [
        pytest.param("flipped", FLIPPED, "x: 1.0, y: 0.0", marks=pytest.mark.slow),
        pytest.param("turned", TURNED, "x: 1.0, y: 0.0, z: 0.0", marks=pytest.mark.long),
    ],
)
def test_a_doubled_branch_that_ends_on_another_family_leads_to_it(tmp_path, name, plugin, state):
    """Doubled orbits with the mean of x at lam lead from the family at x = 1 to that at x = -1.

    On these x = u' / u with u'' = (1 + cos(t) / 10) u, so that the mean is a Floquet exponent of Mathieu's
    equation, on either of its sides. The family that is unstable was told as the parent, and lost.
    """
    _, branches, _ = studied(tmp_path, name, plugin, FAMILIES.format(name=name, state=state))
    assert [b.info.origin for b in branches] == ["the simulation", "b1/PD1", "b2/BP1"]
    end = next(p for p in branches[1].special_points if p.kind == "rejoined")
    doublings = [next(p for p in b.special_points if p.label == "PD") for b in (branches[0], branches[2])]
    exponent = mathieu_exponent()
    for point, expected in ((doublings[0], exponent), (doublings[1], -exponent), (end, -exponent)):
        # SciPy's steps at 1e-12 leave 1e-11.
        assert abs(point.parameters["lam"] - expected) <= point.error + 1e-11
    assert (doublings[1].unstable_before, doublings[1].unstable_after) == (1, 2)


def mathieu_exponent() -> float:
    """The positive Floquet exponent of u'' = (1 + cos(t) / 10) u."""
    columns = [
        solve_ivp(
            lambda t, u: [u[1], (1.0 + 0.1 * math.cos(t)) * u[0]],
            (0.0, 2.0 * math.pi),
            unit,
            method="DOP853",
            rtol=1e-12,
            atol=1e-12,
        ).y[:, -1]
        for unit in ([1.0, 0.0], [0.0, 1.0])
    ]
    return math.log(max(abs(np.linalg.eigvals(np.array(columns))))) / (2.0 * math.pi)


ROESSLER = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.w)


SYSTEM = System(
    "roessler",
    states=(State("x"), State("v"), State("z")),
    parameters=(Parameter("w", 3.2),),
    modes=(Mode("only", field),),
)
"""


def test_what_an_unforced_orbit_comes_from_is_one_branch_with_what_doubles(tmp_path):
    """Of an orbit without a force one closure counts as one period, however often it has been doubled."""
    run = RUN.format(name="roessler", x=-4.0, v=0.0, low=2.8, high=3.3, way="backward", depth=1)
    _, branches, _ = studied(tmp_path, "roessler", ROESSLER, run.replace("v: 0.0", "v: 0.0, z: 0.03"))
    first, once = branches
    assert [b.info.subharmonic for b in branches] == [1, 1]
    (meets,) = (p for p in first.special_points if p.label == "BP")
    (doubling,) = (p for p in once.special_points if p.label == "PD")
    assert value(doubling) == pytest.approx(value(meets), abs=doubling.error + meets.error)
    assert 2.0 * doubling.period == pytest.approx(meets.period, rel=1e-8)  # as points are located
