"""What the compiled event integrator is told, and what it answers."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record

# How it ended. `UNSURE`: there is something that only the reference integrator can tell, such as transitions
# at once. `AWAY`: at a transition to a mode that it does not know, before its reset.
ARRIVED, NOT_FINITE, STEP_TOO_SMALL, FULL, UNSURE, TIME_UP, AWAY = range(7)

PARTS = 8  # of a step that is sampled: a guard has at most one extremum in each
MOST_BITS = 62  # of guards that are marked by a bit each; further ones share the last


@call_record
class EventCall(CallRecord):
    """One call of the integrator."""

    # Addresses of arrays of `ModeRecord` and `TransitionRecord`; of the time; of a `Happened`, and of the
    # numbers of the transitions that have happened.
    modes: int
    transitions: int
    clock: int
    happened: int
    itinerary: int
    # Addresses of the times of a segment's steps, and of marks on those in which watched guards may pass
    # zero, a bit for each guard; how many steps there is room for; how many events there are to be.
    times: int
    marks: int
    room: int
    events: int
    # Columns of derivatives, and these padded; scratch for the states of a mode; address of the derivatives
    # of the last event's instant.
    columns: int
    width: int
    column: int
    shift: int


@call_record
class Happened(CallRecord):
    """Where a motion stands."""

    mode: int
    own: int  # a bit for each guard that what has just happened leaves at zero
    passed: int  # one for each of these that it has passed in its own direction
    first_of_all: int  # the transition that happens before all else, -1 if none
    goes_on: int  # whether a segment goes on for which there was no room
    count: int  # of events
    steps: int
    own_steps: int  # those of the last segment


@call_record
class ModeRecord(CallRecord):
    """A mode."""

    # Addresses of two `ExplicitCall`: one that moves, with derivatives if these are wanted, one to try.
    moving: int
    trial: int
    size: int  # number of states
    # Its guards: their number; addresses of their addresses, of those of their slopes, of directions, of the
    # transitions' numbers, which are -1 for those that are only watched; which of them act at entry.
    guards: int
    addresses: int
    sloping: int
    directions: int
    leads: int
    levels: int
    # Address of the parameters; scratch: what a guard gives; a `GuardOnStep` for each; uncertainties of the
    # states; the interpolant; a state; a velocity; samples of a guard on a step.
    parameters: int
    measured: int
    standing: int
    noise: int
    dense: int
    spare: int
    speed: int
    samples: int
    # The interpolant's coefficients, and the number of stages in memory; states and velocities between the
    # ends of a step, for all guards, and whether they are those of this step; `Instant` of the start.
    coefficients: int
    stages: int
    between: int
    drawn: int
    instant: int
    paced: int  # whether events that may accumulate are left to the reference integrator


@call_record
class TransitionRecord(CallRecord):
    """A transition."""

    # Its map with the Jacobian, constants, rows and columns of the entries; scratch for what it takes and
    # gives; number of states it leads to; number of the mode, -1 if it is none of the integrator's.
    jump: int
    constants: int
    rows: int
    entries: int
    taken: int
    given: int
    outputs: int
    target: int
    # Scratch for speeds before and after, for derivatives; a bit for each guard of that mode that is zero
    # right after it, and for each of these that has been passed.
    speeds: int
    slopes: int
    leaves: int
    passes: int


@call_record
class GuardOnStep(CallRecord):
    """How a guard stands at the start of a step, and at its end."""

    value: float
    rate: float
    begins: float  # its sign right after if it begins at zero
    fastest: float  # the largest rate of late
    value_at_end: float
    rate_at_end: float
    # As long as it has not left what it begins with of rounding: how far that reaches, when it is left.
    band: float
    left_at: float
