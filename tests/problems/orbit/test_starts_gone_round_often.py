"""Smooth orbits begun with a multiple of their period: the least closure is told, whatever the accuracy.

Lorenz's equations at rho = 325, whose stable orbit is its own mirror image half a period later; with a place
to the side, which the mirror reverses, and a height. Nothing depends on either.
"""

from __future__ import annotations

import numpy as np
import pytest
from lorenz_mirrors import field, mirror, travelling, travelling_mirror
from small_systems import small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Neutral, Symmetry

# A state of the orbit, and half its period.
STATE, HALF = [42.54492117, 94.88394548, 343.8106542, 7.0, -2.0], 0.2016847692


def aside(t, x, p, v):
    v[0] = v[1] = v[2] = v[4] = 0.0
    v[3] = 1.0


def up(t, x, p, v):
    v[0] = v[1] = v[2] = v[3] = 0.0
    v[4] = 1.0


PLAIN = small_system(field, "xyz", {"rho": 325.0}, symmetries=(Symmetry("mirror", "spatial", mirror),))
TRAVELLING = small_system(
    travelling,
    "xyzsh",
    {"rho": 325.0},
    symmetries=(Symmetry("mirror", "spatial", travelling_mirror),),
    neutral=(Neutral("aside", aside), Neutral("up", up)),
)


@pytest.mark.parametrize("system", [PLAIN, TRAVELLING], ids=["plain", "travelling"])
@pytest.mark.parametrize("accuracy", [1e-7, 1e-9])
@pytest.mark.parametrize("rounds", [1, 2, 13])
def test_the_least_closure_is_told(system: cw.System, accuracy: float, rounds: int) -> None:
    opening = opened_orbit(
        system,
        system.defaults(),
        "rho",
        np.array(STATE[: len(system.states)]),
        Settings(),
        discretization=cw.Discretization(accuracy=accuracy),
        period=2.0 * rounds * HALF,
    )
    assert isinstance(opening, Opening)
    problem = opening.problem
    assert isinstance(problem, PeriodicOrbit)
    assert problem.whole == ("mirror", 2)
    assert problem.duration(opening.state.sample.z) == pytest.approx(HALF, rel=1e-6)


def test_places_along_a_direction_that_turns_are_one() -> None:
    """A turn by one radian about the origin, of a state beside one that does not exist, and nothing else."""

    def turn(t, x, p, v):
        v[0], v[1], v[2] = -x[1], x[0], 1.0

    system = small_system(lambda t, x, p, dx: None, "xyz", {"mu": 0.5}, neutral=(Neutral("turn", turn),))
    given = [np.array([np.cos(1.0), np.sin(1.0), 0.0]), np.array([1.0, 0.0, 0.0]), {"mu": 0.5}, np.ones(3)]
    apart = neutrals.apart_at_least(system, system.neutral, *given, (0, 1))
    np.testing.assert_allclose(apart, 0.0, atol=1e-7)
    whole = neutrals.apart_at_least(system, system.neutral, *given, (0, 1, 2))
    assert np.linalg.norm(whole) > 0.5
