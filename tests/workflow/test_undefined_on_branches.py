"""Fields, guards and resets that cease to have a value along a branch of orbits through events."""

from __future__ import annotations

import numpy as np
import pytest
from hostile_machines import STOPS

import contwalk as cw

RUN = """\
contwalk: 1
system: ./stops.py
start: {simulate: {state: {x: 0.1, y: 0.3}, until: settled}}
continue: {parameter: r, range: [0.9, 1.6]}
diagram: none
output: out.h5
"""
LEFT = 'Transition("hit_left", "only", "only", left, reset=rebound),'


def third(guard: str, given: str) -> tuple[str, str]:
    """A third transition, which no leg ends with."""
    return LEFT, f"{LEFT}\n        Transition('third', 'only', 'only', lambda t, x, p: {guard}, {given}),"


def branch_of(folder, old, new):
    """The one branch of a machine with a text replaced, and the line of the root in it."""
    assert old in STOPS
    source = STOPS.replace(old, new, 1)
    (folder / "stops.py").write_text(source)
    (folder / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "out.h5"), figures=False)
    return result.branches[0], 1 + source[: source.index("sqrt")].count("\n")


@pytest.mark.drawn(3)
@pytest.mark.parametrize(
    ("change", "what", "last"),
    [
        (third("math.sqrt(1.1 - p.r) + 3.0 - x[0]", "role='watched'"), "guard of transition 'third'", 1.1),
        (third("math.sqrt(1.1 - p.r) + 3.0 - x[0]", "reset=rebound"), "guard of transition 'third'", 1.1),
        (
            third("math.sqrt(1.1 - p.r) + 3.0 - x[0]", "'both', role='watched'"),
            "guard of transition 'third'",
            1.1,
        ),
        # Without a value at some states only, which no orbit before comes to.
        (third("math.sqrt(1.45 - x[1]) + 3.0 - x[0]", "role='watched'"), "guard of transition 'third'", None),
        (("return 1.0 - x[0]", "return 1.0 - x[0] + 1e-3 * math.sqrt(1.1 - p.r)"), "hit_right", 1.1),
        (("-0.6 * x[1]", "-(0.6 + 1e-3 * math.sqrt(1.1 - p.r)) * x[1]"), "reset of transition", 1.1),
        (("0.2 * x[1]", "(0.2 + 1e-3 * math.sqrt(1.1 - p.r)) * x[1]"), "field of mode 'only'", 1.1),
    ],
)
def test_the_line_without_a_value_is_told_where_the_branch_ends(tmp_path, change, what, last):
    branch, line = branch_of(tmp_path, *change)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
    assert what in branch.outcome.message
    assert f"stops.py, line {line}: sqrt of -" in branch.outcome.message
    largest = branch["r"].max()
    assert last is None or 0.0 <= last - largest < 1e-6
    if "third" in what:  # nothing else is singular there: points do not pile up
        assert np.sum(branch["r"] > largest - 1e-6) < 12


def test_a_guard_with_a_value_everywhere_ends_nothing(tmp_path):
    branch, _ = branch_of(tmp_path, *third("math.sqrt(1.7 - p.r) + 3.0 - x[0]", "role='watched'"))
    assert branch.outcome.reason == "grazing"
