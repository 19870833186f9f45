"""What the kernels of collocation at Gauss points are told, and what they answer."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record


@call_record
class GaussCall(CallRecord):
    """One call of a kernel; fields that it has no use for stay zero."""

    # The field of n states: its address, alone and with the Jacobian; addresses of the rows and columns of
    # the Jacobian's entries, and their number; address of the constants, and their number.
    rhs: int
    jac: int
    n: int
    rows: int
    columns: int
    entries: int
    c: int
    constants: int
    # The packed numbers of a degree s, and of the one that tells its errors, of degree `finer`.
    numbers: int
    s: int
    finer_numbers: int
    finer: int
    # Scratch of doubles and of integers.
    scratch: int
    pivots: int
    # The times of all paths, one after the other, and how many there are; how many paths, where the last time
    # of each stands (m,), and their starts (m, n).
    times: int
    count: int
    paths: int
    lasts: int
    starts: int
    # States at all times (count, n).
    states: int
    # Tangents: derivatives of each path's start (n, q), their number, what drives each; their values at the
    # ends of paths (m, n, q), and, unless the address is 0, at all times (count, n, q).
    tangents: int
    q: int
    sources: int
    ends: int
    nodes: int
    # For error control: the end, the tolerance, weights (n,), the most steps; the address of a
    # `GaussControl`.
    t1: float
    tolerance: float
    weights: int
    most: int
    control: int


@call_record
class GaussControl(CallRecord):
    """What error control remembers between calls, and counts."""

    proposed: float  # length of the next step
    end: float  # of the last step
    steps: int
    rejected: int
    evaluations: int
