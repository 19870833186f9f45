"""Curves of branch points and of marked values of orbits, in closed form."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import (
    ACCURACY,
    FINE,
    WALKED,
    assert_at,
    folding,
    henon,
    henon_fixed_point,
    labels,
    largest,
    map_as_machine,
    orbits,
    walked,
)
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import StartError
from contwalk.system import Symmetry, System

RANGES = {"lam": (-0.5, 1.0), "nu": (-0.2, 0.6)}


def beside_a_cycle(growth, **declared) -> System:
    """The unit circle, gone round in pi, and z' = growth(z, p) across it."""

    def field(t, x, p, dx):
        g = 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = g * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + g * x[1]
        dx[2] = growth(x[2], p)

    return small_system(field, "xyz", {"lam": -0.3, "nu": 0.3}, **declared)


def followed(system: System, point: str = "BP1") -> Branch:
    return walked(system, "lam", [1.0, 0.0, 0.0], (-0.4, 0.5), point, RANGES, np.pi)


@pytest.mark.long
def test_branch_points_in_an_invariant_plane() -> None:
    """Pitchforks where lam = nu^2."""
    curve = followed(beside_a_cycle(lambda z, p: z * (p.lam - p.nu**2 - z**2)))
    assert curve.info.settings["of"] == "BP"
    assert curve.outcome.reason == "bound"
    assert labels(curve) == []
    assert largest(curve["lam"] - curve["nu"] ** 2) < WALKED
    assert largest(curve["z"]) < WALKED
    assert curve["nu"].min() == -0.2
    assert curve["nu"].max() == 0.6


@pytest.mark.long
def test_a_circle_of_branch_points() -> None:
    """Parallel to the axis of the first parameter where lam = 0, and to that of the second where nu = 0."""
    system = beside_a_cycle(lambda z, p: z * (1.0 - p.lam**2 - p.nu**2 - z**2))
    branch = cw.continue_branch(orbits(system, "lam"), [1.0, 0.0, 0.0], (-0.4, 1.1), period=np.pi)
    curve = cw.continue_locus(system, branch, "BP1", {"lam": (-1.5, 1.5), "nu": (-1.5, 1.5)}, **FINE)
    assert curve.outcome.reason == "closed"
    assert labels(curve) == []
    assert largest(curve["lam"] ** 2 + curve["nu"] ** 2 - 1.0) < WALKED


@pytest.mark.long
def test_transcritical_points_of_a_map() -> None:
    """Of x -> x + x (lam - nu^2 - x) where lam = nu^2, from a branch along the second parameter."""
    system = map_as_machine(
        lambda x, p: (x[0] + x[0] * (p.lam - p.nu**2 - x[0]),), "x", {"lam": 0.16, "nu": 0.1}
    )
    branch = branch_of(system, "nu", (0.05, 0.5), [0.0])
    curve = cw.continue_locus(system, branch, "BP1", RANGES, **FINE)
    assert curve.info.settings["of_problem"] == "hybrid_orbit"
    assert largest(curve["lam"] - curve["nu"] ** 2) < WALKED
    assert (curve["nu"].min(), curve["nu"].max()) == (-0.2, 0.6)


@pytest.mark.long
def test_a_value_of_an_observable_of_a_machine() -> None:
    """Henon's fixed point x = y = 1/2: alpha = (1 + beta) / 2 + 1 / 4; it doubles at beta = 0."""
    x = henon_fixed_point(0.5, 0.3)
    start = [x, x], {"alpha": 0.5, "beta": 0.3}
    branch = branch_of(henon(), "alpha", (0.4, 1.2), *start, marks={"max:x": [0.5]})
    ranges = {"alpha": (0.2, 1.2), "beta": (-0.6, 0.5)}
    curve = cw.continue_locus(henon(), branch, "UZ1", ranges, **FINE)
    assert largest(curve["alpha"] - 0.5 * (1.0 + curve["beta"]) - 0.25) < WALKED
    assert labels(curve) == ["PD"]
    assert_at(curve, "PD", [(0.75, 0.0)])


