"""Derivatives of the equations of hybrid orbits, against differences of the equations themselves."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM as WALKER
from hybrid_machines import CASES, TANK, orbit

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.orbit import variations
from contwalk.problems.orbit.scales import cycle_scales

# On fixed steps the equations are smooth, and known to rounding. Central differences with steps of h, h / 2
# and h / 4 of the unknowns' sizes, extrapolated twice, miss by (5 h)^6 and by eps / h.
STEP = 2e-3
EXACT = 1e-9
# The unknowns are moved so far from a solution, in parts of their sizes: derivatives hold everywhere.
AWAY = 1e-2


def extrapolated(function: Callable[[np.ndarray], np.ndarray], z: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Derivative of a vector or a matrix along `step`, per step."""
    found = []
    for part in (1.0, 0.5, 0.25):
        found.append((function(z + part * step) - function(z - part * step)) / (2.0 * part))
    twice = [(4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(found)]
    return (16.0 * twice[1] - twice[0]) / 15.0


def sizes(problem: HybridOrbit, z: np.ndarray) -> np.ndarray:
    """Typical magnitudes of the unknowns and the free parameter."""
    return np.append(cycle_scales(problem)[1], max(abs(z[-1]), 0.1))


def moved(problem: HybridOrbit, z: np.ndarray) -> np.ndarray:
    return z + AWAY * sizes(problem, z) * np.cos(1.0 + np.arange(len(z)))


def on_a_path(name: str) -> tuple[HybridOrbit, np.ndarray]:
    """The same orbit as one of a path along which two parameters change, its middle."""
    problem, z = orbit(name)
    values = problem.values_of(z)
    names = {"walker": ("rf", "lf"), "time-dependent guard and reset": ("A", "omega")}.get(
        name, ("drag", "inflow")
    )
    begin = values | {n: 0.9 * values[n] for n in names}
    end = values | {n: 1.1 * values[n] for n in names}
    z = np.append(z[:-1], 0.5)
    other = HybridOrbit(
        problem.system, problem.itinerary, begin, "path", (begin, end), subharmonic=problem.subharmonic
    )
    other = other.varied(turns=problem.turns)
    return other.adapted_to(z, np.append(cycle_scales(problem)[1], 1.0)), z


PROBLEMS = {name: lambda name=name: orbit(name) for name in CASES} | {
    f"path, {name}": lambda name=name: on_a_path(name)
    for name in ("walker", "time-dependent guard and reset", "different numbers of states")
}


@pytest.mark.parametrize("name", PROBLEMS)
class TestDerivatives:
    def test_jacobian(self, name):
        problem, z = PROBLEMS[name]()
        z, size = moved(problem, z), sizes(problem, z)
        jacobian = problem.linearize(z).jacobian
        rows = problem.equation_scales
        for j in range(len(z)):
            step = np.zeros(len(z))
            step[j] = STEP * size[j]
            expected = extrapolated(lambda y: problem.linearize(y).residual, z, step) / rows
            found = jacobian[:, j] * step[j] / rows
            np.testing.assert_allclose(
                found, expected, rtol=0, atol=EXACT * STEP * _largest(jacobian, rows, size)
            )

    def test_second_derivatives_along_a_direction(self, name):
        problem, z = PROBLEMS[name]()
        z, size = moved(problem, z), sizes(problem, z)
        rows = problem.equation_scales
        v = size * np.sin(2.0 + 3.0 * np.arange(len(z)))
        found = variations.derivative_along(problem, z, v)
        largest = float(np.abs(found / rows[:, None] * size).max())
        for j in range(len(z)):
            step = np.zeros(len(z))
            step[j] = STEP * size[j]
            expected = extrapolated(lambda y: problem.linearize(y).jacobian @ v, z, step) / rows
            np.testing.assert_allclose(
                found[:, j] * step[j] / rows, expected, rtol=0, atol=10.0 * EXACT * STEP * max(largest, 1.0)
            )

    def test_second_derivatives_are_symmetric(self, name):
        """DF(z) v differentiated along w is DF(z) w differentiated along v."""
        problem, z = PROBLEMS[name]()
        z, size = moved(problem, z), sizes(problem, z)
        v, w = (size * np.sin(k + np.arange(len(z))) for k in (1.0, 2.0))
        one, other = (
            variations.derivative_along(problem, z, v) @ w,
            variations.derivative_along(problem, z, w) @ v,
        )
        scale = problem.equation_scales * max(1.0, float(np.abs(one / problem.equation_scales).max()))
        np.testing.assert_allclose(one / scale, other / scale, rtol=0, atol=1e-12)  # to rounding


def _largest(jacobian: np.ndarray, rows: np.ndarray, size: np.ndarray) -> float:
    return max(1.0, float(np.abs(jacobian / rows[:, None] * size).max()))


@pytest.mark.parametrize("name", CASES)
def test_residual_is_zero_at_the_orbit(name):
    """Steps made anew for the solution miss by their tolerance, not by the thousandth that is solved to."""
    problem, z = orbit(name)
    rows = problem.equation_scales
    assert np.all(np.abs(problem.linearize(z).residual) <= 10.0 * problem.mesh.tolerance * rows)


def test_the_words_are_those_meant():
    """Every kind of transition is there, hard and soft, and modes of several sizes."""
    for name, case in CASES.items():
        problem, _ = orbit(name)
        assert sorted(leg.name for leg in problem.itinerary.legs if leg.name) == sorted(case.itinerary), name
    assert {len(TANK.states_of(mode.name)) for mode in TANK.modes} == {2, 3}
    assert {len(WALKER.states_of(mode.name)) for mode in WALKER.modes} == {6, 4}
