"""Curves of branch points that persist, and of marked values, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import StartError
from contwalk.system import Observable

RANGES = {"a": (-1.0, 2.0), "b": (-1.0, 1.2)}


def pitchfork(t, x, p, dx):
    """Symmetric in x: branch points where a = b^2; u settles at x^2."""
    dx[0] = x[0] * (p.a - p.b**2 - x[1])
    dx[1] = x[0] ** 2 - x[1]


def transcritical(t, x, p, dx):
    """x = 0 stays: branch points where a = sin(b)."""
    dx[0] = x[0] * (p.a - np.sin(p.b) - x[0])


def circle(t, x, p, dx):
    """Pitchforks where a^2 + b^2 = 1, one branch of which moves along u: parallel to either axis twice."""
    dx[0] = x[0] * (1.0 - p.a**2 - p.b**2 + p.c * x[0] - x[0] ** 2)
    dx[1] = p.a - x[1] + 0.3 * x[0]


def unfolded(t, x, p, dx):
    """A branch point where b = 0 only; it comes apart with the first power of b."""
    dx[0] = p.b + x[0] * (p.a - x[0])


def gently_unfolded(t, x, p, dx):
    """A branch point where b = 0 only; it comes apart with the square of b."""
    dx[0] = p.b**2 + x[0] * (p.a - x[0])


def coupled(t, x, p, dx):
    """x = 0 is a branch point where a = b; a pair of the others passes the axis where b = 1/2."""
    dx[0] = x[0] * (p.a - p.b - x[0] ** 2)
    dx[1] = (p.b - 0.5) * x[1] - 2.0 * x[2] - x[1] ** 3
    dx[2] = 2.0 * x[1] + (p.b - 0.5) * x[2]


def brusselator(t, x, p, dx):
    """The equilibrium is (A, B / A); its trace is B - 1 - A^2, its determinant A^2."""
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def bending(t, x, p, dx):
    """A fold where a = b, to which the curve of x = 1 comes where it is not."""
    dx[0] = p.a - p.b * x[0] + x[0] ** 2


def total(t, x, p):
    return x[0, 0] + x[0, 1]


def curve(field, states, parameters, free, state, ranges, which, marks=None, **declared) -> Branch:
    system = small_system(field, states, parameters, **declared)
    problem = cw.Equilibrium(system, parameters, free)
    branch = cw.continue_branch(problem, state, range=ranges[free], marks=marks or {})
    return cw.continue_locus(system, branch, which, ranges)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("field", "states", "place"),
    [(pitchfork, "xu", lambda b: b**2), (transcritical, "x", np.sin)],
)
def test_branch_points_that_persist(field, states, place) -> None:
    found = curve(field, states, {"a": -0.5, "b": 0.3}, "a", [0.0] * len(states), RANGES, "BP1")
    assert found.info.settings["of"] == "BP"
    np.testing.assert_allclose(found["a"], place(found["b"]), atol=1e-14)
    np.testing.assert_allclose(found["x"], 0.0, atol=1e-15)
    assert sorted(found["b"][[0, -1]]) == pytest.approx([-1.0, 1.2], abs=1e-14)
    assert [p.label for p in found.special_points] == ["EP", "EP"]
    assert found.outcome.reason == "bound"


@pytest.mark.long
def test_a_circle_of_branch_points() -> None:
    ranges = {"a": (-1.5, 1.5), "b": (-1.5, 1.5)}
    found = curve(circle, "xu", {"a": -1.5, "b": 0.2, "c": 0.4}, "a", [0.0, -1.5], ranges, "BP1")
    np.testing.assert_allclose(found["a"] ** 2 + found["b"] ** 2, 1.0, atol=1e-13)
    assert found.outcome.reason == "closed"
    assert [p.label for p in found.special_points] == ["EP"]


@pytest.mark.parametrize("field", [unfolded, gently_unfolded])
def test_branch_points_that_do_not_persist_are_refused(field) -> None:
    with pytest.raises(StartError, match=r"from BP1.*does not persist as b varies.*follow the folds"):
        curve(field, "x", {"a": -0.5, "b": 0.0}, "a", [0.0], RANGES, "BP1")


@pytest.mark.long
def test_stability_beside_a_curve_of_branch_points() -> None:
    found = curve(coupled, "xyz", {"a": -0.5, "b": 0.3}, "a", [0.0, 0.0, 0.0], RANGES, "BP1")
    np.testing.assert_allclose(found["a"], found["b"], atol=1e-14)
    assert found["unstable"][np.argmin(found["b"])] == 0
    assert found["unstable"][np.argmax(found["b"])] == 2
    (point,) = labelled(found, "ZH")
    assert point.status == "located"
    for name in ("a", "b"):
        assert abs(point.parameters[name] - 0.5) <= point.errors[name] <= 1e-15
    assert point.coefficients["omega"] == pytest.approx(2.0, rel=1e-15)


AB = {"B": (0.5, 4.0), "A": (0.1, 3.0)}


def marked(marks, which="UZ1") -> Branch:
    observables = (Observable("total", total),)
    parameters = {"A": 1.0, "B": 1.0}
    return curve(brusselator, "xy", parameters, "B", [1.0, 1.0], AB, which, marks, observables=observables)


def test_a_value_of_an_observable() -> None:
    found = marked({"total": [2.5]})
    np.testing.assert_allclose(found["A"] + found["B"] / found["A"], 2.5, rtol=1e-14)
    assert found.info.settings["of"] == "UZ"


@pytest.mark.long
def test_a_value_of_one_of_both_parameters_crosses_the_curve_of_hopf_points() -> None:
    found = marked({"B": [2.25]})
    np.testing.assert_array_equal(found["B"], 2.25)
    (hopf,) = labelled(found, "HB")
    assert abs(hopf.parameters["A"] - 1.25**0.5) <= hopf.errors["A"] <= 1e-14
    assert (hopf.unstable_before, hopf.unstable_after) == (2, 0)
    one = curve(brusselator, "xy", {"A": 1.25**0.5, "B": 1.0}, "B", [1.25**0.5, 1.0 / 1.25**0.5], AB, "HB1")
    assert one.info.settings["of"] == "HB"
    assert hopf.criticality == "supercritical"  # as everywhere on it


@pytest.mark.drawn(1)
@pytest.mark.parametrize("level", [0.25, -0.1])
def test_a_value_of_the_largest_real_part(level) -> None:
    found = marked({"max_re": [level]})
    np.testing.assert_allclose(found["B"] - 1.0 - found["A"] ** 2, 2.0 * level, atol=1e-13)
    # The pair's imaginary part vanishes where A = |level|; beyond there are two real ones: neither is held.
    assert found["A"].min() == pytest.approx(abs(level), rel=1e-13)


@pytest.mark.long
def test_zero_as_the_largest_real_part_is_the_curve_of_hopf_points() -> None:
    assert marked({"max_re": [0.0]}).info.settings["of"] == "HB"


@pytest.mark.long
def test_a_real_eigenvalue_at_a_value() -> None:
    ranges = {"a": (-2.0, 1.0), "b": (-3.0, 3.0)}
    found = curve(bending, "x", {"a": -1.0, "b": 1.0}, "a", [-0.6], ranges, "UZ1", {"max_re": [-1.5]})
    # The eigenvalue is 2 x - b, and a = b x - x^2.
    np.testing.assert_allclose(2.0 * found["x"] - found["b"], -1.5, atol=1e-13)
    np.testing.assert_allclose(found["a"], found["b"] * found["x"] - found["x"] ** 2, atol=1e-13)


def test_extrema_are_refused_with_a_sentence() -> None:
    def away(t, x, p):
        return (x[0, 0] - 0.25) ** 2

    ranges = {"a": (-2.0, 1.0), "b": (-3.0, 3.0)}
    with pytest.raises(StartError, match="it is an extremum of away"):
        curve(
            bending,
            "x",
            {"a": -1.0, "b": 1.0},
            "a",
            [-0.6],
            ranges,
            "UZ1",
            {"away": ["extremum"]},
            observables=(Observable("away", away),),
        )
