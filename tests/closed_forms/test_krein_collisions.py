"""Krein collisions: pairs of opposite signature leave the border of stability, others pass each other.

Equilibria in closed form; multipliers of linear equations by SciPy.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

HEAD = """\
import math
from contwalk.system import Conserved, Mode, Parameter, Start, State, System
"""
# x'' - g y' + a x + x^3 = 0, y'' + g x' + b y + y^3 = 0: lambda^4 + (g^2 + a + b) lambda^2 + a b = 0.
GYROSCOPE = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[2], x[3]
    dx[2] = p.g * x[3] - p.a * x[0] - x[0] ** 3 - p.c * x[2]
    dx[3] = -p.g * x[2] - p.b * x[1] - x[1] ** 3 - p.c * x[3]
def energy(t, x, p):
    return 0.5 * (x[2] ** 2 + x[3] ** 2 + p.a * x[0] ** 2 + p.b * x[1] ** 2) + 0.25 * (x[0] ** 4 + x[1] ** 4)
SYSTEM = System("gyroscope", states=(State("x"), State("y"), State("u"), State("v")),
    parameters=(Parameter("g", {g}), Parameter("a", {a}), Parameter("b", {b}), Parameter("c", {c})),
    modes=(Mode("m", field),), starts=(Start("rest", lambda p: [[0.0, 0.0, 0.0, 0.0]]),){conserved})
"""
# x'' + x + 0.2 cos(W t) y + ... = 0, y'' + 2 y + 0.2 cos(W t) x + ... = 0
FORCED = """\
def field(t, x, p, dx):
    c = 0.2 * math.cos(p.W * t)
    dx[0], dx[1] = x[2], x[3]
    dx[2] = -x[0] - c * x[1] - 0.3 * x[0] ** 3
    dx[3] = -2.0 * x[1] - c * x[0] - 0.2 * x[1] ** 3
SYSTEM = System("forced", states=(State("x"), State("y"), State("u"), State("v")),
    parameters=(Parameter("W", {W}),), modes=(Mode("m", field),), period=lambda p: 2.0 * math.pi / p.W)
"""
# H = (u^2 + x^2 + ...) / 2 + x y z / 10: beside x = cos t two oscillators that it couples.
COUPLED = """\
def field(t, x, p, dx):
    dx[0], dx[1], dx[2] = x[3], x[4], x[5]
    dx[3] = -x[0] - 0.1 * x[1] * x[2]
    dx[4] = -0.16 * x[1] - 0.1 * x[0] * x[2]
    dx[5] = -p.k * x[2] - 0.1 * x[0] * x[1]
def energy(t, x, p):
    kinetic = 0.5 * (x[3] ** 2 + x[4] ** 2 + x[5] ** 2)
    return kinetic + 0.5 * (x[0] ** 2 + 0.16 * x[1] ** 2 + p.k * x[2] ** 2) + 0.1 * x[0] * x[1] * x[2]
SYSTEM = System("coupled", states=tuple(State(name) for name in "xyzuvw"), parameters=(Parameter("k", {k}),),
    modes=(Mode("m", field),), conserved=(Conserved("E", energy),))
"""


def study(folder: Path, plugin: str, start: str, free: str, low: float, high: float) -> Branch:
    """The branch of a plugin's solutions in a range."""
    (folder / "small.py").write_text(HEAD + plugin)
    (folder / "run.yaml").write_text(
        f"contwalk: 1\nsystem: ./small.py\nstart: {start}\n"
        f"continue: {{parameter: {free}, range: [{low}, {high}]}}\ndiagram: {{follow: none}}\n"
    )
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), figures=False)
    return result.branches[0]


def bifurcations(branch: Branch) -> list[SpecialPoint]:
    assert branch.outcome.reason == "bound", branch.outcome.message
    return [point for point in branch.special_points if point.label != "EP"]


def assert_collision(point: SpecialPoint, label: str, free: str, truth: float, known: float) -> None:
    """`known`: the largest error that may be claimed."""
    assert (point.label, point.criticality, point.coefficients["pairs"]) == (label, None, 2)
    assert point.note is not None
    assert point.note.startswith("Krein collision")
    assert abs(point.parameters[free] - truth) <= point.error <= known


REST = "{state: {x: 0.0, y: 0.0, u: 0.0, v: 0.0}}"


