"""What `guard_taylor_kernel` is told of a mode and an instant, and what it answers."""

from __future__ import annotations

from contwalk.flow.compiled.call_record import CallRecord, call_record

# How a guard stands; see `guard_status`.
CLEAR, LEAVING, ENTERING, BEYOND, RESTING, UNDEFINED = range(6)


@call_record
class Instant(CallRecord):
    """An instant of a mode of n states."""

    # Addresses of the field with its Jacobian, and of what rounding and time do to it; of its constants, and
    # of the parameters; of the rows and the columns of the Jacobian's entries.
    rhs_jac: int
    variation: int
    constants: int
    parameters: int
    rows: int
    columns: int
    # Number of states; whether what follows from the instant alone has been computed.
    size: int
    known: int
    # Addresses of what is given: states and their velocity, uncertainties of time and states (1 + n),
    # magnitudes of the states.
    state: int
    velocity: int
    noise: int
    weights: int
    # Scratch: what the field and its variation give; uncertainty of the velocity, acceleration, uncertainty
    # of this; what a guard's slopes give. Address of a `GuardTaylorCoefficients`.
    found: int
    varied: int
    motion: int
    sloped: int
    answer: int


@call_record
class GuardTaylorCoefficients(CallRecord):
    """A guard's value with its uncertainty, its first two derivatives by time, its sign right after."""

    value: float
    value_noise: float
    rate: float
    bend: float
    side: float
