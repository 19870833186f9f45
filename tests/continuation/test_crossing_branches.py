"""Branches that cross are told apart, however near to the point where they do."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.diagram.recognition import Known, known_branch
from contwalk.studies.opening import opened


def diagram(field, states, parameters, free, start, span, depth=5):
    system = small_system(field, states, parameters)
    settings = Settings(range=span)
    opening = opened(system, parameters, free, np.array(start), settings)
    made = Diagram([Start(system, free, parameters, opening, "start")], Plan(settings, depth=depth))
    notes = [event.text for event in made.events() if isinstance(event, Noted)]
    return made.branches, notes


def product(t, x, p, dx):
    dx[0] = p.lam * x[0] + 0.3 * x[1] - x[0] * x[1]
    dx[1] = 0.7 * x[0] - x[1]


def test_a_branch_that_crosses_at_a_small_angle_is_not_the_known_one():
    """x0 = (lam + 0.21) / 0.7 crosses x = 0 at lam = -0.21, where both are nearly parallel in the metric."""
    branches, notes = diagram(product, "xy", {"lam": 0.14}, "lam", [0.5, 0.35], (-1.0, 1.0))
    assert notes == []
    daughter, rest = branches
    assert [p.parameters["lam"] for p in labelled(daughter, "BP")] == [pytest.approx(-0.21, rel=1e-12)]
    assert np.all(rest.points["state"] == 0.0)
    assert (rest["lam"].min(), rest["lam"].max()) == (-1.0, 1.0)


def transcritical(seed):
    """Random fields with the solution x = 0 for every lam, and a start on another branch."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 4))
    linear = random.normal(size=(n, n))
    rates = np.diag(random.uniform(0.5, 1.5, n))
    square = random.normal(size=(n, n, n)) * (random.random((n, n, n)) < 0.5)
    square[0, 0, 0] = 1.0
    lam, x = float(random.uniform(-0.8, 0.8)), random.normal(size=n) * random.choice([0.1, 1.0])
    drift = (linear + lam * rates) @ x + np.einsum("ijk,j,k", square, x, x)
    linear[:, 0] -= drift / x[0]

    def field(t, s, p, dx):
        for i in range(n):
            total = 0.0
            for j in range(n):
                total = total + (linear[i, j] + p.lam * rates[i, j]) * s[j]
                for k in range(n):
                    total = total + square[i, j, k] * s[j] * s[k]
            dx[i] = total

    return field, n, lam, x, np.linalg.eigvals(-np.linalg.inv(rates) @ linear)


@pytest.mark.drawn(2)
@pytest.mark.parametrize("seed", range(12))
def test_where_a_daughter_meets_zero_the_zero_branch_is_found(seed):
    field, n, lam, x, critical = transcritical(seed)
    branches, _ = diagram(field, "xyz"[:n], {"lam": lam}, "lam", x, (-1.0, 1.0), depth=1)
    first = branches[0]
    met = [p for p in labelled(first, "BP") if max(map(abs, p.state.values())) < 1e-9]
    rest = [b for b in branches if np.all(b.points["state"] == 0.0)]
    assert len(rest) == (1 if met else 0)
    for branch in rest:
        assert (branch["lam"].min(), branch["lam"].max()) == (-1.0, 1.0)
        crossed = [p.parameters["lam"] for p in labelled(branch, "BP")]
        born = float(branch["lam"][np.flatnonzero(branch.points["s"] == 0.0)[0]])
        real = [v.real for v in critical if abs(v.imag) < 1e-12 and -1.0 < v.real < 1.0]
        # eigenvalues of a random 3 x 3 matrix are good to some thousand roundings
        assert sorted([*crossed, born]) == pytest.approx(sorted(real), abs=1e-11)


def pitchfork(t, x, p, dx):
    dx[0] = p.mu * x[0] - x[0] ** 3


def test_a_point_of_a_branch_is_known_and_one_beside_it_is_not():
    problem = small_problem(pitchfork, "x", {"mu": 0.5}, "mu")
    upper = cw.continue_branch(problem, [np.sqrt(0.5)], (0.1, 1.0))
    for start, expected in ((np.sqrt(0.5), Known("b1")), (-np.sqrt(0.5), None), (0.0, None)):
        here = next(iter(cw.points(problem, [start], (0.0, 1.0)))).state
        assert known_branch(problem, here.sample, [upper]) == expected


@pytest.mark.drawn(2)
@pytest.mark.parametrize("mu", [1e-6, 1e-4, 1e-2, 0.3])
def test_near_where_branches_cross_both_are_told_apart(mu):
    """Off the pitchfork by sqrt(mu), in states of size one: the corrector may reach either branch."""
    problem = small_problem(pitchfork, "x", {"mu": mu}, "mu")
    whole = small_problem(pitchfork, "x", {"mu": 0.5}, "mu")
    rest = cw.continue_branch(whole, [0.0], (-1.0, 1.0))
    upper = cw.continue_branch(whole, [np.sqrt(0.5)], (0.0, 1.0))
    for start, branch, other in ((0.0, rest, upper), (np.sqrt(mu), upper, rest)):
        here = next(iter(cw.points(problem, [start], (-1.0, 1.0)))).state
        assert known_branch(problem, here.sample, [branch]) == Known(branch.name)
        assert known_branch(problem, here.sample, [other]) is None