@pytest.mark.parametrize(
    "conserved", ["", ", conserved=(Conserved('E', energy),)"], ids=["silent", "declared"]
)
def test_a_gyroscope_stabilizes_two_maxima_at_a_hamiltonian_hopf_point(tmp_path, conserved):
    """With a b > 0 the pairs meet where g^2 + a + b = 2 (a b)^1/2, at g = 1 + 2^1/2 with omega = 2^1/4."""
    plugin = GYROSCOPE.format(g=1.0, a=-1.0, b=-2.0, c=0.0, conserved=conserved)
    branch = study(tmp_path, plugin, "{equilibrium: rest}", "g", 0.5, 4.0)
    (point,) = bifurcations(branch)
    assert_collision(point, "HB", "g", 1.0 + math.sqrt(2.0), 1e-12)
    assert point.coefficients["omega"] == pytest.approx(2.0**0.25, abs=1e-7)  # eigenvalues: half the digits
    assert (point.unstable_before, point.unstable_after) == (2, 0)
    aside = np.abs(branch["g"] - 1.0 - math.sqrt(2.0)) > 1e-9
    gyroscopic = branch["g"][aside] > 1.0 + math.sqrt(2.0)
    assert np.all(branch.points["unstable"][aside] == np.where(gyroscopic, 0, 2))


def test_pairs_of_one_signature_pass_through_each_other(tmp_path):
    """Two oscillators without coupling: their frequencies are equal at b = 1, and nothing happens."""
    plugin = GYROSCOPE.format(g=0.0, a=1.0, b=0.5, c=0.0, conserved="")
    branch = study(tmp_path, plugin, "{equilibrium: rest}", "b", 0.4, 2.0)
    assert bifurcations(branch) == []
    assert np.all(branch.points["unstable"] == 0)


def test_damping_takes_the_stabilization_away(tmp_path):
    """Kelvin and Chetaev: with any damping two maxima are unstable in two directions, whatever g."""
    plugin = GYROSCOPE.format(g=1.0, a=-1.0, b=-2.0, c=0.01, conserved="")
    branch = study(tmp_path, plugin, "{equilibrium: rest}", "g", 0.5, 4.0)
    assert bifurcations(branch) == []
    assert np.all(branch.points["unstable"] == 2)


def monodromy(matrix, period: float) -> np.ndarray:
    """Of y' = matrix(t) y, shape (4, 4)."""
    found = solve_ivp(
        lambda t, y: (matrix(t) @ y.reshape(4, 4)).ravel(),
        (0.0, period),
        np.eye(4).ravel(),
        "DOP853",
        rtol=3e-14,
        atol=1e-14,
    )
    return found.y[:, -1].reshape(4, 4)


def quadruple(m: np.ndarray) -> float:
    """Of mu^4 + a mu^3 + b mu^2 + a mu + 1: negative where its roots are a quadruple."""
    a = -np.trace(m)
    b = 0.5 * (a * a - np.trace(m @ m))
    return float(0.25 * a * a - b + 2.0)


def forced(w: float) -> float:
    def matrix(t: float) -> np.ndarray:
        c = 0.2 * math.cos(w * t)
        return np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-1.0, -c, 0, 0], [-c, -2.0, 0, 0]])

    return quadruple(monodromy(matrix, 2.0 * math.pi / w))


def test_a_sum_resonance_has_its_borders_and_a_difference_resonance_has_none(tmp_path):
    """At W = 1 + 2^1/2 frequencies of opposite signature of the map meet, at 2^1/2 - 1 those of the same."""
    (tmp_path / "sum").mkdir()
    points = bifurcations(study(tmp_path / "sum", FORCED.format(W=2.25), REST, "W", 2.2, 2.7))
    borders = [brentq(forced, *bracket, xtol=1e-14) for bracket in ((2.25, 2.4), (2.45, 2.6))]
    assert len(points) == 2
    for point, border in zip(points, borders, strict=True):
        assert_collision(point, "NS", "W", border, 1e-11)
    assert [(p.unstable_before, p.unstable_after) for p in points] == [(0, 2), (2, 0)]
    (tmp_path / "difference").mkdir()
    assert bifurcations(study(tmp_path / "difference", FORCED.format(W=0.4), REST, "W", 0.38, 0.45)) == []


def coupled(k: float) -> float:
    def matrix(t: float) -> np.ndarray:
        c = 0.1 * math.cos(t)
        return np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-0.16, -c, 0, 0], [-c, -k, 0, 0]])

    return quadruple(monodromy(matrix, 2.0 * math.pi))


@pytest.mark.long
def test_orbits_of_a_given_energy(tmp_path):
    """The oscillation in x at H = 1/2 excites the others where their frequencies, 0.4 and k^1/2, sum to 1."""
    start = "{simulate: {state: {x: 1.0, y: 0.0, z: 0.0, u: 0.0, v: 0.0, w: 0.0}, until: settled}}"
    points = bifurcations(study(tmp_path, COUPLED.format(k=0.22), start, "k", 0.2, 0.55))
    borders = [brentq(coupled, *bracket, xtol=1e-14) for bracket in ((0.2, 0.36), (0.36, 0.55))]
    assert len(points) == 2
    for point, border in zip(points, borders, strict=True):
        assert_collision(point, "NS", "k", border, 1e-9)
