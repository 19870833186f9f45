"""What the drivers of explicit methods are told: an array of integers and addresses, and what they answer."""

from __future__ import annotations

# Positions in the plan. Addresses of functions: those of `stages`.
STEP, ERROR, EXTEND, EVALUATE, PROBLEM = range(5)
# Number of states; length of a vector; address of the vectors, their number, and which is the last stage.
N, LENGTH, WORK, VECTORS, LAST_STAGE = range(5, 10)
# Addresses of the times and the nodes, how many steps they have room for, whether every node is kept.
TIMES, NODES, ROOM, EVERY = range(10, 14)
# Addresses of the inverse weights and of the errors of the steps; both can be 0.
INVERSE_WEIGHTS, ERRORS = range(14, 16)
# For error control: the most steps, addresses of what is remembered between calls and of the counts.
MOST_STEPS, MEMORY, COUNTS = range(16, 19)
# For interpolation: addresses of the positions of nodes, and of the results.
WHICH, OUT = range(19, 21)
# Of several paths: addresses of their first vectors, and of the states at all times.
STARTS, STATES = range(21, 23)
# For error control: whether a path goes on where roundings of its state are larger than the tolerance.
FAR_OUT = 23
PLAN_LENGTH = 24

MEMORY_LENGTH = 4
STEPS, REJECTED, EVALUATIONS, STIFF = range(4)
COUNTS_LENGTH = 4

DONE, NOT_FINITE, TOO_MANY_STEPS, STEP_TOO_SMALL, FULL = range(5)
STATUS = ("ok", "not_finite", "too_many_steps", "step_too_small")
