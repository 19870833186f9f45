"""Curves where branches cross whatever the parameters are, as on a face, and curves that level off."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import FINE, WALKED, map_as_machine, map_plugin, studied
from loci_of_orbits import assert_at as assert_known_at
from small_systems import small_problem

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.problems.locus.orbit_points.resonances import R2OnTori
from contwalk.problems.locus.orbit_points.where_branches_cross import OnBranchPoints

pytestmark = pytest.mark.slow


def face(t, x, p, dx):
    """Hopf points where mu = 0 on z = 0 and where mu = -lam / 2 beside it; they cross where lam = 0.

    Beside the face the amplitude moves z by 0.6 r^2, and the first Lyapunov coefficient is negative on both.
    """
    r = x[0] ** 2 + x[1] ** 2
    growth = p.mu + 0.5 * x[2] - r
    dx[0] = growth * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + growth * x[1]
    dx[2] = x[2] * (p.lam - x[2] + 0.6 * r)


def touching(t, x, p, dx):
    """Folds where m = -a^2 / 4, x = a / 2, which touch the transcritical points where x = m = 0."""
    dx[0] = x[0] * (p.m + p.a * x[0] - x[0] ** 2)


def levelling(t, x, p, dx):
    """Folds where p = -exp(-q)."""
    dx[0] = p.p + np.exp(-p.q) + x[0] ** 2


def curve(problem, start, along, point, ranges) -> Branch:
    branch = cw.continue_branch(problem, start, range=along)
    return cw.continue_locus(problem.system, branch, point, ranges)


def assert_at(point: SpecialPoint, **truth: float) -> None:
    assert point.status == "located"
    for name, value in truth.items():
        assert abs(point.parameters[name] - value) <= point.errors[name] < 1e-13


@pytest.mark.parametrize("z", [0.0, 0.4])
def test_a_zero_hopf_point_from_the_curves_on_a_face_and_beside_it(z) -> None:
    problem = small_problem(face, ["x", "y", "z"], {"mu": -0.5, "lam": 0.4}, "mu")
    found = curve(problem, [0.0, 0.0, z], (-0.6, 0.6), "HB1", {"mu": (-0.6, 0.6), "lam": (-0.7, 0.8)})
    assert np.max(np.abs(found["mu"] + 0.5 * found["z"])) < 1e-14
    assert np.max(np.abs(found["z"] - (found["lam"] if z else 0.0))) < 1e-14
    (point,) = [p for p in found.special_points if p.label != "EP"]  # and no generalized Hopf point
    assert (point.label, point.kind) == ("ZH", "branch point")
    assert_at(point, mu=0.0, lam=0.0)
    assert point.coefficients["omega"] == pytest.approx(2.0, rel=1e-14)
    assert "branch point that persists" in point.note


def test_a_zero_hopf_point_from_the_branch_points() -> None:
    problem = small_problem(face, ["x", "y", "z"], {"lam": -0.5, "mu": 0.4}, "lam")
    found = curve(problem, [0.0, 0.0, 0.0], (-0.6, 0.6), "BP1", {"lam": (-0.6, 0.6), "mu": (-0.7, 0.8)})
    (point,) = [p for p in found.special_points if p.label != "EP"]
    assert point.label == "ZH"
    assert_at(point, mu=0.0, lam=0.0)


def test_folds_that_touch_transcritical_points() -> None:
    problem = small_problem(touching, ["x"], {"m": 0.5, "a": 0.8}, "m")
    found = curve(problem, [0.4 + math.sqrt(0.66)], (-1.0, 0.7), "LP1", {"m": (-1.0, 0.5), "a": (-0.9, 1.1)})
    assert np.max(np.abs(found["m"] + found["a"] ** 2 / 4.0)) < 1e-14
    assert (found["a"].min(), found["a"].max()) == (-0.9, 1.1)
    (point,) = [p for p in found.special_points if p.label != "EP"]
    assert (point.label, point.kind) == ("CP", "branch point")
    assert_at(point, m=0.0, a=0.0)
    assert point.coefficients["c"] == pytest.approx(-1.0, rel=1e-12)


def hunted(t, x, p, dx):
    """The demonstration pp2 of AUTO-07p: prey with a harvest, and predators that may be none."""
    dx[0] = 3.0 * x[0] * (1.0 - x[0]) - x[0] * x[1] - p.p1 * (1.0 - np.exp(-5.0 * x[0]))
    dx[1] = -x[1] + p.p4 * x[0] * x[1]


@pytest.fixture(scope="module")
def prey_alone() -> Branch:
    """The branch without predators, with its fold and its branch point."""
    problem = small_problem(hunted, ["u", "v"], {"p1": 0.0, "p4": 3.0}, "p1")
    return cw.continue_branch(problem, [1.0, 0.0], range=(-0.1, 1.0))


def test_branch_points_on_a_face_persist_whatever_rounding_leaves_of_what_is_zero_there(prey_alone) -> None:
    """They are where u = 1 / p4; v is 1e-16 on the curve, and its equation has no terms but noise."""
    system = small_problem(hunted, ["u", "v"], {"p1": 0.0, "p4": 3.0}, "p1").system
    found = cw.continue_locus(system, prey_alone, "BP1", {"p1": (-0.1, 1.0), "p4": (1.5, 6.0)})
    assert (found.outcome.reason, found["p4"].min(), found["p4"].max()) == ("bound", 1.5, 6.0)
    u = 1.0 / found["p4"]
    truth = 3.0 * u * (1.0 - u) / -np.expm1(-5.0 * u)
    assert np.max(np.abs(found["p1"] - truth)) < 1e-14  # Newton's method ends at rounding of terms below 3


def test_no_cubic_coefficient_is_told_where_the_eigenvalue_zero_is_a_double_one(prey_alone) -> None:
    """Where the fold on the face meets the branch points p.q is zero: the coefficient was 5.9e16."""
    system = small_problem(hunted, ["u", "v"], {"p1": 0.0, "p4": 3.0}, "p1").system
    found = cw.continue_locus(system, prey_alone, "LP1", {"p1": (-0.1, 1.0), "p4": (1.5, 6.0)})
    points = [p for p in found.special_points if p.label == "CP"]
    assert [(p.kind, p.coefficients) for p in points] == [("branch point", {})]


def flipping(x, p):
    """On the face y = 0 doublings where mu = 0, with the cubic coefficient 0.35 all along.

    Beside it, where y = nu, they are where mu = -0.4 nu.
    """
    first = -(1.0 + p.mu + 0.4 * x[1]) * x[0] + 0.5 * x[0] ** 2 + 0.1 * x[0] ** 3
    return first, x[1] * (1.0 + p.nu - x[1] + 0.3 * x[0])


def turning(x, p):
    """On the face z = 0 tori where mu = 0, with the cubic coefficient minus one all along."""
    g = 1.0 + p.mu + 0.4 * x[2] - x[0] ** 2 - x[1] ** 2
    cos, sin = math.cos(1.0), math.sin(1.0)
    turned = g * (cos * x[0] - sin * x[1]), g * (sin * x[0] + cos * x[1])
    return *turned, x[2] * (1.0 + p.nu - x[2] + 0.3 * x[0])


def crossing(image, states: str, last: float, nu: float, point: str) -> Branch:
    """The curve through a point of the branch along mu on which the last state is `last`."""
    system = map_as_machine(image, states, {"mu": -0.4, "nu": nu})
    branch = branch_of(system, "mu", (-0.5, 0.3), [0.0] * (len(states) - 1) + [last])
    return cw.continue_locus(system, branch, point, {"mu": (-0.5, 0.5), "nu": (-0.3, 0.2)}, **FINE)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("image", "states", "last", "point", "label"),
    [
        (flipping, "xy", 0.0, "PD1", "LPPD"),
        (flipping, "xy", 0.15, "PD1", "LPPD"),
        (turning, "xyz", 0.0, "NS1", "LPNS"),
    ],
)
def test_where_a_multiplier_of_a_face_passes_one_the_curves_of_both_branches_cross(
    image, states, last, point, label
) -> None:
    """And no cubic coefficient vanishes there, nor does the angle of a torus that stands still tell R2."""
    found = crossing(image, states, last, last or -0.23, point)
    assert np.max(np.abs(found["mu"] + 0.4 * found[states[-1]])) < WALKED
    assert np.max(np.abs(found[states[-1]] - (found["nu"] if last else 0.0))) < WALKED
    (told,) = [p for p in found.special_points if p.label != "EP"]
    assert (told.label, told.kind) == (label, "branch point")
    assert_known_at(found, label, [(0.0, 0.0)])


@pytest.mark.long
def test_the_curves_of_both_branches_from_the_branch_points_of_a_face() -> None:
    system = map_as_machine(flipping, "xy", {"nu": -0.23, "mu": 0.1})
    branch = branch_of(system, "nu", (-0.3, 0.2), [0.0, 0.0])
    found = cw.continue_locus(system, branch, "BP1", {"nu": (-0.3, 0.2), "mu": (-0.5, 0.5)}, **FINE)
    (told,) = [p for p in found.special_points if p.label != "EP"]
    assert (told.label, told.kind) == ("LPPD", "branch point")
    assert_known_at(found, "LPPD", [(0.0, 0.0)])
    problem, _ = reopened(system, found, told, FINE["discretization"])
    seeds = OnBranchPoints("LPPD", "PD").seeds(problem, told)
    slopes = sorted(float(seed.tangent[-2] / seed.tangent[-1]) for seed in seeds)  # of mu by nu
    np.testing.assert_allclose(slopes, [-0.4, 0.0], atol=1e-7)


@pytest.mark.parametrize("rate", [1e-66, -3e-17])
def test_of_an_angle_that_stands_still_no_sign_tells_a_resonance(rate) -> None:
    """The rate of the cosine is the rounding of zero; a pole was searched for at each change of its sign."""
    problem: Any = SimpleNamespace(
        plane=SimpleNamespace(size=3),
        mesh=SimpleNamespace(amplified=1.0, tolerance=1e-9),
        further=lambda z: z[3:4],
    )
    place = np.array([0.0, 0.0, 0.0, math.cos(1.0), 0.1, 0.0])
    sample: Any = SimpleNamespace(z=place, tangent=np.array([0.0, 0.0, 0.0, rate, 1.0, 0.0]))
    assert math.isnan(R2OnTori().value(problem, sample))


def test_a_curve_along_which_the_first_parameter_levels_off_ends_at_the_range_of_the_second() -> None:
    problem = small_problem(levelling, ["x"], {"p": -3.0, "q": 0.5}, "p")
    found = curve(problem, [1.0], (-3.0, 0.5), "LP1", {"p": (-3.0, 0.5), "q": (-1.0, 40.0)})
    assert found.outcome.reason == "bound"
    assert found["q"].max() == 40.0


PREY_AND_PREDATORS = map_plugin(
    "hunted",
    ("p.a * x[0] * (1.0 - x[0]) - p.b * x[0] * x[1]", "p.b * x[0] * x[1] - 0.2 * x[1]"),
    {"a": 2.0, "b": 2.5},
)
DOUBLINGS_ON_THE_FACE = """
system: ./hunted.py
start: {state: {x: 0.5, y: 0.0}}
continue: {parameter: a, range: [1.5, 3.6]}
diagram: {follow: [], depth: 2}
loci: {with: b, range: [1.4, 3.0], of: [PD], follow: [FOLLOWED]}
figures: []
"""


@pytest.mark.long
@pytest.mark.parametrize("followed", ["BP", pytest.param("LPPD", marks=pytest.mark.long)])
def test_where_doublings_on_a_face_become_transversally_unstable_three_curves_are_followed(
    tmp_path, followed
) -> None:
    """By either name of the point, a crossing of curves or what it is on both.

    Right at it the cubic coefficient has no value, and another one on each curve of doublings.

    Without predators x = 1 - 1/a doubles at a = 3 and lets predators in at b = 1.2 a / (a - 1); with them
    x = 1.2 / b, where the multiplier is -1 at b = 3.84 a / (2.8 + 1.2 a).
    """
    run = DOUBLINGS_ON_THE_FACE.replace("FOLLOWED", followed)
    _, branches, _ = studied(tmp_path, "hunted", PREY_AND_PREDATORS, run)
    on_face, beside, entries = (b for b in branches if b.info.problem == "locus")
    assert [b.info.settings["of"] for b in (on_face, beside, entries)] == ["PD", "PD", "BP"]
    # Points of branches are solved for on steps a hundred times coarser than the accuracy of 1e-8.
    a = beside["a"]
    np.testing.assert_allclose(beside["b"], 3.84 * a / (2.8 + 1.2 * a), rtol=1e-6)
    np.testing.assert_allclose(entries["b"], 1.2 * entries["a"] / (entries["a"] - 1.0), rtol=1e-6)
    for curve in (on_face, entries):
        (point,) = [p for p in curve.special_points if p.label != "EP"]
        assert (point.label, point.kind) == ("LPPD", "branch point")
        assert point.parameters["a"] == pytest.approx(3.0, abs=2.0 * point.errors["a"])
        assert point.parameters["b"] == pytest.approx(1.8, abs=2.0 * point.errors["b"])
    assert [p.label for p in beside.special_points] == ["EP", "EP"]  # it begins at that point
