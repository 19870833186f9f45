"""Whether a curve in two parameters is born at a point where one of its kind has been born before.

A point that lies on two curves is come to from both, and what is born there begins a little beside it: nearer
to it or farther away, each time, so that neither beginning need lie on what is known of the other.
"""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.branch import Branch
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.one_place import is_one
from contwalk.diagram.opening import Opening
from contwalk.labels import LOCUS
from contwalk.problems.stored_alike import of_the_same
from contwalk.special_point import nearest_to

# Of two families that are born at one point, as at a double Hopf point, periods differ by more than this.
ONE_PERIOD = 1e-2


def born_there(start: Start, opening: Opening, branches: Sequence[Branch]) -> Branch | None:
    """The branch that a start's would be: of the same, born at the same point, and to one side of it only."""
    problem, sample = opening.problem, opening.state.sample
    if problem.kind != LOCUS or problem.meshed is None or not opening.one_sided or start.parent is None:
        return None
    own = nearest_to(start.above[-1] if start.above else (), start.parent[1])
    settings = problem.branch_facts()["settings"]
    for branch in branches:
        info = branch.info
        if own is None or info.problem != LOCUS or info.parent is None or len(branch) < 2:
            continue
        if info.free != problem.line.names or not of_the_same(info.settings, settings):
            continue
        s, periods = branch.points["s"], branch.points["period"]
        begins = float(s[0]) * float(s[-1]) == 0.0
        period = float(periods[0] if s[0] == 0.0 else periods[-1])
        begins = begins and abs(period / sample.period - 1.0) < ONE_PERIOD
        parent = next((b for b in branches if b.name == info.parent[0]), None)
        point = None if parent is None else nearest_to(parent.special_points, info.parent[1])
        weights = dict(zip(info.free, sample.weights[-1:-3:-1].tolist(), strict=True))
        if begins and point is not None and is_one(own, point, weights):
            return branch
    return None
