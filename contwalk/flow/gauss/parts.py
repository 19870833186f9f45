"""What one step of collocation works with: a field, a degree's numbers and scratch, as arrays.

Imported only where it is compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, integers, record
from contwalk.flow.gauss.gauss_call import GaussCall, GaussControl
from contwalk.flow.radau.parts import Equations

EPSILON = 2.0**-52

gauss_call, gauss_control = record(GaussCall), record(GaussControl)


class Points(NamedTuple):
    """The numbers of one degree; `tableaus.gauss` says what they are."""

    s: int
    nodes: np.ndarray
    inverse: np.ndarray
    end: np.ndarray


class Work(NamedTuple):
    """Scratch of a step; what has s in its shape is as long as the finer degree asks for."""

    jacobian: np.ndarray  # f at a point and the entries of its Jacobian
    z: np.ndarray  # increments (s, n)
    matrix: np.ndarray  # of all points (s n, s n), or its factors
    correction: np.ndarray  # (s, n)
    row_weights: np.ndarray  # (s n,)
    base: np.ndarray  # units of rounding of the increments, without what they are (n,)
    state: np.ndarray  # (n,)
    moved: np.ndarray  # (s, n, q)
    tangents: np.ndarray  # (n, q)
    first: np.ndarray  # (n,): an end, while another is computed
    pivots: np.ndarray


@inlined
def points(address: int, s: int) -> Points:
    """The parts of the packed numbers of a degree."""
    numbers = doubles(address, s * (s + 2))
    return Points(s, numbers[:s], numbers[s : s + s * s], numbers[s + s * s :])


@inlined
def equations(call: GaussCall) -> Equations:
    """A field's addresses as arrays."""
    rows, columns = integers(call.rows, call.n + 1), integers(call.columns, call.entries)
    return Equations(call.rhs, call.jac, call.n, rows, columns, doubles(call.c, call.constants))


@inlined
def work(call: GaussCall) -> Work:
    """Scratch cut into its parts; `gauss_collocation._room` says how much there is."""
    n, q, sn = call.n, call.q, max(call.s, call.finer) * call.n
    f = n + call.entries
    room = doubles(call.scratch, f + sn * (sn + 3 + q) + n * (3 + q))
    a = f + sn
    b = a + sn * sn
    d = b + 2 * sn
    e = d + 3 * n
    return Work(
        room[:f],
        room[f:a],
        room[a:b],
        room[b : b + sn],
        room[b + sn : d],
        room[d : d + n],
        room[d + n : d + 2 * n],
        room[e : e + sn * q],
        room[e + sn * q :],
        room[d + 2 * n : e],
        integers(call.pivots, sn),
    )
