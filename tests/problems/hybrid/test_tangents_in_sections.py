"""A tangent that is moved into the section of an orbit is the same change of the same orbit."""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.system import Transition

BEGIN = 0.5


def circle(t, x, p, dx):
    """A circle of radius sqrt(mu), gone round once in 2 pi seconds."""
    away = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = -x[1] + away * x[0]
    dx[1] = x[0] + away * x[1]


def on_it(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


LANDS = Transition("lands", "m", "m", lambda t, x, p: x[1], "falling")
SYSTEM = machine(["x", "y"], {"mu": 1.0}, {"m": circle}, [LANDS])


@pytest.mark.parametrize(("cuts", "met"), [(1, False), (3, False), (1, True)])
def test_what_it_adds_is_a_later_beginning_of_all_of_the_orbit(cuts: int, met: bool) -> None:
    """Of an orbit that is cut, and of one that is looked at from an instant between two events."""
    legs = (Leg("m", LANDS), Leg("m")) if met else (Leg("m"),)
    problem = HybridOrbit(SYSTEM, Itinerary(legs), {"mu": 1.0}, "mu").cut_into(cuts)
    lasting = np.array([np.pi - BEGIN, np.pi + BEGIN] if met else [2.0 * np.pi])
    starts, z = BEGIN + np.append(0.0, np.cumsum(lasting)), np.ones(problem.size + 1)
    for segment in problem.layout.segments:
        z[segment.states] = on_it(starts[segment.leg] + segment.begin * lasting[segment.leg])
    z[problem.layout.durations] = lasting
    problem = problem.adapted_to(z, np.ones(len(z)), 1e-12)
    assert problem.section is not None
    tangent = np.cos(np.arange(1.0, len(z) + 1.0))
    moved = problem.into_section(z, tangent)
    assert abs(problem.section.normal @ moved[problem.layout.states[0]]) < 1e-14
    left = problem.jacobian(z) @ (moved - tangent)
    assert np.abs(np.delete(left, problem.layout.phase)).max() < 1e-8
