"""A machine whose mirror is not at zero: what leaves where its orbits lose their symmetry."""

from __future__ import annotations

import math

import numpy as np
from forced_mirrors import OMEGA, PAIR_R, breaking, half, period
from hybrid_runs import diagram, machine

from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.restoring import problem_of
from contwalk.system import Symmetry, System, Transition


def shifted_pair(middle: float) -> System:
    """The impact pair with its stops one to each side of `middle`."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.beta * math.cos(p.omega * t)

    def strike(t, x, p, after):
        after[0], after[1] = x[0], -p.r * x[1]

    def inversion(t, x, p, image):
        image[0], image[1] = 2.0 * middle - x[0], -x[1]

    return machine(
        ["x", "v"],
        {"beta": 12.0, "omega": OMEGA, "r": PAIR_R},
        {"free": field},
        [
            Transition("low", "free", "free", lambda t, x, p: 1.0 - middle + x[0], reset=strike),
            Transition("high", "free", "free", lambda t, x, p: 1.0 + middle - x[0], reset=strike),
        ],
        symmetries=(Symmetry("inversion", "spatial", inversion, events={"low": "high", "high": "low"}),),
        period=period,
    )


def test_a_branch_leaves_along_its_own_equations_wherever_the_mirror_is():
    """The image of a deviation is that of a difference: what the map adds to each state is none of it."""
    system, middle = shifted_pair(3.0), 3.0
    x, v = half(12.0, 1, rocks=False).at_zero
    (parent,) = diagram(system, "beta", (11.0, 22.0), [middle + x, v], {"beta": 12.0}, mode="free")
    (point,) = [p for p in parent.special_points if p.kind == "symmetry-breaking"]
    assert abs(point.parameters["beta"] - breaking(1, False, 12.0, 22.0)) < 1e-6
    problem = problem_of(system, parent.info, np.array(list(point.state.values())), None)
    (seed,) = discretized(problem, np.array(point.unknowns)).unfolded_from(np.array(point.unknowns))
    jacobian, along = seed.problem.linearize(seed.z).jacobian, seed.tangent
    missed = np.abs(jacobian @ along) / (np.abs(jacobian) @ np.abs(along)).max()
    assert missed.max() < 1e-6
