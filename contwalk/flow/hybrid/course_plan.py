"""What `course_kernel` is told of a mode and an instant: an array of integers and addresses."""

from __future__ import annotations

# Addresses of the field with its Jacobian, and of what rounding and time do to it; of its constants, and of
# the parameters; of the rows and the columns of the Jacobian's entries.
RHS_JAC, VARIATION, CONSTANTS, PARAMETERS, ROWS, COLUMNS = range(6)
# Number of states; whether what follows from the instant alone has been computed.
SIZE, KNOWN = range(6, 8)
# Addresses of what is given of the instant: states and their velocity, uncertainties of time and states,
# magnitudes of the states.
STATE, VELOCITY, NOISE, WEIGHTS = range(8, 12)
# Scratch: what the field and its variation give; uncertainty of the velocity, acceleration, uncertainty of
# this; what a guard's slopes give. Address of the answer.
FOUND, VARIED, MOTION, SLOPED, ANSWER = range(12, 17)
PLAN_LENGTH = 17

# The answer: a guard's value with its uncertainty, its rate, its second derivative, its sign right after.
VALUE, VALUE_NOISE, RATE, BEND, SIDE = range(5)
ANSWER_LENGTH = 5

# How a guard stands; see `departure`.
CLEAR, LEAVING, ENTERING, BEYOND, RESTING, UNDEFINED = range(6)
