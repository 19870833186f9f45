"""What is told of equilibria that an orbit creeps past."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.slow_place import SlowPlace


def nowhere(*told) -> np.ndarray:
    raise AssertionError("nothing is computed to describe an equilibrium")


def test_rounding_beside_the_range_of_the_orbit_is_told_as_zero() -> None:
    scale = np.array([10.0, 1e-12])
    place = SlowPlace(("x", "y"), 0.0, 1.0, np.zeros(2), scale, np.zeros((1, 2)), nowhere, nowhere, nowhere)
    # 1e-13 is small beside the range 10 of x, and a tenth of that of y.
    assert place.described(np.array([-1e-13, 1e-13])) == "x = 0, y = 1e-13"
