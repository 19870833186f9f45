"""Orbits are known again where the parameter stands still while they grow: along a canard explosion."""

import numpy as np
from small_systems import small_system

import contwalk as cw
from contwalk.diagram.recognition import known_branch
from contwalk.problems.problem import at_stored

RANGE = (0.97, 1.01)


def van_der_pol(t, x, p, dx):
    dx[0] = (x[1] - x[0] ** 3 / 3.0 + x[0]) / p.eps
    dx[1] = p.a - x[0]


def test_a_canard_is_known_by_its_period():
    system = small_system(van_der_pol, ("x", "y"), {"a": 1.02, "eps": 0.06})
    problem = cw.Equilibrium(system, system.defaults(), "a")
    rest = cw.continue_branch(problem, [1.02, 1.02**3 / 3.0 - 1.02], (0.9, 1.05))
    # Two walks up the explosion, whose points lie between each other's.
    known = cw.switch_branch(problem, rest, "HB1", RANGE, max_points=120)
    other = cw.switch_branch(problem, rest, "HB1", RANGE, max_points=120, step=0.003, max_step=0.05)
    orbits = cw.PeriodicOrbit(system, system.defaults(), "a")
    standing = np.abs(np.gradient(other["a"]) / np.gradient(other["period"]))
    for k in np.argsort(standing)[:6]:
        assert standing[k] < 1e-8
        z = other.unknowns(k)
        weights, tangent = (other.points[name][k][: len(z)] for name in ("weights", "tangent"))
        there = at_stored(orbits, z, weights)
        sample = there.examine(z, tangent, weights, there.linearize(z), None)
        found = known_branch(there, sample, [known])
        assert found is not None
        assert found.branch == known.name
