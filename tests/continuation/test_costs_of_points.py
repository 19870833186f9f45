"""What a point has cost: its own evaluations, and not those before it."""

from __future__ import annotations

from itertools import islice

from made_up import LINE, MadeUp, line

from contwalk.continuation.marks import Observer
from contwalk.continuation.pseudo_arclength import Point, walk
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState


class Counting(MadeUp):
    """Tells how often it was evaluated, and has been already."""

    size = 1

    @property
    def evaluations(self) -> int:
        return 1000 + self.evaluated

    @evaluations.setter
    def evaluations(self, value: int) -> None: ...


def test_the_evaluations_of_the_points_are_those_of_the_walk():
    straight = line(lambda z: [-1.0])
    problem = Counting(straight.f, straight.df, straight.eigenvalues)
    here = ContinuationState(problem.sample((0.0, 0.0), (0.0, 1.0)), 0.0, 0.1)
    before = problem.evaluated
    found = walk(problem, here, Settings(range=(-1.0, 1.0), step=0.1), Observer(LINE, ()), 1.0, 100)
    costs = [item.state.sample.evaluations for item in islice(found, 5) if isinstance(item, Point)]
    assert len(costs) == 5
    assert sum(costs) == problem.evaluated - before
