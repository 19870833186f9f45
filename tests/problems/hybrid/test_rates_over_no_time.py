"""A leg that lasts no time tells no rate of the guard that ends it: its value and sign would be rounding."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from hybrid_runs import ACCURACY, diagram, machine, solution

from contwalk.problems.hybrid import locating_limits
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.system import Transition


def thrower():
    """Thrown up with speed lam, a ball rises for so long, is caught, and waits until x has decayed."""

    def rise(t, x, p, dx):
        dx[0] = 0.0 * x[0]
        dx[1] = -1.0

    def wait(t, x, p, dx):
        dx[0] = -x[0]
        dx[1] = 0.0 * x[1]

    def throw(t, x, p, after):
        after[0] = 1.0 + 0.1 * x[1]
        after[1] = p.lam

    transitions = [
        Transition("apex", "rising", "waiting", lambda t, x, p: x[1]),
        Transition("throw", "waiting", "rising", lambda t, x, p: x[0] - 0.5, reset=throw),
    ]
    return machine(["x", "v"], {"lam": 0.5}, {"rising": rise, "waiting": wait}, transitions)


def test_an_orbit_whose_leg_lasts_no_time_is_told_without_its_rate():
    (branch,) = diagram(
        thrower(), "lam", (-0.5, 1.0), [1.0, 0.5], {}, mode="rising", until="settled",
        events={"GR": "stop", "OC": "stop"},
    )  # fmt: skip
    (change,) = [point for point in branch.special_points if point.label == "OC"]
    assert change.parameters["lam"] == pytest.approx(0.0, abs=ACCURACY)  # the range's width is 1.5
    assert change.admissible
    assert "apex_rate" not in change.margin
    # as on all other orbits, of which the ball falls by 1 a second
    others = [point for point in branch.special_points if point.label == "EP" and point.kind == "bound"]
    assert [end.margin["apex_rate"] for end in others] == pytest.approx([1.0], rel=1e-9)  # rounding of a leg


@pytest.mark.parametrize("lasting", [1e-6, 0.0])
def test_a_guard_that_passes_zero_where_its_leg_lasts_no_time_is_not_taken_for_one_that_turns(lasting):
    """Over the leg's own time its rate is zero as well, and a curve of such events ended at its start."""
    problem, z = solution(thrower(), "lam", [1.0, 0.5], {"lam": 1e-6}, mode="rising", until="settled")
    (rise,) = [i for i, leg in enumerate(problem.itinerary.legs) if leg.mode == "rising"]
    z = z.copy()
    z[problem.layout.durations.start + rise] = lasting
    z[problem.layout.states[rise]] = 1.0, 0.0  # thrown with no speed at all
    near = SimpleNamespace(z=z, weights=filled_magnitudes(problem, z))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locating_limits, "_solution", lambda problem, sample: sample.z)
        assert not locating_limits._vanishes(problem, rise, near)
