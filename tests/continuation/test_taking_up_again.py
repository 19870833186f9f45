"""A walk that was killed is taken up again: each direction where it was, or ended as it had."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.diagram.branch_in_progress import BranchInProgress, Stored, resumed

FORWARD, BACKWARD = 1.0, -1.0


def line(t, x, p, dx):
    dx[0] = p.lam - x[0]


def walked(value):
    """The branch x = lambda over (-0.3, 0.7) from a value, as it was appended: first all that is ahead."""
    problem = small_problem(line, "x", {"lam": value}, "lam")
    branch = cw.continue_branch(problem, [value], (-0.3, 0.7))
    rows, ends = branch.points, sorted(branch.special_points, key=lambda p: -p.parameters["lam"])
    ahead, behind = rows[rows["s"] >= 0.0], rows[rows["s"] < 0.0][::-1]
    assert [p.label for p in ends] == ["EP", "EP"]
    return problem, BranchInProgress(branch.info), ahead, behind, ends


def taken_up(problem, work, rows, ends, without=frozenset()):
    stored = Stored(rows, ends, None)
    places, kept = resumed(problem, work, stored, (FORWARD, BACKWARD), {}, without)
    return places, kept, [sign for sign, outcome in work.outcomes if outcome.reason == "bound"]


def test_a_walk_that_ended_where_it_began_goes_on_the_other_way():
    """The start is at the range's upper end: one row is there, and the end of the first direction."""
    problem, work, ahead, _, ends = walked(0.7)
    assert len(ahead) == 1
    places, kept, ended = taken_up(problem, work, ahead, ends[:1])
    assert (list(places), kept, ended) == ([BACKWARD], (0,), [FORWARD])
    assert places[BACKWARD][1].sample.parameter == 0.7


@pytest.mark.parametrize(("gone", "sign", "place"), [(0, FORWARD, 0.7), (1, BACKWARD, -0.3)])
def test_an_end_that_holds_no_longer_is_gone_on_from(gone, sign, place):
    """Of two ends one is left out, as of a range that is wider now on that side: the other one stays."""
    problem, work, ahead, behind, ends = walked(0.2)
    rows = np.concatenate([ahead, behind])
    places, kept, ended = taken_up(problem, work, rows, ends, frozenset({gone}))
    assert (list(places), kept, ended) == ([sign], (1 - gone,), [-sign])
    assert places[sign][1].sample.parameter == place
