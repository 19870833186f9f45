"""What branches, tables and figures call their own columns: names that no model may give."""

from __future__ import annotations

import re

# Of hybrid orbits: signed square of the smallest difference between two multipliers, zero where a pair turns
# real.
SPLIT = "split"

# `s`, `step` and `error` may be used: `branch["s"]` is then the state, and tables put its kind in front.
_OF_POINTS = "stable unstable admissible special special_point period spectrum spectrum_error trivial_error"
_OF_ROWS = "free state observables unknowns tangent weights residual iterations rhs seconds"
RESERVED = frozenset(f"{_OF_POINTS} {_OF_ROWS} max_re max_abs path {SPLIT}".split())
COLUMN_OF_SPECTRUM = re.compile(r"(re|im)_\d+")
