"""What one step of Radau IIA collocation works with: a field, a tableau and scratch, as arrays.

Imported only where it is compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, integers

EPSILON = 2.0**-52


class Equations(NamedTuple):
    """A field by addresses: right-hand side, the same with Jacobian, its pattern, and the constants."""

    rhs: int
    jac: int
    n: int
    rows: np.ndarray
    columns: np.ndarray
    c: np.ndarray


class Method(NamedTuple):
    """A tableau taken apart; `tableaus.radau` says what the parts are."""

    s: int
    nodes: np.ndarray
    matrix: np.ndarray
    inverse: np.ndarray
    error: np.ndarray
    linear: float
    mu: float
    right: np.ndarray
    left: np.ndarray
    pairs: np.ndarray


class Work(NamedTuple):
    """Scratch of a path."""

    out: np.ndarray  # f at the beginning of the step and the entries of its Jacobian
    near: np.ndarray  # the same where the matrices of Newton's method are taken
    z: np.ndarray  # increments of the step (s, n)
    old: np.ndarray  # increments of the step before (s, n)
    f: np.ndarray  # f at the nodes (s, n)
    residual: np.ndarray  # (s, n)
    delta: np.ndarray  # correction of the increments (s, n)
    lu: np.ndarray
    pivots: np.ndarray
    complex_lu: np.ndarray
    complex_pivots: np.ndarray
    weights: np.ndarray
    base: np.ndarray  # units of rounding, from the beginning of the step
    state: np.ndarray
    y: np.ndarray
    v: np.ndarray


@inlined
def method(tableau: np.ndarray, s: int) -> Method:
    """The parts of a packed tableau."""
    at = s + 2 * s * s + s
    return Method(
        s,
        tableau[:s],
        tableau[s : s + s * s],
        tableau[s + s * s : s + 2 * s * s],
        tableau[s + 2 * s * s : at],
        tableau[at],
        tableau[at + 1],
        tableau[at + 2 : at + 2 + s],
        tableau[at + 2 + s : at + 2 + 2 * s],
        tableau[at + 2 + 2 * s :],
    )


@inlined
def work(numbers: np.ndarray, pivots: np.ndarray, n: int, s: int, entries: int) -> Work:
    """Scratch cut into its parts."""
    sn, pairs = s * n, (s - 1) // 2
    f = n + entries
    a = 2 * f
    b = a + 5 * sn
    d = b + n * n + pairs * 2 * n * n
    return Work(
        numbers[:f],
        numbers[f:a],
        numbers[a : a + sn],
        numbers[a + sn : a + 2 * sn],
        numbers[a + 2 * sn : a + 3 * sn],
        numbers[a + 3 * sn : a + 4 * sn],
        numbers[a + 4 * sn : b],
        numbers[b : b + n * n],
        pivots[:n],
        numbers[b + n * n : d],
        pivots[n : n + pairs * n],
        numbers[d : d + n],
        numbers[d + n : d + 2 * n],
        numbers[d + 2 * n : d + 3 * n],
        numbers[d + 3 * n : d + 4 * n],
        numbers[d + 4 * n : d + 5 * n],
    )


@inlined
def equations(
    rhs: int, jac: int, n: int, rows: int, columns: int, entries: int, c: int, constants: int
) -> Equations:
    """A field's addresses as arrays."""
    return Equations(rhs, jac, n, integers(rows, n + 1), integers(columns, entries), doubles(c, constants))
