"""What `sampling_kernel` is told, and what it answers."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record

SETTLED, TIME_UP, NOT_FINITE, GIVEN_UP, FOUND = range(5)


@call_record
class SamplingCall(CallRecord):
    """One thread's call."""

    # Addresses of machine code.
    step: int
    error: int
    extend: int
    evaluate: int
    rhs: int
    guard: int
    # Sizes: states; vectors' length; stages in memory; constants of the field; parameters; targets of a
    # sample.
    n: int
    length: int
    stages: int
    constants: int
    parameters: int
    targets: int
    # What is looked for: direction (1 rising, -1 falling); whether the first crossing ends it; most steps.
    direction: int
    first_only: int
    most_steps: int
    # Addresses of memory: of the method, of the interpolation (7 n), a spare state and its velocity; what a
    # guard gives (3); the field's address and that of its constants.
    work: int
    dense: int
    spare: int
    speed: int
    measured: int
    problem: int
    # Addresses of data: inverse weights; interpolant's coefficients; distances and periods of the stop rule.
    inverse_weights: int
    coefficients: int
    within: int
    periods: int
    # Addresses of what belongs to the samples: states, constants, parameters, targets, final times, results
    # (`SampleResult`).
    starts: int
    fields: int
    values: int
    places: int
    limits: int
    results: int


@call_record
class SampleResult(CallRecord):
    """What became of a sample."""

    crossed_at: float
    crossed: float  # 1 if there was a crossing
    ended_at: float
    ended: float  # `SETTLED`, ...
