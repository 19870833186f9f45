"""Curves in two parameters whose equations, special points and normal forms are known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import StartError

TWO = ("CP", "BT", "GH", "ZH", "HH")


def cusp(t, x, p, dx):
    """The cusp's unfolding: folds where 27 b1^2 = 4 b2^3."""
    dx[0] = p.b1 + p.b2 * x[0] - x[0] ** 3


def brusselator(t, x, p, dx):
    """Hopf points where B = 1 + A^2."""
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def bautin(t, x, p, dx):
    """Hopf points where mu = 0; the cubic coefficient is beta^2 - gap."""
    r = x[0] ** 2 + x[1] ** 2
    growth = p.mu + (p.beta**2 - p.gap) * r - r**2
    dx[0] = growth * x[0] - 3.0 * x[1]
    dx[1] = 3.0 * x[0] + growth * x[1]


def centre(t, x, p, dx):
    """Hopf points where mu = b; with u = x - b, u'' = u u' / (2 b) - u, which reversed in u is itself."""
    dx[0] = -0.5 * x[0] + x[1] + x[0] ** 2 / (4.0 * p.b)
    dx[1] = p.mu - x[0]


def zero_hopf(t, x, p, dx):
    """Folds where b1 = 0, Hopf points where b1 = -(b2 / theta)^2; they meet in (0, 0)."""
    r = x[1] ** 2 + x[2] ** 2
    growth = p.b2 + p.theta * x[0] + 0.5 * x[0] ** 2
    dx[0] = p.b1 + x[0] ** 2 - r
    dx[1] = growth * x[1] - 2.0 * x[2]
    dx[2] = 2.0 * x[1] + growth * x[2]


def double_hopf(t, x, p, dx):
    """Hopf points of the fast pair where m1 = 0, of the slow one where m2 = 0."""
    r, s = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
    fast, slow = p.m1 - r + 2.0 * s, p.m2 + 3.0 * r - 4.0 * s
    dx[0] = fast * x[0] - 5.0 * x[1]
    dx[1] = 5.0 * x[0] + fast * x[1]
    dx[2] = slow * x[2] - x[3]
    dx[3] = x[2] + slow * x[3]


def bogdanov_takens(t, x, p, dx):
    """Folds where b1 = b2^2 / 4, Hopf points where b1 = 0 and b2 < 0: the normal form with a = 1, b = -1."""
    dx[0] = x[1]
    dx[1] = p.b1 + p.b2 * x[0] + x[0] ** 2 - x[0] * x[1]


def at(point: SpecialPoint, *names: str) -> list[float]:
    """The values of some parameters at a point."""
    return [point.parameters[name] for name in names]


def inside_errors(point: SpecialPoint, **truth: float) -> None:
    """A point has these values to within the errors that it claims, which are near rounding."""
    assert point.status == "located"
    assert point.error == point.errors[next(iter(point.errors))]
    for name, value in truth.items():
        assert point.errors[name] <= 1e-14 * max(abs(value), 1.0)
        assert abs(point.parameters[name] - value) <= point.errors[name]


def curve(
    field, states, start, free: str, parameters, ranges, state=None, which: str | None = None
) -> Branch:
    """The curve from the first special point of a kind, of the branch along a parameter."""
    problem = small_problem(field, states, parameters, free)
    branch = cw.continue_branch(problem, state or [0.0] * len(states), range=ranges[free])
    assert labelled(branch, start), branch.special_points
    return cw.continue_locus(problem.system, branch, which or f"{start}1", ranges)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("names", [("b1", "b2"), ("b2", "b1")])
