"""The food chain of Hastings and Powell (1991, Ecology 72, 896): doubled orbits join the period doublings of
their parents in pairs, or run on to the end of the range.

Where they come back to their parent both are stable, on either side: a step that goes over to the parent, run
through twice, meets no test.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hybrid_runs import diagram

import contwalk as cw
from contwalk.diagram.reopening import reopened
from contwalk.problems.orbit import switching
from contwalk.problems.orbit.asymmetry import asymmetries
from contwalk.system import Mode, Parameter, State, System


def food_chain() -> System:
    def field(t, x, p, dx):
        eaten = 5.0 * x[0] / (1.0 + p.b1 * x[0])
        hunted = 0.1 * x[1] / (1.0 + 2.0 * x[1])
        dx[0] = x[0] * (1.0 - x[0]) - eaten * x[1]
        dx[1] = eaten * x[1] - hunted * x[2] - 0.4 * x[1]
        dx[2] = hunted * x[2] - 0.01 * x[2]

    return System(
        name="food_chain",
        states=(State("x"), State("y"), State("z")),
        parameters=(Parameter("b1", 2.0),),
        modes=(Mode("m", field),),
    )


@pytest.fixture(scope="module")
def branches():
    start = [0.7, 0.2, 9.8]
    given = {"b1": 2.25}
    return diagram(food_chain(), "b1", (2.2, 2.99), start, given, until="settled", follow=("PD",), depth=2)


@pytest.mark.long
def test_doubled_orbits_end_where_they_are_their_parents_again(branches):
    """Four of five period doublings are two pairs; from the last a branch runs to the range's end."""
    main, *daughters = branches
    doublings = [point.parameters["b1"] for point in main.special_points if point.label == "PD"]
    assert len(doublings) == 5
    met = {
        doublings[0]: doublings[1],
        doublings[1]: doublings[0],
        doublings[2]: doublings[3],
        doublings[3]: doublings[2],
    }
    own = [branch for branch in daughters if branch.info.parent[0] == main.info.name]
    assert len(own) == 3  # each of the two bands is walked once
    for branch in own:
        born = branch["b1"][0]
        paired = next((end for begin, end in met.items() if abs(begin - born) < 1e-6), None)
        if paired is None:
            assert born == pytest.approx(doublings[4], abs=1e-6)
            assert branch.outcome.reason == "bound"
            continue
        assert branch.outcome.reason == "rejoined", branch.outcome.message
        assert branch["b1"][-1] == pytest.approx(paired, abs=1e-6)


@pytest.mark.long
def test_no_doubled_orbit_is_its_parent_before_it_ends(branches):
    """Half a closure later each is somewhere else, by more than errors."""
    for branch in branches[1:]:
        away = np.minimum(branch["s"] - branch["s"][0], branch["s"][-1] - branch["s"])
        moved = np.flatnonzero(away > 1e-2)
        for row in moved[:: max(len(moved) // 12, 1)]:
            problem, sample = reopened(food_chain(), branch, int(row))
            assert asymmetries(problem, sample.z)["itself"] > 1e-4, (branch.info.name, branch["b1"][row])


@pytest.mark.slow
@pytest.mark.parametrize("top", [6.0, 6.5])
def test_a_fold_that_is_the_parents_is_where_the_branch_ends(top):
    """Where the branch is its parent's again the parameter turns, and a step that ended right beyond, known
    to less than its length, told a fold there and crept on.
    """
    problem = cw.Equilibrium(food_chain(), {"b1": 2.0}, "b1")
    equilibria = cw.continue_branch(problem, [0.8, 0.12, 10.0], (1.5, top))
    cycles = cw.switch_branch(problem, equilibria, "HB1", (1.5, top))
    doubled = cw.switch_branch(problem, cycles, "PD1", (1.5, top))
    assert doubled.outcome.reason == "rejoined", doubled.outcome.message
    end, met = doubled.special_points[-1], cycles.special_points[1]
    assert (end.label, met.label) == ("EP", "PD")
    assert end.parameters["b1"] == pytest.approx(met.parameters["b1"], abs=end.error + met.error)
    assert [point.label for point in doubled.special_points] == ["PD", "PD", "BP", "EP"]


@pytest.mark.parametrize("segments", [1, 2, 3])
def test_the_doubled_orbit_leaves_along_a_null_vector_whatever_its_segments(branches, segments):
    """Each closure's period deviates; the doubled orbit's segments start at times of its own."""
    main = branches[0]
    point = next(point for point in main.special_points if point.label == "PD")
    problem, _ = reopened(food_chain(), main, int(np.argmin(np.abs(main["s"] - point.s))))
    problem.discretization = replace(problem.discretization, segments=segments)
    (seed,) = switching.doubled(problem, np.array(point.unknowns))
    jacobian, there = seed.problem.linearize(seed.z).jacobian, seed.problem
    assert there.mesh.segments == segments
    missed = np.abs(jacobian @ seed.tangent) / (np.abs(jacobian) @ np.abs(seed.tangent)).max()
    assert missed.max() < 1e-5


@pytest.mark.parametrize(
    ("own", "grown", "asked", "counted"),
    [(1, 1, None, 2), (4, 1, None, 8), (4, 1, 3, 2), (1, 2, None, 4), (1, 3, None, 6)],
)
def test_a_doubled_orbit_has_no_fewer_segments_than_its_parent(monkeypatch, own, grown, asked, counted):
    """Over both closures deviations may grow no more than over one, where they are forgotten in between.

    A parent that has fewer than its growth over one closure asks for is not followed in that.
    """
    monkeypatch.setattr(switching, "segments_for", lambda problem, z, times=1: {1: grown, 2: 2}[times])
    parent = SimpleNamespace(
        mesh=SimpleNamespace(segments=own), discretization=SimpleNamespace(segments=asked)
    )
    assert switching.segments_over(parent, np.zeros(5), 2) == counted
