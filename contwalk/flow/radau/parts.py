"""What one step of Radau IIA collocation works with: a field, a tableau and scratch, as arrays.

Imported only where it is compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, integers, record
from contwalk.flow.radau.radau_call import RadauCall

EPSILON = 2.0**-52

radau_call = record(RadauCall)


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


class TangentWork(NamedTuple):
    """The tangents of a path, flat (n, q), what drives them, and scratch for the steps that carry them."""

    tangents: np.ndarray
    q: int
    sources: np.ndarray
    matrix: np.ndarray  # of all stages (s n, s n)
    row_weights: np.ndarray
    jacobian: np.ndarray  # f at a stage and the entries of its Jacobian
    moved: np.ndarray  # (s, n, q)
    pivots: np.ndarray


@inlined
def method(call: RadauCall) -> Method:
    """The parts of the packed tableau."""
    tableau, s = doubles(call.tableau, call.numbers), call.s
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
def work(call: RadauCall) -> Work:
    """Scratch cut into its parts."""
    numbers, pivots = doubles(call.scratch, call.size), integers(call.pivots, call.pivot_size)
    n, s, entries = call.n, call.s, call.entries
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
def tangent_work(call: RadauCall) -> TangentWork:
    """The tangents, and the further scratch that they need, which stands behind that of a path."""
    sn, q, f = call.s * call.n, call.q, call.n + call.entries
    a = call.size - (sn * sn + sn + f + sn * q)
    room = doubles(call.scratch + 8 * a, call.size - a)
    b = sn * sn + sn
    return TangentWork(
        doubles(call.tangents, call.n * q),
        q,
        integers(call.sources, q),
        room[: sn * sn],
        room[sn * sn : b],
        room[b : b + f],
        room[b + f :],
        integers(call.pivots + 8 * (call.pivot_size - sn), sn),
    )


@inlined
def equations(call: RadauCall) -> Equations:
    """A field's addresses as arrays."""
    rows, columns = integers(call.rows, call.n + 1), integers(call.columns, call.entries)
    return Equations(call.rhs, call.jac, call.n, rows, columns, doubles(call.c, call.constants))