def test_folds_of_the_cusp(names) -> None:
    ranges = {"b1": (-2.0, 2.0), "b2": (-1.0, 2.0)}
    problem = small_problem(cusp, ["x"], {"b1": -1.0, "b2": 1.0}, "b1")
    branch = cw.continue_branch(problem, [-1.3], range=(-2.0, 2.0))
    found = cw.continue_locus(problem.system, branch, "LP1", {name: ranges[name] for name in names})
    assert found.info.free == names
    np.testing.assert_allclose(27.0 * found["b1"] ** 2, 4.0 * found["b2"] ** 3, atol=1e-12)
    np.testing.assert_allclose(found["b2"], 3.0 * found["x"] ** 2, atol=1e-12)
    (point,) = labelled(found, *TWO)
    assert point.label == "CP"
    inside_errors(point, b1=0.0, b2=0.0)
    assert point.coefficients["c"] == pytest.approx(-1.0, rel=1e-12)
    assert found.outcome.reason == "bound"
    # Both ends are where b2 leaves its range, whichever parameter comes first.
    assert found["b2"][0] == found["b2"][-1] == 2.0
    assert sorted(found["b1"][[0, -1]]) == pytest.approx([-math.sqrt(32.0 / 27.0), math.sqrt(32.0 / 27.0)])


def test_hopf_points_of_the_brusselator() -> None:
    found = curve(
        brusselator,
        ["x", "y"],
        "HB",
        "B",
        {"A": 1.0, "B": 1.0},
        {"B": (0.5, 4.0), "A": (0.1, 3.0)},
        [1.0, 1.0],
    )
    np.testing.assert_allclose(found["B"], 1.0 + found["A"] ** 2, rtol=1e-13)
    np.testing.assert_allclose(found["frequency_squared"], found["A"] ** 2, rtol=1e-12)
    assert not labelled(found, *TWO)
    assert found["A"].min() == 0.1
    assert found["B"].max() == 4.0


@pytest.mark.long
def test_the_first_lyapunov_coefficient_vanishes() -> None:
    ranges = {"mu": (-1.0, 1.0), "beta": (-1.0, 1.5)}
    found = curve(bautin, ["x", "y"], "HB", "mu", {"mu": -0.5, "beta": 1.2, "gap": 0.25}, ranges)
    np.testing.assert_allclose(found["mu"], 0.0, atol=1e-15)
    points = labelled(found, *TWO)
    assert [point.label for point in points] == ["GH", "GH"]
    for point, beta in zip(sorted(points, key=lambda p: p.parameters["beta"]), (-0.5, 0.5), strict=True):
        inside_errors(point, mu=0.0, beta=beta)
        # x^2 + y^2 = 2 |w|^2 for <q, q> = 1: the quintic coefficient -1 is -4 of w |w|^4.
        assert point.coefficients["l2"] == pytest.approx(-4.0, rel=1e-12)
        assert point.coefficients["omega"] == pytest.approx(3.0, rel=1e-14)


@pytest.mark.long
def test_two_generalized_hopf_points_within_a_step() -> None:
    ranges = {"mu": (-1.0, 1.0), "beta": (-1.0, 1.5)}
    found = curve(bautin, ["x", "y"], "HB", "mu", {"mu": -0.5, "beta": 1.2, "gap": 1e-6}, ranges)
    points = labelled(found, *TWO)
    assert sorted(at(point, "beta")[0] for point in points) == pytest.approx([-1e-3, 1e-3], rel=1e-12)


def test_a_curve_of_centres_has_no_generalized_hopf_points() -> None:
    """The first Lyapunov coefficient is zero all along, which rounding of its terms is of either sign."""
    ranges = {"mu": (-1.0, 1.0), "b": (0.1, 2.0)}
    found = curve(centre, ["x", "y"], "HB", "mu", {"mu": 0.0, "b": 0.5}, ranges)
    np.testing.assert_allclose(found["mu"], found["b"], rtol=1e-13)
    assert (found["b"].min(), found["b"].max()) == pytest.approx((0.1, 1.0), rel=1e-13)
    assert not labelled(found, *TWO)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", ["LP", "HB"])
