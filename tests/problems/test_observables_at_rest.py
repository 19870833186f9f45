"""What an observable of a motion is told at an equilibrium: one instant, at time zero."""

from __future__ import annotations

import numpy as np
from small_systems import small_system

from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.system import Observable


def test_the_time_is_zero():
    def field(t, x, p, dx):
        dx[0] = p.lam - x[0]

    late = Observable("late", lambda t, x, p: x[:, 0].max() + 100.0 * t[0])
    system = small_system(field, "x", {"lam": 2.0}, observables=(late,))
    problem = Equilibrium(system, {"lam": 2.0}, "lam")
    z = np.array([2.0, 2.0])
    sample = problem.examine(z, np.array([1.0, 1.0]), np.ones(2), problem.linearize(z), None)
    assert sample.observables[problem.observable_names.index("late")] == 2.0
    value, gradient = problem.kernels.of_function(late.function, along=True)
    assert value(*problem.inputs(z)).tolist() == [2.0]
    assert gradient(*problem.inputs(z)).ravel().tolist() == [1.0, 0.0]
