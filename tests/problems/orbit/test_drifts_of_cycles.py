"""Cycles from Hopf points of equilibria with a neutral direction that nobody declared: it is pinned, and a
drift along it is no part of an orbit."""

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening import opened


def cycles(third):
    """The branch from the Hopf point at lam = 1 of the cycle x^2 + y^2 = lam - 1, beside z' = third(x)."""

    def field(t, x, p, dx):
        g = p.lam - 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = g * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + g * x[1]
        dx[2] = third(x)

    system = small_system(field, "xyz", {"lam": 0.5})
    settings = Settings(range=(0.5, 1.5))
    opening = opened(system, {"lam": 0.5}, "lam", np.zeros(3), settings)
    start = Start(system, "lam", {"lam": 0.5}, opening, "start")
    diagram = Diagram([start], Plan(settings, frozenset({"HB"}), 1))
    list(diagram.events())
    equilibria, born = diagram.branches
    assert equilibria.info.settings["pins"] == ["undeclared"]
    return born


def test_a_state_that_grows_with_every_round_has_no_cycles():
    """z' = x^2 is zero at the equilibria only: with z held, a drift of -(lam - 1) / 2 stood in for it."""
    born = cycles(lambda x: x[0] ** 2)
    assert (born.outcome.status, born.outcome.reason) == ("failed", "no_convergence")
    assert "undeclared neutral direction" in born.outcome.message
    assert np.all(born["lam"] == 1.0)


@pytest.mark.parametrize("third", [lambda x: 0.3 * x[0], lambda x: x[0] * x[1]])
def test_a_state_that_comes_back_moves_with_its_cycle(third):
    born = cycles(third)
    assert born.outcome.reason == "bound"
    last = born.points[-1]
    assert last["period"] == pytest.approx(np.pi, rel=1e-6)
    assert born["max:x"][-1] == pytest.approx(np.sqrt(0.5), rel=1e-6)
    # The one multiplier that is neither the flow's nor the pinned direction's: of r' = (lam - 1 - r^2) r.
    assert last["spectrum"][0].real == pytest.approx(np.exp(-np.pi), rel=1e-4)


def test_the_direction_is_known_to_the_branch_and_need_not_be_to_the_problem_that_is_given():
    """Its equations without the pin were singular at the Hopf point: a bare LinAlgError."""

    def field(t, x, p, dx):
        g = p.lam - 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = g * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + g * x[1]
        dx[2] = 0.3 * x[0]

    problem = cw.Equilibrium(small_system(field, "xyz", {"lam": 0.5}), {"lam": 0.5}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0, 0.0], range=(0.5, 1.2))
    assert problem.pins == ()
    born = cw.switch_branch(problem, branch, "HB1", range=(0.5, 1.2))
    assert born.outcome.reason == "bound"
    assert born["max:x"][-1] == pytest.approx(np.sqrt(0.2), rel=1e-6)