def test_zero_hopf_points_from_both_curves(start) -> None:
    ranges = {"b1": (-1.0, 1.0), "b2": (-0.9, 0.9)}
    problem = small_problem(zero_hopf, ["x", "y", "z"], {"b1": -0.8, "b2": 0.2, "theta": 0.75}, "b1")
    branch = cw.continue_branch(problem, [-0.9, 0.0, 0.0], range=ranges["b1"])
    found = cw.continue_locus(problem.system, branch, f"{start}1", ranges)
    (point,) = labelled(found, "ZH")
    inside_errors(point, b1=0.0, b2=0.0)
    c = point.coefficients
    assert (c["s"], c["theta"]) == (-1.0, pytest.approx(0.375, rel=1e-12))
    # f200 = 1, f011 = -2, g210 = 1/2, all other cubic terms vanish: E = g210.
    assert c["E"] == pytest.approx(0.5, rel=1e-12)
    assert abs(point.unstable_after - point.unstable_before) == (2 if start == "LP" else 1)
    if start == "LP":
        np.testing.assert_allclose(found["b1"], 0.0, atol=1e-15)
    else:
        x = found["x"]
        np.testing.assert_allclose(found["b1"], -(x**2), atol=1e-14)
        np.testing.assert_allclose(found["b2"], -0.75 * x - 0.5 * x**2, atol=1e-14)
        # The amplitude moves x by r / (2 x), and the growth by (theta + x) times that.
        (bautin,) = labelled(found, "GH")
        inside_errors(bautin, b1=-(0.75**2), b2=0.75**2 / 2.0)
    assert len(labelled(found, *TWO)) == (1 if start == "LP" else 2)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("free", ["m1", "m2"])
def test_double_hopf_points_from_both_curves(free) -> None:
    other = "m2" if free == "m1" else "m1"
    ranges = {free: (-1.0, 1.0), other: (-1.0, 1.0)}
    parameters = {"m1": 0.0, "m2": 0.0, free: -0.5, other: -0.7}
    found = curve(double_hopf, ["a", "b", "c", "d"], "HB", free, parameters, ranges)
    (point,) = labelled(found, *TWO)
    assert point.label == "HH"
    inside_errors(point, m1=0.0, m2=0.0)
    c = point.coefficients
    assert (c["omega_1"], c["omega_2"]) == pytest.approx((5.0, 1.0), rel=1e-14)
    # |.|^2 = 2 |w|^2 for <q, q> = 1.
    assert [c[name] for name in ("p11", "p12", "p21", "p22")] == pytest.approx(
        [-2.0, 4.0, 6.0, -8.0], rel=1e-12
    )
    assert (c["theta"], c["delta"]) == pytest.approx((-0.5, -3.0), rel=1e-12)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("start", "b2"), [("LP", 0.7), ("HB", -0.7)])
def test_bogdanov_takens_points_from_both_curves(start, b2) -> None:
    ranges = {"b1": (-1.0, 1.0), "b2": (-1.5, 1.5)}
    problem = small_problem(bogdanov_takens, ["x", "y"], {"b1": -0.4, "b2": b2}, "b1")
    x = 0.5 * (-b2 - math.sqrt(b2**2 + 1.6))
    branch = cw.continue_branch(problem, [x, 0.0], range=ranges["b1"])
    found = cw.continue_locus(problem.system, branch, f"{start}1", ranges)
    (point,) = labelled(found, *TWO)
    assert point.label == "BT"
    inside_errors(point, b1=0.0, b2=0.0)
    assert (point.coefficients["a"], point.coefficients["b"]) == pytest.approx((1.0, -1.0), rel=1e-12)
    if start == "LP":
        np.testing.assert_allclose(found["b1"], found["b2"] ** 2 / 4.0, atol=1e-14)
    else:
        # Beyond it the curve goes on as neutral saddles, real eigenvalues +-s with s^2 = b2.
        np.testing.assert_allclose(found["b1"], 0.0, atol=1e-14)
        np.testing.assert_allclose(found["frequency_squared"], -found["b2"], atol=1e-13)
        assert found["b2"].max() == 1.5


