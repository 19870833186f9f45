"""Broyden's method by the derivatives of another place."""

from __future__ import annotations

import numpy as np

from contwalk.numerics.broyden import broyden_step


def solved(f, inverse: np.ndarray, x: np.ndarray, steps: int) -> list[float]:
    """Sizes of the residuals, beginning with the first one."""
    known, sizes = list[np.ndarray](), [float(np.linalg.norm(f(x)))]
    for _ in range(steps):
        known.append(broyden_step(-inverse @ f(x), known))
        x = x + known[-1]
        sizes.append(float(np.linalg.norm(f(x))))
    return sizes


def test_linear_equations_are_solved_in_twice_as_many_steps_as_unknowns():
    """Gay's theorem: D. M. Gay, SIAM J. Numer. Anal. 16 (1979) 623."""
    matrix = np.array([[2.0, 0.3, 0.1], [-0.2, 1.5, 0.4], [0.1, 0.2, 1.0]])
    right = np.array([1.0, -2.0, 0.5])
    sizes = solved(lambda x: matrix @ x - right, np.eye(3), np.zeros(3), 6)
    assert sizes[-1] <= 1e-13 * sizes[0]


def test_it_is_faster_than_the_chord():
    def f(x):
        return np.array([x[0] + 0.3 * x[1] ** 2 - 0.1, x[1] - 0.2 * x[0] * x[1] + 0.4 * x[0]])

    inverse, x, chord = np.eye(2), np.zeros(2), [1.0]
    for _ in range(7):
        x = x - inverse @ f(x)
        chord.append(float(np.linalg.norm(f(x))))
    assert solved(f, inverse, np.zeros(2), 7)[-1] < 1e-3 * chord[-1]
