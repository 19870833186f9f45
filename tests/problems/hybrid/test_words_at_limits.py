"""The words on the other side of a limit: which events are left, and how long their legs last.

A hand goes round in 10, and passes four marks that change nothing: every number is known.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hybrid_runs import machine, solution

from contwalk.problems.hybrid.adjacent import at_limit, corner, orbit
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.system import Transition

MARKS = {"a": 1.0, "b": 3.0, "c": 4.5, "d": 8.0}


def run(t, x, p, dx):
    dx[0] = 1.0
    dx[1] = p.level - x[1]


def unchanged(t, x, p, after):
    after[0], after[1] = x[0], x[1]


def again(t, x, p, after):
    after[0], after[1] = x[0] - 10.0, x[1]


def at(phase):
    return lambda t, x, p: phase - x[0]


@cache
def going_round() -> tuple[HybridOrbit, np.ndarray]:
    marks = [Transition(name, "run", "run", at(phase), reset=unchanged) for name, phase in MARKS.items()]
    end = Transition("end", "run", "run", at(10.0), reset=again)
    system = machine(["theta", "y"], {"level": 2.0}, {"run": run}, [*marks, end])
    problem, z = solution(system, "level", [0.0, 2.0], until="settled")
    return discretized(problem, z), z


def limits_of(test: str):
    problem, z = going_round()
    return problem, z, [limit for limit in problem.margins(z).limits if limit.test == test]


@pytest.mark.parametrize("name", MARKS)
def test_without_an_event_its_two_legs_are_one(name):
    problem, z, found = limits_of("rate")
    (limit,) = [each for each in found if each.name == name]
    neighbour = at_limit.built_at(problem, z, limit, 1.0)
    there, unknowns = neighbour.problem, neighbour.z
    begins = {"end": 0.0} | {each: phase for each, phase in MARKS.items() if each != name}
    after, names = list(begins.values()), list(begins)
    lasting = dict(zip([*names[1:], "end"], np.diff([*after, 10.0]), strict=True))
    word = [leg.name for leg in there.itinerary.legs]
    assert sorted(word) == sorted(begins)
    # The orbit is located to 1e-9, relative; a neighbour's unknowns are sums of its.
    assert unknowns[there.layout.durations] == pytest.approx([lasting[each] for each in word], abs=1e-8)
    starts = [unknowns[own][0] for own in there.layout.states]
    assert starts == pytest.approx([begins[each] for each in [word[-1], *word[:-1]]], abs=1e-8)


def test_a_branch_has_no_corner_where_there_is_no_other_order():
    """A mark and its neighbour cannot be passed in the other order: they are at different places."""
    problem, z, found = limits_of("duration")
    assert len(found) == 5
    along = np.zeros(len(z))
    along[-1] = 1.0
    for limit in found:
        with pytest.raises(orbit.NoAdjacentOrbit, match="no orbit in that order is near"):
            at_limit.built_at(problem, z, limit, 0.0)
        assert not corner.has_corner(problem, z, limit, along)
