"""What the compiled walk through arcs is told: arrays of integers and addresses, and what it answers."""

from __future__ import annotations

# The walk: addresses of the records of modes and transitions; of the time; of what happens; of the times of
# an arc's steps, of marks on those in which watched guards may pass zero, a bit for each guard, and how many
# steps there is room for; how many events there are to be; columns of derivatives, and these padded; scratch
# for the states of a mode; address of the derivatives of the last event's instant.
MODES, TRANSITIONS, CLOCK, HAPPENED, TIMES, MARKS, ROOM, EVENTS = range(8)
COLUMNS, WIDTH, COLUMN, SHIFT = range(8, 12)
WALK_LENGTH = 12

# What happens, as integers: the mode's number; a bit for each guard that what has just happened leaves at
# zero; one for each of these that it has passed in its own direction; the transition that happens before all
# else, -1 if none; whether an arc goes on for which there was no room; how many events there were; steps, and
# those of the last arc; from `WORD` on the transitions' numbers.
MODE, OWN, PASSED, FIRST_OF_ALL, GOES_ON, COUNT, STEPS, OWN_STEPS, WORD = range(9)

# A mode: two plans of explicit methods, one that moves, with derivatives if these are wanted, and one to try;
# number of states.
MOVING, TRIAL, SIZE = range(3)
# Its guards: their number; addresses of their addresses, of those of their slopes, of directions, of the
# transitions' numbers, which are -1 for those that are only watched; which of them act at entry.
GUARDS, ADDRESSES, SLOPING, DIRECTIONS, LEADS, LEVELS = range(3, 9)
# Address of the parameters; scratch: what a guard gives; how the guards stand; uncertainties of the states;
# the interpolant; a state; a velocity; samples of a guard on a step.
PARAMETERS, MEASURED, STANDING, NOISE, DENSE, SPARE, SPEED, SAMPLES = range(9, 17)
# The interpolant's coefficients, and the number of stages in memory; states and velocities between the ends
# of a step, for all guards, and whether they are those of this step; plan of the instant of the start.
COEFFICIENTS, STAGES, BETWEEN, DRAWN, COURSE = range(17, 22)
MODE_LENGTH = 22

# A transition: its map with the Jacobian, constants, rows and columns of the entries; scratch for what it
# takes and gives; number of states it leads to; number of the mode, -1 if it is none of the walk's; scratch
# for speeds before and after, for derivatives; a bit for each guard of that mode that is zero right after it,
# and for each of these that has been passed.
JUMP, CONSTANTS, ROWS, ENTRIES, TAKEN, GIVEN, OUTPUTS, TARGET, SPEEDS, SLOPES, LEAVES, PASSES = range(12)
TRANSITION_LENGTH = 12

PARTS = 8  # of a step that is sampled: a guard has at most one extremum in each

# How a guard stands: value, rate, its sign right after if it begins at zero, the largest rate of late; value
# and rate at the end of the step; as long as it has not left what it begins with of rounding, how far that
# reaches, and when in the step it is left.
VALUE, RATE, BEGINS, FASTEST, VALUE_AT_END, RATE_AT_END, BAND, LEFT_AT = range(8)
OF_GUARD = 8

# How it ended. `UNSURE`: there is something that only the careful way can tell, such as transitions at once.
# `AWAY`: at a transition to a mode that the walk does not know, before its reset.
ARRIVED, NOT_FINITE, STEP_TOO_SMALL, FULL, UNSURE, TIME_UP, AWAY = range(7)

MOST_BITS = 62  # of guards that are marked by a bit each; further ones share the last
