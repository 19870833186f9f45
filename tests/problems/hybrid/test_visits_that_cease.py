"""A slip that ceases: its guard is zero at both ends, to what equations are solved to."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from hybrid_runs import machine, solution

from contwalk.problems.hybrid import locating_limits
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.discretization import SOLVED
from contwalk.system import Transition


def block():
    """A block on a shaken table, which slips where the force is beyond friction: a cos t > 1."""

    def sticks(t, x, p, dx):
        dx[0] = 0.0 * x[0]

    def slips(t, x, p, dx):
        dx[0] = p.a * math.cos(t) - 1.0

    return machine(
        ["v"],
        {"a": 1.0},
        {"stick": sticks, "slip": slips},
        [
            Transition(
                "goes", "stick", "slip", lambda t, x, p: p.a * math.cos(t) - 1.0, "rising", level=True
            ),
            Transition("stops", "slip", "stick", lambda t, x, p: x[0], "falling"),
        ],
        period=lambda p: 2.0 * math.pi,
    )


@pytest.mark.parametrize(("left", "ceases"), [(0.0, True), (0.5, True), (1e7, False)])
def test_a_guard_is_zero_to_what_the_equations_are_solved_to(left, ceases):
    """The slip begins with the speed that the stop before it has left, in units of what is no residual."""
    problem, z = solution(block(), "a", [0.0], {"a": 1.0 + 1e-6}, mode="stick", until="settled")
    (slip,) = [i for i, leg in enumerate(problem.itinerary.legs) if leg.mode == "slip"]
    z, weights = z.copy(), filled_magnitudes(problem, z)
    speeds = slice(0, problem.layout.durations.start)  # at the starts of both legs
    weights[speeds] = 1.0
    z[speeds] += left * SOLVED * problem.mesh.tolerance
    near = SimpleNamespace(z=z, weights=weights)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locating_limits, "_solution", lambda problem, sample: sample.z)  # which stops there
        assert locating_limits._vanishes(problem, slip, near) == ceases