@pytest.mark.long
def test_orbits_that_lose_a_symmetry() -> None:
    """Of half the cycle z comes back with its sign changed: a multiplier minus one where lam = nu^2."""

    def inversion(t, x, p, image):
        image[0], image[1], image[2] = -x[0], -x[1], -x[2]

    system = beside_a_cycle(
        lambda z, p: z * (p.lam - p.nu**2 - z**2), symmetries=(Symmetry("inversion", "spatial", inversion),)
    )
    curve = followed(system)
    assert (curve.info.settings["of"], curve.info.closure) == ("BP", "inversion")
    assert largest(curve["lam"] - curve["nu"] ** 2) < WALKED
    assert labels(curve) == []


def test_branch_points_that_come_apart_are_refused() -> None:
    with pytest.raises(StartError, match=r"BP1.*does not persist as nu varies.*follow the folds"):
        followed(beside_a_cycle(lambda z, p: 0.3 - p.nu + z * (p.lam - z)))


MARKS = {"max:x": [math.sqrt(0.7)], "period": [2.0 * np.pi / 3.28], "max_abs": [0.5], "mu": [0.85]}


@cache
def marked() -> Branch:
    """r' = r (mu - 1 + a r^2 - r^4), phi' = 3 + 0.4 r^2, from mu = 0.9 at a = 1."""
    radius = math.sqrt(0.5 + math.sqrt(0.15))
    period = 2.0 * np.pi / (3.0 + 0.4 * radius**2)
    return cw.continue_branch(orbits(folding(), "mu"), [radius, 0.0], (0.7, 0.95), period=period, marks=MARKS)


def of_mark(name: str) -> Branch:
    point = next(p for p in marked().special_points if p.mark.get("name") == name)
    return cw.continue_locus(folding(), marked(), point, {"mu": (0.3, 0.99), "a": (0.8, 1.5)}, **FINE)


@pytest.mark.long
def test_the_curve_of_an_observable_and_the_fold_on_it() -> None:
    curve = of_mark("max:x")
    assert curve.info.settings["of"] == "UZ"
    assert largest(curve["mu"] - (1.0 - 0.7 * curve["a"] + 0.49)) < WALKED
    assert labels(curve) == ["LP"]  # where r^2 = a / 2
    assert_at(curve, "LP", [(0.51, 1.4)])
    assert {(p.unstable_before, p.unstable_after) for p in curve.special_points if p.label == "LP"} in (
        {(0, 1)},
        {(1, 0)},
    )


def test_the_curve_of_a_period() -> None:
    curve = of_mark("period")
    assert largest(curve.points["period"] - 2.0 * np.pi / 3.28) < WALKED
    assert largest(curve["mu"] - (1.0 - 0.7 * curve["a"] + 0.49)) < WALKED


def test_the_curve_of_a_multiplier() -> None:
    """exp(2 T s (a - 2 s)) with s = r^2 is a half."""
    curve = of_mark("max_abs")
    s = curve["x"] ** 2 + curve["y"] ** 2
    logarithm = 2.0 * (2.0 * np.pi / (3.0 + 0.4 * s)) * s * (curve["a"] - 2.0 * s)
    assert largest(logarithm - math.log(0.5)) < 10.0 * WALKED


def test_the_curve_of_a_parameter_is_a_branch_along_the_other_one() -> None:
    curve = of_mark("mu")
    np.testing.assert_allclose(curve["mu"], 0.85, rtol=1e-15)
    assert curve["a"].max() == 1.5


def test_marks_on_a_curve_of_orbits() -> None:
    ranges = {"mu": (0.3, 0.99), "a": (0.5, 1.4)}
    asked = {"a": [0.6], "max:x": [0.8]}
    curve = cw.continue_locus(folding(), marked(), "LP1", ranges, marks=asked, **FINE)
    assert labels(curve) == ["UZ", "UZ"]
    first, second = sorted(
        (p.parameters["a"], p.parameters["mu"]) for p in curve.special_points if p.label == "UZ"
    )
    assert first == pytest.approx((0.6, 0.91), rel=ACCURACY)
    assert second == pytest.approx((1.28, 1.0 - 0.64**2), rel=ACCURACY)
