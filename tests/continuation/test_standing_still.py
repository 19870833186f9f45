"""Points used up while the parameter stands still: the outcome says what goes on changing."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.branch import Outcome
from contwalk.continuation import outcomes
from contwalk.diagram.standing_still import POINTS, with_what_stands_still

ROW = np.dtype([("s", "f8"), ("free", "f8", (1,)), ("period", "f8"), ("state", "f8", (2,))])


def rows(values, periods, states, sign=1.0):
    found = np.zeros(len(values), dtype=ROW)
    found["s"] = sign * np.arange(len(values))
    found["free"][:, 0], found["period"], found["state"][:, 0] = values, periods, states
    return [found[k : k + 1] for k in range(len(found))]


COUNT = POINTS + 10
STANDING = 0.998740451246 + 1e-11 * np.arange(COUNT)
MOVING = 0.99 + 1e-4 * np.arange(COUNT)
GROWING, SAME = np.geomspace(10.0, 12.0, COUNT), np.full(COUNT, 10.0)
NO_PERIOD = np.full(COUNT, np.nan)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("values", "periods", "states", "told"),
    [
        (STANDING, GROWING, SAME, "while the period goes from 10."),
        (STANDING, SAME, GROWING, "while the states go on changing"),
        (STANDING, NO_PERIOD, GROWING, "while the states go on changing"),
        (MOVING, GROWING, GROWING, None),
        (STANDING, SAME, SAME, None),
        (STANDING[:20], GROWING[:20], SAME[:20], None),  # too few to tell
    ],
)
def test_what_goes_on_changing_is_told(values, periods, states, told, sign):
    plain = outcomes.max_points(COUNT)
    other = rows(MOVING[:20], GROWING[:20], SAME[:20], -sign)
    found = with_what_stands_still(plain, [*rows(values, periods, states, sign), *other[1:]], sign, "a")
    assert (found.status, found.reason) == (plain.status, plain.reason)
    if told is None:
        assert found == plain
        return
    assert found.message.startswith(plain.message)
    assert (
        f"Over the last {POINTS} points a stands still at 0.9987404518, to within 5e-10, {told}"
        in found.message
    )
    assert ("canard" in found.message) == np.isfinite(periods).all()  # equilibria have none


def test_other_ends_are_left_alone():
    ended = Outcome("complete", "bound", "Reached the end of the range.")
    assert with_what_stands_still(ended, rows(STANDING, GROWING, SAME), 1.0, "a") is ended


PLUGIN = """\
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = (x[1] - x[0]**3 / 3.0 + x[0]) / 0.01
    dx[1] = p.a - x[0]

SYSTEM = System("van_der_pol", states=(State("x"), State("y")), parameters=(Parameter("a", 0.9987),),
    modes=(Mode("only", field),))
"""
RUN = """\
contwalk: 1
system: ./plugin.py
start: {simulate: {state: {x: 1.5, y: 0.0}, until: settled}}
continue: {parameter: a, range: [0.9987, 1.2], max_points: 100}
diagram: none
output: out.h5
"""


@pytest.mark.long
def test_the_canard_of_van_der_pol_is_told_by_a_branch_that_goes_on_in_it(tmp_path):
    (tmp_path / "plugin.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    for points in (100, 110):
        given = [f"continue.max_points={points}"]
        study = cw.read_run_file(tmp_path / "run.yaml", given, output=tmp_path / "out.h5")
        branch = cw.run(study, figures=False, resume=points > 100).branches[0]
        assert branch.outcome.reason == "max_points"
        assert "points a stands still at 0.99874" in branch.outcome.message
        assert "while the period goes from " in branch.outcome.message
