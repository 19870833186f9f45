"""An unstable cycle that comes to stick meets the stable orbit that does: a fold of cycles with a corner.

r' = r (r^2 - a) / 10 has an unstable cycle r^2 = a around the origin. It touches v = -1 at a = 1, where a
motion would stick until v' = x + v (r^2 - a) / 10 is positive again. The orbits that stick exist for a < 1 as
well: a motion outside the cycle spirals outwards until it sticks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hybrid_runs import assert_met, machine

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening import opened
from contwalk.system import Transition

GROWS = 0.1


def spiral():
    def rate(x, p):
        return x[0] + GROWS * x[1] * (x[0] ** 2 + x[1] ** 2 - p.a)

    def slips(t, x, p, dx):
        dx[0] = -x[1] + GROWS * x[0] * (x[0] ** 2 + x[1] ** 2 - p.a)
        dx[1] = rate(x, p)

    def sticks(t, x, p, dx):
        slips(t, x, p, dx)
        dx[1] = 0.0

    return machine(
        ["x", "v"],
        {"a": 0.8},
        {"slip": slips, "stick": sticks},
        [
            Transition("stops", "slip", "stick", lambda t, x, p: x[1] + 1.0, "falling"),
            Transition("goes", "stick", "slip", lambda t, x, p: rate(x, p), "rising"),
        ],
    )


def test_the_orbit_that_sticks_is_followed_from_the_point_at_which_the_other_one_touches():
    settings = Settings(
        range=(-0.01, 1.05),
        max_points=200,
        max_step=0.5,
        events={"GR": "switch", "OC": "ignore", "AZ": "ignore"},
    )
    system = spiral()
    opening = opened(system, {"a": -0.01}, "a", np.zeros(2), settings)
    plan = Plan(settings, frozenset({"HB"}), 3, (1.0,))
    found = Diagram([Start(system, "a", {"a": -0.01}, opening, "the start")], plan)
    for _ in found.events():
        pass
    _, cycle, sticking = found.branches
    assert cycle.outcome.reason == "grazing"
    (grazing,) = [point for point in cycle.special_points if point.name == "GR1"]
    assert_met(grazing, "a", 1.0, 1e-8)
    assert sticking.info.signature == ("stops", "goes")
    assert min(sticking["a"]) < 0.8
    assert max(sticking["a"]) == pytest.approx(1.0, abs=1e-6)
    assert not any(sticking["unstable"])  # at the point itself too, where it is one of the other
    # It begins at the very orbit that touches.
    assert_met(replace(grazing, parameters={"a": float(max(sticking["a"]))}), "a", 1.0, 1e-8)
    assert all(cycle["unstable"][1:])  # it is born as the equilibrium
