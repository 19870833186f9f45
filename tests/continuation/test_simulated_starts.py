"""Simulations as starts: one that comes to rest starts the branch of equilibria."""

import numpy as np
import pytest
from small_systems import labelled, small_system

from contwalk.branch import Outcome
from contwalk.continuation.diagram import Diagram, Plan
from contwalk.continuation.opening_orbits import opened_orbit
from contwalk.continuation.settings import Settings
from contwalk.continuation.work import Start
from contwalk.problems.equilibrium import Equilibrium


def brusselator(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def node_at_zero(t, x, p, dx):
    dx[0] = (p.B - 2.0) * x[0] - x[0] ** 3 + p.A * x[1]
    dx[1] = -x[1]


CASES = [(brusselator, [1.3, 1.2], "HB", 2.0), (node_at_zero, [0.7, -0.4], "BP", 2.0)]


@pytest.mark.parametrize(("field", "start", "label", "expected"), CASES)
@pytest.mark.parametrize("until", ["settled", 30.0])
def test_a_simulation_that_comes_to_rest_starts_the_equilibria(field, start, label, expected, until):
    values = {"A": 1.0, "B": 1.5}
    system = small_system(field, "xy", values)
    settings = Settings(range=(1.0, 3.0))
    opening = opened_orbit(system, values, "B", np.array(start), settings, None, until=until)
    assert not isinstance(opening, Outcome), opening.message
    assert isinstance(opening.problem, Equilibrium)
    made = Diagram([Start(system, "B", values, opening, "start")], Plan(settings, frozenset(), 0))
    list(made.events())
    (branch,) = made.branches
    assert branch.info.problem == "equilibrium"
    assert "came to rest at an equilibrium" in branch.outcome.message
    assert (branch["B"].min(), branch["B"].max()) == (1.0, 3.0)
    (point,) = labelled(branch, label)
    assert point.parameters["B"] == pytest.approx(expected, rel=1e-13)
