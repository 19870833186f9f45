"""Tangents of Radau IIA are derivatives of its steps."""

from __future__ import annotations

import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow import Field, adaptive, along, tangents
from contwalk.flow.tableaus.radau import RADAU5, RADAU9, Collocation

TABLEAUS = {"radau5": RADAU5, "radau9": RADAU9}
SEEDS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def van_der_pol() -> Field:
    return field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1, [0])


def end_of_complex_steps(tableau: Collocation, times: np.ndarray, x: np.ndarray, mu: complex) -> np.ndarray:
    """The same steps of van der Pol's oscillator in complex numbers, by Newton's method as it stands."""
    s, a = tableau.stages, np.array(tableau.matrix)
    for h in np.diff(times):
        z = np.zeros((s, 2), dtype=complex)
        for _ in range(30):
            u, v = (x + z).T
            f = np.stack([v, mu * (1.0 - u**2) * v - u], axis=1)
            matrix = np.eye(2 * s, dtype=complex)
            for i in range(s):
                block = np.array([[0.0, 1.0], [-2.0 * mu * u[i] * v[i] - 1.0, mu * (1.0 - u[i] ** 2)]])
                matrix[:, 2 * i : 2 * i + 2] -= h * np.kron(a[:, i : i + 1], block)
            change = np.linalg.solve(matrix, (z - h * a @ f).ravel()).reshape(s, 2)
            z = z - change
            reach = np.abs(z.real).max(axis=0) + np.abs(x.real)
            if np.all(np.abs(change.real) <= 1e-14 * reach) and np.all(
                np.abs(change.imag) <= 1e-12 * np.abs(z.imag).max() + 1e-300
            ):
                break
        x = x + z[-1]
    return x


@pytest.mark.parametrize("method", ["radau5", "radau9"])
@pytest.mark.parametrize(("mu", "end", "tolerance"), [(5.0, 10.0, 1e-11), (1e3, 900.0, 1e-7)])
def test_tangents_are_derivatives_of_the_steps(method: str, mu: float, end: float, tolerance: float) -> None:
    """By complex steps of 1e-40, which have no truncation error, through a relaxation jump too.

    What is left are differences in rounding along the path: over a jump of mu = 1000 a deviation in x grows
    by 1500 (the time of the jump) times 1e3 (the speed in it), so that 1e-16 turns into 1e-10 of a tangent
    or, where x jumps at 1e6 a second squared, some times that.
    """
    field = van_der_pol()
    c, start = field.constants([mu]), np.array([2.0, 0.0])
    times = adaptive(field, c, 0.0, start, end, 1e-8, [2.0, 1.5 * mu], method).times
    x, X = tangents(field, c, times, start, SEEDS, [-1, -1, 0], method)
    assert np.array_equal(x, along(field, c, times, start, method)[-1])
    for j, (dx, dy, dmu) in enumerate([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]):
        moved = start + 1e-40j * np.array([dx, dy])
        truth = end_of_complex_steps(TABLEAUS[method], times, moved, mu + 1e-40j * dmu).imag / 1e-40
        np.testing.assert_allclose(X[:, j], truth, rtol=tolerance)


def test_tangents_are_differences_of_the_frozen_grid() -> None:
    """Where steps of 1e-5 stay within what the grid resolves: not across a relaxation jump, see above."""
    field = van_der_pol()
    c, start = field.constants([5.0]), np.array([2.0, 0.0])
    times = adaptive(field, c, 0.0, start, 10.0, 1e-8, [2.0, 7.5], "radau9").times
    X = tangents(field, c, times, start, SEEDS, [-1, -1, 0], "radau9")[1]
    for j, step in enumerate(1e-5 * np.eye(3)):

        def end_at(factor: float, step: np.ndarray = step) -> np.ndarray:
            moved = field.constants([5.0 + factor * step[2]])
            return along(field, moved, times, start + factor * step[:2], "radau9")[-1]

        difference = (8.0 * (end_at(1) - end_at(-1)) - (end_at(2) - end_at(-2))) / 12e-5
        # rounding of the states, 1e-15, over a step of 1e-5
        np.testing.assert_allclose(X[:, j], difference, rtol=1e-7, atol=1e-9)


def test_every_node_is_what_shorter_grids_give() -> None:
    field = van_der_pol()
    c, start = field.constants([50.0]), np.array([2.0, 0.0])
    times = adaptive(field, c, 0.0, start, 45.0, 1e-8, [2.0, 75.0], "radau9").times
    states, nodes = tangents(field, c, times, start, SEEDS, [-1, -1, 0], "radau9", every=True)
    assert np.array_equal(nodes[0], SEEDS)
    for k in (1, len(times) // 2, len(times) - 1):
        x, X = tangents(field, c, times[: k + 1], start, SEEDS, [-1, -1, 0], "radau9")
        assert np.array_equal(states[k], x)
        assert np.array_equal(nodes[k], X)


def test_tangents_of_steps_that_fail_are_nan() -> None:
    field = field_of(lambda t, x, p: [p[0] * np.sqrt(x[0] - 1.0)], 1, 1, [0])
    c = field.constants([-3.0])
    x, X = tangents(field, c, np.linspace(0.0, 5.0, 6), [2.0], np.eye(1), [-1], "radau9")
    assert np.isnan(x).all()
    assert np.isnan(X).all()


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
