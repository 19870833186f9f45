"""Curves in two parameters of published systems, against values recomputed in 40 to 70 digits.

The values of Morris-Lecar, Bazykin and the CO oxidation were found with `mpmath`, by defining systems on the
characteristic polynomial; they agree with the digits that MatCont's tutorials print.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

pytestmark = pytest.mark.slow

TWO = ("CP", "BT", "GH", "ZH", "HH")


def morris_lecar(t, x, p, dx):
    v, w = x[0], x[1]
    m = 0.5 * (1.0 + math.tanh((v + 1.2) / 18.0))
    settled = 0.5 * (1.0 + math.tanh((v - p.v3) / 30.0))
    dx[0] = (p.Iapp - 4.4 * m * (v - 120.0) - 8.0 * w * (v + 84.0) - 2.0 * (v + 60.0)) / 20.0
    dx[1] = math.cosh((v - p.v3) / 60.0) * (settled - w) / 25.0


def bazykin(t, x, p, dx):
    eaten = x[0] * x[1] / (1.0 + p.alpha * x[0])
    dx[0] = x[0] - eaten - 0.01 * x[0] ** 2
    dx[1] = -x[1] + eaten - p.delta * x[1] ** 2


def co_oxidation(t, x, p, dx):
    z = 1.0 - x[0] - x[1] - x[2]
    dx[0] = 5.0 * z**2 - 2.0 * x[0] ** 2 - 10.0 * x[0] * x[1]
    dx[1] = p.q2 * z - 0.1 * x[1] - 10.0 * x[0] * x[1]
    dx[2] = 0.0675 * (z - p.k * x[2])


def lorenz84(t, x, p, dx):
    dx[0] = -(x[1] ** 2) - x[2] ** 2 - 0.25 * x[0] + 0.25 * p.F - 0.987 * x[3] ** 2
    dx[1] = x[0] * x[1] - x[0] * x[2] - x[1] + 0.25
    dx[2] = x[0] * x[1] + x[0] * x[2] - x[2]
    dx[3] = -1.04 * x[3] + 0.987 * x[3] * x[0] + p.T


# System, states, parameters with the continued one first, a state, its range and both ranges of the curve.
STUDIES = {
    "morris_lecar": (
        morris_lecar,
        "vw",
        {"Iapp": 0.0, "v3": 2.0},
        [-60.0, 0.0],
        (-50.0, 300.0),
        (-300.0, 400.0),
        (-50.0, 100.0),
    ),
    "bazykin": (
        bazykin,
        "xy",
        {"alpha": 0.3, "delta": 0.2},
        [2.0, 2.0],
        (0.01, 0.9),
        (0.01, 2.0),
        (0.001, 1.0),
    ),
    "co_oxidation": (
        co_oxidation,
        "xys",
        {"q2": 0.5, "k": 0.4},
        [0.5, 0.05, 0.3],
        (0.3, 2.0),
        (0.3, 2.0),
        (0.1, 2.0),
    ),
}

# What lies on the curve from a point: label, first and second parameter, all within the ranges.
KNOWN = {
    ("morris_lecar", "HB1"): [("BT", 48.225938868986023569, 21.73414334994823247)],
    ("morris_lecar", "HB2"): [("BT", -227.13188804356887233, 69.755737112162036882)],
    ("bazykin", "HB1"): [("BT", 0.45362432777812945522, 0.17512759295021742421)],
    ("bazykin", "LP1"): [("BT", 0.45362432777812945522, 0.17512759295021742421)],
    ("co_oxidation", "HB1"): [
        ("BT", 1.1611987088217386739, 0.72233907252222896711),
        ("GH", 0.92425501521857923372, 0.30587926747792887522),
    ],
    ("co_oxidation", "LP2"): [
        ("BT", 1.1611987088217386739, 0.72233907252222896711),
        ("CP", 1.0064083296783176227, 0.35599127320867654995),
    ],
}


@cache
def curve(name: str, start: str) -> Branch:
    field, states, parameters, state, along, first, second = STUDIES[name]
    one, two = parameters
    problem = small_problem(field, list(states), parameters, one)
    branch = cw.continue_branch(problem, state, range=along)
    return cw.continue_locus(problem.system, branch, start, {one: first, two: second})


def nearest(branch: Branch, label: str, first: float, second: float) -> SpecialPoint:
    one, two = branch.info.free
    points = labelled(branch, label)
    assert points, branch.special_points
    return min(points, key=lambda p: abs(p.parameters[one] - first) + abs(p.parameters[two] - second))


@pytest.mark.drawn(2)
@pytest.mark.parametrize(("name", "start"), KNOWN)
def test_points_of_published_systems(name, start) -> None:
    found = curve(name, start)
    one, two = found.info.free
    for label, first, second in KNOWN[name, start]:
        point = nearest(found, label, first, second)
        for parameter, value in ((one, first), (two, second)):
            error = abs(point.parameters[parameter] - value)
            assert error <= 1e-14 * abs(value)
            assert error <= point.errors[parameter] + 2.0**-52 * abs(value)


def slopes84(point: SpecialPoint) -> np.ndarray:
    """The matrix of Lorenz-84 at a point, written by hand."""
    x, y, z, u = (point.state[name] for name in "XYZU")
    return np.array(
        [
            [-0.25, -2.0 * y, -2.0 * z, -1.974 * u],
            [y - z, x - 1.0, -x, 0.0],
            [y + z, x, x - 1.0, 0.0],
            [0.987 * u, 0.0, 0.0, 0.987 * x - 1.04],
        ]
    )


@cache
def lorenz84_curves() -> dict[str, Branch]:
    """The curves from the first points of each kind at T = 0.04, on the branch with its fold."""
    problem = small_problem(lorenz84, list("XYZU"), {"F": 3.0, "T": 0.04}, "F")
    branch = cw.continue_branch(problem, [2.9787, -0.038683, 0.058233, -0.021053], range=(0.5, 4.0))
    ranges = {"F": (0.2, 4.0), "T": (-0.2, 0.2)}
    names = ("LP1", "HB1", "HB2")
    return {name: cw.continue_locus(problem.system, branch, name, ranges) for name in names}


def test_lorenz84_has_points_of_every_kind_in_mirror_images() -> None:
    """U and T may change their signs: every point has its image, and the cusp is its own."""
    found = lorenz84_curves()
    labels = {name: [p.label for p in labelled(branch, *TWO)] for name, branch in found.items()}
    assert labels["LP1"] == ["BT", "ZH", "CP", "ZH", "BT"]
    assert labels["HB1"] == ["HH", "ZH", "ZH", "HH"]
    assert labels["HB2"] == ["HH", "GH", "BT", "BT", "GH", "HH"]
    for branch in found.values():
        points = labelled(branch, *TWO)
        for point, image in zip(points, reversed(points), strict=True):
            assert point.parameters["F"] == pytest.approx(image.parameters["F"], rel=1e-15)
            assert point.parameters["T"] == pytest.approx(-image.parameters["T"], rel=1e-15, abs=1e-39)
    (cusp,) = labelled(found["LP1"], "CP")
    # Along the curve only F turns there: T passes zero with a finite slope.
    assert abs(cusp.parameters["T"]) <= cusp.errors["T"] < 1e-30
    assert cusp.coefficients["c"] < 0.0


def test_points_of_lorenz84_lie_on_both_of_their_curves() -> None:
    found = lorenz84_curves()
    for label, one, other in (("BT", "LP1", "HB2"), ("ZH", "LP1", "HB1"), ("HH", "HB1", "HB2")):
        for point in labelled(found[one], label):
            twin = nearest(found[other], label, point.parameters["F"], point.parameters["T"])
            for name in ("F", "T"):
                apart = abs(point.parameters[name] - twin.parameters[name])
                assert apart <= point.errors[name] + twin.errors[name]
            for name, value in point.coefficients.items():
                if name != "convention":
                    assert twin.coefficients[name] == pytest.approx(value, rel=1e-8)


def test_critical_eigenvalues_of_lorenz84_vanish_as_told() -> None:
    for branch in lorenz84_curves().values():
        for point in labelled(branch, *TWO):
            zeros = {"CP": 1, "BT": 2, "GH": 2, "ZH": 3, "HH": 4}[point.label]
            real = np.sort(np.abs(np.linalg.eigvals(slopes84(point)).real))[:zeros]
            # A double zero splits by the square root of rounding.
            assert real.max() < (1e-6 if point.label == "BT" else 1e-13)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("name", "hopf", "fold"), [("bazykin", "HB1", "LP1"), ("co_oxidation", "HB1", "LP2")]
)
def test_bogdanov_takens_points_agree_from_both_curves(name, hopf, fold) -> None:
    sides = [labelled(curve(name, start), "BT") for start in (hopf, fold)]
    assert len(sides[0]) == len(sides[1]) > 0
    for point in sides[0]:
        one = next(iter(point.errors))
        other = min(
            sides[1],
            key=lambda p, one=one, value=point.parameters[one]: abs(p.parameters[one] - value),
        )
        for parameter in point.errors:
            apart = abs(point.parameters[parameter] - other.parameters[parameter])
            assert apart <= point.errors[parameter] + other.errors[parameter]
        for name_ in ("a", "b"):
            assert other.coefficients[name_] == pytest.approx(point.coefficients[name_], rel=1e-9)


def test_the_count_of_unstable_directions_changes_at_double_points() -> None:
    found = curve("co_oxidation", "LP2")
    counts = [(p.label, p.unstable_before, p.unstable_after) for p in labelled(found, *TWO)]
    assert counts == [("BT", 0, 1), ("CP", 1, 1), ("BT", 1, 0)]
