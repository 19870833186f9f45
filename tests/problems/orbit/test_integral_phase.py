"""The integral phase condition, from a Hopf point on."""

import numpy as np
from small_systems import small_problem

import contwalk as cw


def brusselator(t, x, p, dx):
    dx[0] = 1.0 - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def test_a_cycle_is_followed_from_its_birth():
    """A cycle that is a point still has no velocities to compare its phase with."""
    found = {}
    for phase in ("section", "integral"):
        system = small_problem(brusselator, "XY", {"B": 1.5}, "B").system
        problem = cw.Equilibrium(
            system, system.defaults(), "B", discretization=cw.Discretization(phase=phase)
        )
        equilibria = cw.continue_branch(problem, [1.0, 1.5], (1.0, 3.0))
        found[phase] = cw.switch_branch(problem, equilibria, "HB1", (1.0, 3.0))
        assert found[phase].outcome.reason == "bound"
        assert found[phase]["B"].max() == 3.0
    periods = [float(branch["period"][np.argmax(branch["B"])]) for branch in found.values()]
    # Both are solved for on steps of 1e-6, which some hundred of add up to.
    assert abs(periods[0] - periods[1]) < 1e-5 * periods[0]
