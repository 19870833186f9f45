"""Curves of special points of orbits that cross where a product of two functions of both parameters is zero.

The walk went on along the other curve, round the corner and in silence, or told the point as not located.
"""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import (
    FINE,
    WALKED,
    assert_at,
    labels,
    largest,
    map_as_machine,
    map_plugin,
    orbits,
    studied,
)
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch

pytestmark = pytest.mark.slow

RANGES = {"lam": (-0.5, 0.6), "nu": (-0.3, 0.7)}
VALUES = {"lam": 0.16, "nu": 0.3}


def product(p, bend: float):
    """Zero on the curve lam = -bend nu^2, and on the line nu = bend lam."""
    return (p.lam + bend * p.nu**2) * (p.nu - bend * p.lam)


def assert_crossed(curve: Branch, bend: float, most: int = 60) -> None:
    """The whole of the first curve, in so many points, and where the line crosses it."""
    assert curve.outcome.reason == "bound"
    assert (curve["nu"].min(), curve["nu"].max()) == (-0.3, 0.7)
    assert largest(curve["lam"] + bend * curve["nu"] ** 2) < WALKED
    assert labels(curve) == ["BP"]
    assert_at(curve, "BP", [(0.0, 0.0)])
    assert len(curve) < most


@pytest.mark.drawn(1)
@pytest.mark.parametrize("bend", [0.0, 0.2])
def test_folds_of_a_map(bend) -> None:
    system = map_as_machine(lambda x, p: (x[0] + product(p, bend) - x[0] ** 2,), "x", VALUES)
    start = [np.sqrt((0.16 + bend * 0.09) * (0.3 - bend * 0.16))]
    branch = branch_of(system, "lam", (-0.3, 0.5), start)
    assert_crossed(cw.continue_locus(system, branch, "LP1", RANGES, **FINE), bend)


@pytest.mark.long
@pytest.mark.parametrize("bend", [0.0, pytest.param(0.2, marks=pytest.mark.long)])
def test_a_marked_value_of_a_map(bend) -> None:
    """The gradient of what is held vanishes there, and is one of differences: steps are short beside it."""
    system = map_as_machine(lambda x, p: (0.5 * x[0] + product(p, bend) + 1.0,), "x", VALUES)
    start = [2.0 + 2.0 * (0.16 + bend * 0.09) * (0.3 - bend * 0.16)]
    branch = branch_of(system, "lam", (-0.3, 0.5), start, marks={"max:x": [2.0]})
    assert_crossed(cw.continue_locus(system, branch, "UZ1", RANGES, **FINE), bend, most=400)


@pytest.mark.long
@pytest.mark.parametrize("bend", [0.0, 0.2])
def test_folds_of_cycles(bend) -> None:
    """Of the unit circle, gone round in pi, with z' = g (lam, nu) - z^2 across it."""

    def field(t, x, p, dx):
        g = 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = g * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + g * x[1]
        dx[2] = product(p, bend) - x[2] ** 2

    system = small_system(field, "xyz", VALUES)
    start = [1.0, 0.0, np.sqrt((0.16 + bend * 0.09) * (0.3 - bend * 0.16))]
    branch = cw.continue_branch(orbits(system, "lam"), start, (-0.3, 0.5), period=np.pi)
    assert_crossed(cw.continue_locus(system, branch, "LP1", RANGES, **FINE), bend)


RUN = """
contwalk: 1
system: ./crossed.py
accuracy: 1e-9
start: {simulate: {state: {x: 0.21, y: 0.0}, until: 0}}
continue: {parameter: lam, range: [-0.3, 0.5]}
diagram: {follow: none}
loci: {with: nu, range: [-0.3, 0.7], of: [LP], follow: all}
engine: {max_step: 0.4, max_share: 0.1}
figures: []
"""


def test_the_other_curve_is_followed_from_there(tmp_path) -> None:
    images = ("x[0] + (p.lam + 0.2 * p.nu**2) * (p.nu - 0.2 * p.lam) - x[0] ** 2", "0.5 * x[1]")
    _, branches, _ = studied(tmp_path, "crossed", map_plugin("crossed", images, VALUES), RUN)
    curves = [b for b in branches if b.info.problem == "locus"]
    assert [labels(curve) for curve in curves] == [["BP"], []]
    assert_at(curves[0], "BP", [(0.0, 0.0)])
    assert largest(curves[0]["lam"] + 0.2 * curves[0]["nu"] ** 2) < WALKED
    assert largest(curves[1]["nu"] - 0.2 * curves[1]["lam"]) < WALKED
    assert (curves[1]["lam"].min(), curves[1]["lam"].max()) == (-0.3, 0.5)


@pytest.mark.long
def test_units_make_no_difference() -> None:
    """Parameters of the sizes 1e8 and 1e-8, a state of 1e-6: as many points, and errors of the same parts."""
    large, small, size = 1e8, 1e-8, 1e-6

    def fixed(p):
        lam, nu = p.lam / large, p.nu / small
        return size * (lam + 0.2 * nu**2) * (nu - 0.2 * lam)

    values = {"lam": 0.16 * large, "nu": 0.3 * small}
    system = map_as_machine(lambda x, p: (x[0] + fixed(p) - x[0] ** 2 / size,), "x", values, size)
    start = [size * np.sqrt((0.16 + 0.2 * 0.09) * (0.3 - 0.2 * 0.16))]
    branch = branch_of(system, "lam", (-0.3 * large, 0.5 * large), start)
    ranges = {"lam": (-0.5 * large, 0.6 * large), "nu": (-0.3 * small, 0.7 * small)}
    curve = cw.continue_locus(system, branch, "LP1", ranges, **FINE)
    (point,) = [p for p in curve.special_points if p.label == "BP"]
    assert point.status == "located"
    for name, unit in (("lam", large), ("nu", small)):
        assert abs(point.parameters[name]) <= point.errors[name] < 1e-11 * unit
    assert len(curve) < 60