def test_no_curve_begins_at_other_points() -> None:
    problem = small_problem(cusp, ["x"], {"b1": -1.0, "b2": 1.0}, "b1")
    branch = cw.continue_branch(problem, [-1.3], range=(-2.0, 2.0))
    with pytest.raises(StartError, match="No curve in two parameters can be followed from EP1"):
        cw.continue_locus(problem.system, branch, "EP1", {"b1": (-2.0, 2.0), "b2": (-1.0, 2.0)})
    with pytest.raises(StartError, match=r"LP1 has b2 = 1, outside the range \[2, 3\]"):
        cw.continue_locus(problem.system, branch, "LP1", {"b1": (-2.0, 2.0), "b2": (2.0, 3.0)})
    with pytest.raises(StartError, match="A curve needs two parameters, and 1 are given"):
        cw.continue_locus(problem.system, branch, "LP1", {"b1": (-2.0, 2.0)})


def test_a_quadratic_coefficient_that_is_rounding_divides_nothing() -> None:
    """A food chain: where predators without their own have most to eat they begin to oscillate."""

    def chain(t, x, p, dx):
        first, second = 5.0 * x[0] / (1.0 + 3.0 * x[0]), 0.1 * x[1] / (1.0 + 2.0 * x[1])
        dx[0] = x[0] * (p.k - x[0]) - first * x[1]
        dx[1] = first * x[1] - 0.4 * x[1] - second * x[2]
        dx[2] = second * x[2] - p.d * x[2]

    x = 0.4 / 3.8
    found = curve(
        chain,
        ["x", "y", "z"],
        "HB",
        "k",
        {"k": 0.3, "d": 0.008},
        {"k": (0.11, 0.9), "d": (0.005, 0.012)},
        [x, (0.3 - x) * (1.0 + 3.0 * x) / 5.0, 0.0],
    )
    (point,) = labelled(found, "ZH")
    # At the Hopf point k = 1/3 + 2 x there is y = (k - x) (1 + 3 x) / 5 to eat.
    y = (1.0 / 3.0 + x) * (1.0 + 3.0 * x) / 5.0
    assert at(point, "k", "d") == pytest.approx([1.0 / 3.0 + 2.0 * x, 0.1 * y / (1.0 + 2.0 * y)], rel=1e-14)
    assert {"s", "theta", "E"}.isdisjoint(point.coefficients)


def oscillator(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.push + p.softness * x[0] - x[0] ** 3 + (0.3 - x[0] ** 2) * x[1]


@pytest.mark.long
def test_a_curve_on_which_a_velocity_is_zero_and_its_drag_vanishes_is_walked_in_few_steps() -> None:
    """On it x^2 = 0.3: the velocity's drag is zero to rounding, and so is the velocity, exactly.

    What one is divided by the other is no magnitude. The curve is push = x^3 - softness x.
    """
    problem = small_problem(oscillator, "xv", {"push": 0.0, "softness": 0.5}, "push")
    branch = cw.continue_branch(problem, [0.7, 0.0], range=(-1.0, 1.0))
    curve = cw.continue_locus(problem.system, branch, "HB1", {"push": (-1.0, 1.0), "softness": (-1.0, 1.0)})
    assert curve.outcome.reason == "bound"
    assert len(curve) < 300  # it has a GH, a BT and two ends, at each of which steps begin short
    x = -math.sqrt(0.3)
    # Newton's method ends at rounding of terms below one.
    assert np.max(np.abs(curve["push"] - x**3 + curve["softness"] * x)) < 1e-15
    (double,) = labelled(curve, "BT")
    assert double.parameters["softness"] == pytest.approx(0.9, rel=1e-15)


def test_a_slope_that_a_solution_leaves_of_zero_tells_no_magnitude() -> None:
    """At a Bogdanov-Takens point the slope by x is zero: known to 1e-10, terms over it were 1e9.

    A curve that began there was followed once more, in steps by that metric.
    """
    problem = small_problem(oscillator, "xv", {"push": 0.0, "softness": 0.9}, "push")
    x = -math.sqrt(0.3) * (1.0 + 1e-10)
    magnitudes = problem.linearize(np.array([x, 0.0, x**3 - 0.9 * x])).magnitudes
    assert magnitudes[0] == abs(x)
