"""What the kernels of Radau IIA methods are told, and what they answer."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record


@call_record
class RadauCall(CallRecord):
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
    # The packed tableau, its length, and the number of stages.
    tableau: int
    numbers: int
    s: int
    # Scratch of doubles and of integers, and their lengths.
    scratch: int
    size: int
    pivots: int
    pivot_size: int
    # The grid, and its steps, or how many steps there is room for; the start, which is overwritten.
    times: int
    steps: int
    x: int
    # What is written unless its address is 0: states (steps + 1, n), errors (steps, 2), increments
    # (steps, s, n), nodes of the tangents (steps + 1, n, q).
    states: int
    errors: int
    increments: int
    nodes: int
    weights: int
    # Tangents: their start (n, q), which is overwritten, their number, and what drives each.
    tangents: int
    q: int
    sources: int
    # For error control: the end, the tolerance, the bound of the embedded estimate that belongs to it; the
    # most steps; addresses of a `RadauControl` and of a `RadauCounts`.
    t1: float
    tolerance: float
    allowed: float
    most: int
    control: int
    counts: int


@call_record
class RadauControl(CallRecord):
    """What error control remembers between steps."""

    proposed: float  # length of the next step
    length: float  # of the last step, 0 before the first one
    last_length: float  # that length and its error as the controller remembers them
    last_error: float
    end: float  # of the last step


@call_record
class RadauCounts(CallRecord):
    """Work done."""

    steps: int
    rejected: int
    evaluations: int
    jacobians: int
