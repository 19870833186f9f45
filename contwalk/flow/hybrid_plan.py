"""What the compiled walk through arcs is told: arrays of integers and addresses, and what it answers."""

from __future__ import annotations

# The walk: addresses of the modes and of the transitions, records one after the other; of the times of an arc's
# steps, and how many there is room for; of `STATE`, what it begins with and ends with; of what has happened.
MODES, TRANSITIONS, TIMES, ROOM, STATE, HAPPENED = range(6)
# Columns of derivatives, and their padded number; the most events; scratch for one row of them.
COLUMNS, WIDTH, EVENTS, ROW = range(6, 10)
WALK_LENGTH = 10

# What it begins with, and leaves: time, then from `FIRST_STATE` on the states of the mode.
CLOCK, FIRST_STATE = range(2)

# A mode: two plans of explicit methods: one that moves, with derivatives if these are wanted, and one to try.
MOVING, TRIAL = range(2)
# Its guards that act: their number; addresses of their addresses, directions, and transitions' numbers.
GUARDS, ADDRESSES, DIRECTIONS, LEADS = range(2, 6)
# Address of the parameters; scratch: what a guard gives; values and rates of the guards and how fast they
# have been; the interpolant; a state; samples of a guard on a step.
PARAMETERS, MEASURED, STANDING, DENSE, SPARE, SAMPLES = range(6, 12)
# The interpolant's coefficients, and the number of stages in memory.
COEFFICIENTS, STAGES = range(12, 14)
MODE_LENGTH = 14

# A transition: its map with the Jacobian, constants, rows and columns of the entries, and scratch for what it
# gives and takes; number of states before and after; number of the mode it leads into; its own guard's position
# there, -1 if that is not armed; scratch for the field before and after it, and for its derivative.
JUMP, CONSTANTS, ROWS, ENTRIES, GIVEN, TAKEN, BEFORE, AFTER, TARGET, OWN, SPEEDS, SLOPES = range(12)
TRANSITION_LENGTH = 12

# For each guard: value, rate, and the largest rate of late.
OF_GUARD = 3

# How it ended. `UNSURE`: something that the careful way has to look at, such as transitions at once.
ARRIVED, NOT_FINITE, STEP_TOO_SMALL, FULL, UNSURE, TIME_UP = range(6)

# What happened in each arc: the transition's number, the steps.
OF_EVENT = 2
