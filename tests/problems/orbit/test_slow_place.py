"""What is told of equilibria that an orbit creeps past."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contwalk.problems.orbit.slow_place import SlowPlace


def nowhere(*told) -> np.ndarray:
    raise AssertionError("nothing is computed to describe an equilibrium")


def test_rounding_beside_the_range_of_the_orbit_is_told_as_zero() -> None:
    scale = np.array([10.0, 1e-12])
    place = SlowPlace(("x", "y"), 0.0, 1.0, np.zeros(2), scale, np.zeros((1, 2)), nowhere, nowhere, nowhere)
    # 1e-13 is small beside the range 10 of x, and a tenth of that of y.
    assert place.described(np.array([-1e-13, 1e-13])) == "x = 0, y = 1e-13"


def beside_a_pole(near: float) -> SlowPlace:
    """x' = x - pole / (x + pole) in one state, with an orbit at x = 1; `near` is where the pole is."""

    def velocity(x: np.ndarray) -> np.ndarray:
        return x - (x - near) / (x + near)

    def jacobian(x: np.ndarray) -> np.ndarray:
        return np.array([[float(1.0 - 2.0 * near / (x[0] + near) ** 2)]])

    state, scale = np.array([1.0]), np.array([10.0])
    return SlowPlace(("x",), 0.0, 1.0, state, scale, state[None], velocity, jacobian, nowhere)


@pytest.mark.parametrize("near", [1e-1, 1e-2, 1e-4, 1e-6])
def test_an_equilibrium_behind_a_pole_of_the_field_is_not_nearby(near: float) -> None:
    place = beside_a_pole(near)
    # x^2 + (near - 1) x + near = 0 with the pole at -near: the smaller root is beside it.
    behind = 0.5 * (1.0 - near - np.sqrt((1.0 - near) ** 2 - 4.0 * near))
    assert place.equilibrium(np.array([behind])) is not None  # the pole is not on the way to the orbit
    mirrored = replace(place, velocity=lambda x: -place.velocity(-x), jacobian=lambda x: place.jacobian(-x))
    assert mirrored.equilibrium(np.array([-behind])) is None


def test_an_equilibrium_beside_a_steep_place_is_nearby() -> None:
    """tanh of a thousand times x rises as steeply as a pole does, and no further."""
    place = replace(
        beside_a_pole(1.0),
        velocity=lambda x: x + 3.0 + np.tanh(1e3 * x),
        jacobian=lambda x: np.array([[1.0 + 1e3 / np.cosh(min(1e3 * abs(x[0]), 300.0)) ** 2]]),
    )
    assert place.equilibrium(np.array([-2.0])) is not None
