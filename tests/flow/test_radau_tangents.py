"""Tangents of Radau IIA are derivatives of its steps."""

from __future__ import annotations

import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow import adaptive, along, tangents


@pytest.mark.parametrize("method", ["radau5", "radau9"])
@pytest.mark.parametrize(("mu", "end"), [(5.0, 10.0), (1e3, 900.0)])
def test_tangents_are_differences_of_the_frozen_grid(method: str, mu: float, end: float) -> None:
    field = field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1, [0])
    c, start = field.constants([mu]), np.array([2.0, 0.0])
    times = adaptive(field, c, 0.0, start, end, 1e-8, [2.0, 1.5 * mu], method).times
    seeds = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    x, X = tangents(field, c, times, start, seeds, [-1, -1, 0], method)
    assert np.array_equal(x, along(field, c, times, start, method)[-1])
    # of a relaxation oscillation so little that the jump stays within the short steps made for it
    size = 1e-5 if mu < 100.0 else 1e-8
    steps = [
        size * np.array([2.0, 0.0, 0.0]),
        size * np.array([0.0, 1.0, 0.0]),
        size * np.array([0.0, 0.0, mu]),
    ]
    for j, step in enumerate(steps):

        def end_at(factor: float, step: np.ndarray = step) -> np.ndarray:
            moved = field.constants([mu + factor * step[2]])
            return along(field, moved, times, start + factor * step[:2], method)[-1]

        difference = (8.0 * (end_at(1) - end_at(-1)) - (end_at(2) - end_at(-2))) / (12.0 * np.abs(step).sum())
        # rounding of the states, 1e-15, over a step of 1e-8 in a tangent that has decayed to 1e-3
        np.testing.assert_allclose(X[:, j], difference, rtol=1e-4 if mu > 100.0 else 1e-6)


def test_liouville_on_a_stiff_problem() -> None:
    """det X = exp of the integral of the divergence, here constant: -1000 - 1 over 0.01."""
    field = field_of(
        lambda t, x, p: [-p[0] * (x[0] - np.sin(x[1])), -x[1] + np.cos(x[0]) - np.cos(x[0])], 2, 1
    )
    c = field.constants([1e3])
    path = adaptive(field, c, 0.0, [0.5, 1.0], 0.01, 1e-12, [1.0, 1.0], "radau9")
    X = tangents(field, c, path.times, [0.5, 1.0], np.eye(2), [-1, -1], "radau9")[1]
    # the factor of each step is exact to its tolerance 1e-12 relative to 1, and the determinant is 4.5e-5
    assert np.linalg.det(X) == pytest.approx(np.exp(-10.01), rel=1e-6)
