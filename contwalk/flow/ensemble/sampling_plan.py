"""Places in the array of integers and addresses by which `sampling_kernel` is told what to do."""

from __future__ import annotations

# Addresses of machine code.
STEP, ERROR, EXTEND, EVALUATE, RHS, GUARD = range(6)
# Sizes: states; vectors' length; stages in memory, constants of the field, parameters; targets of a sample.
N, LENGTH, STAGES, CONSTANTS, PARAMETERS, TARGETS = range(6, 12)
# What is looked for: direction (1 rising, -1 falling), whether the first crossing ends it; most steps.
DIRECTION, FIRST_ONLY, MOST_STEPS = range(12, 15)
# Addresses of memory: of the method, of the interpolation (7 n), a spare state and its velocity; what a guard
# gives (3); the field's address and that of its constants.
WORK, DENSE, SPARE, SPEED, MEASURED, PROBLEM = range(15, 21)
# Addresses of data: inverse weights; interpolant's coefficients; distances and periods of the stop rule.
INVERSE_WEIGHTS, COEFFICIENTS, WITHIN, PERIODS = range(21, 25)
# Addresses of what belongs to the samples: states, constants, parameters, targets, final times, results.
STARTS, FIELDS, VALUES, PLACES, LIMITS, RESULTS = range(25, 31)
PLAN_LENGTH = 31

# A sample's results: instant of the crossing, whether there was one, instant of its end, how it ended.
CROSSED_AT, CROSSED, ENDED_AT, ENDED = range(4)
RESULT_LENGTH = 4
SETTLED, TIME_UP, NOT_FINITE, GIVEN_UP, FOUND = range(5)
