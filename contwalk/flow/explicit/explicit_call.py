"""What the drivers of explicit methods are told, and what they answer."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record

DONE, NOT_FINITE, TOO_MANY_STEPS, STEP_TOO_SMALL, FULL = range(5)
# Coefficients of a step's polynomial before those that `dense` tells of.
FIRST_ROWS = 3


@call_record
class ExplicitCall(CallRecord):
    """One call of a driver; m is the length of a vector."""

    # Addresses of the functions of `stages`, and of what they are told of the field.
    step: int
    error: int
    extend: int
    evaluate: int
    problem: int
    # Number of states; length of a vector; address of the vectors, their number, which is the last stage.
    n: int
    length: int
    work: int
    vectors: int
    last_stage: int
    # Addresses of the times and the nodes; how many steps they have room for; whether every node is kept.
    times: int
    nodes: int
    room: int
    every: int
    # Addresses of the inverse weights (m) and of the errors of the steps; both can be 0.
    inverse_weights: int
    errors: int
    # For error control: the most steps; addresses of a `StepControl` and of a `Counts`; whether a path goes
    # on where roundings of its state are larger than the tolerance.
    most_steps: int
    control: int
    counts: int
    far_out: int
    # For interpolation: addresses of the positions of nodes, of the results, and of what each stage
    # contributes to the further coefficients; how many these are.
    which: int
    out: int
    dense: int
    rows: int
    # Of several paths: addresses of their first vectors, and of the states at all times.
    starts: int
    states: int


@call_record
class BatchedCall(CallRecord):
    """One call of `march_batched`: two calls of the same steps, of the states and of a block of tangents."""

    # Addresses of an `ExplicitCall` of the states alone, which also tells times and paths, and of one of the
    # tangents of a block.
    states: int
    tangents: int
    # Address of the function of a batch of Jacobians; how many rows a batch of stages and one of Jacobians
    # have, and how many steps are recorded before Jacobians are evaluated.
    jacobians: int
    rows: int
    entries: int
    chunk: int
    # Number of blocks; addresses of their tangents, path by path, and of what drives them, a block of
    # `driving` doubles each.
    blocks: int
    carried: int
    sources: int
    driving: int


@call_record
class PolynomialCall(CallRecord):
    """The interpolating polynomials of a path of n states, asked at some times."""

    # Addresses of the times (steps + 1), the nodes and the polynomials' coefficients (rows for each), and of
    # the number of each step's polynomial.
    times: int
    nodes: int
    coefficients: int
    which: int
    steps: int
    n: int
    rows: int
    # Address of the times that are asked for, and their number; of the states there.
    wanted: int
    count: int
    out: int


@call_record
class StepControl(CallRecord):
    """What error control remembers between steps."""

    time: float
    length: float  # of the next step; 0 before the first one
    error: float  # of the last step, in units of the tolerance
    undefined: float  # 1 where the last attempt came to what is not finite


@call_record
class Counts(CallRecord):
    """Work done."""

    steps: int
    rejected: int
    evaluations: int
    stiff: int  # steps as long as stability allows
