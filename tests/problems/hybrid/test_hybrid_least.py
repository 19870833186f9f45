"""Orbits that were looked at for longer than the least part of them that tells all."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM
from forced_mirrors import block, half, spring_between_stops
from hybrid_runs import assert_met, diagram, machine, solution
from one_impact import OneImpact, forced, parameters, stiffness
from scipy.linalg import expm

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.least_part import least, own_image
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.system import State, Symmetry, Transition

OMEGA, ZETA = 2.6, 0.1


def rocking(declared: bool = True) -> tuple[HybridOrbit, np.ndarray]:
    own = half(2.8, 3, rocks=True)
    mode = "right" if own.at_zero[0] > 0.0 else "left"
    return solution(block(declared=declared), "beta", list(own.at_zero), {"beta": 2.8}, mode=mode)


def images(problem: HybridOrbit, z: np.ndarray, count: int) -> np.ndarray:
    """Unknowns of an odd orbit's first half, followed by its images."""
    states, lasting = z[: problem.layout.durations.start], z[problem.layout.durations]
    signs = [(-1.0) ** k for k in range(count)]
    rest = z[problem.layout.durations.stop :]
    return np.concatenate([*[sign * states for sign in signs], *[lasting] * count, rest])


@pytest.mark.drawn(1)
@pytest.mark.parametrize("times", [2, 5])
def test_a_quiet_orbit_of_several_periods_is_one_of_a_single_period(times: int) -> None:
    p = parameters(OMEGA, ZETA)
    p.force = 0.5 * stiffness(p)
    problem, z = solution(SYSTEM, "force", forced(p, 0.0), vars(p))
    longer, often = problem.of_itinerary(problem.itinerary, times), z.copy()
    often[problem.layout.durations] *= times
    there = discretized(longer, often)
    part, start = least(there, often)
    assert part.subharmonic == problem.subharmonic == 1
    np.testing.assert_allclose(start, z, rtol=1e-15)
    found = part.multipliers(start, part.jacobian(start)).values
    # Of a linear machine they are those of free motion; walked to a hundred times the accuracy of 1e-9.
    expected = np.exp(np.roots([1.0, 2.0 * ZETA, 1.0]) * 2.0 * math.pi / OMEGA)
    np.testing.assert_allclose(np.poly(found), np.poly(expected), atol=1e-7)


def test_a_whole_orbit_that_is_its_own_image_is_halved() -> None:
    problem, z = rocking()
    whole = problem.of_itinerary(problem.itinerary.unfolded(problem.system))
    there = discretized(whole, images(problem, z, 2))
    assert own_image(there, images(problem, z, 2)) == "inversion"
    assert there.returned_to_parent(images(problem, z, 2), np.eye(there.size + 1)[1])
    part, start = least(there, images(problem, z, 2))
    assert (part.itinerary, part.subharmonic, part.forcings) == (problem.itinerary, 3, 1.5)
    np.testing.assert_array_equal(start, z)


def test_an_orbit_that_nearly_is_its_own_image_is_whole() -> None:
    problem, z = rocking()
    near = images(problem, z, 2)
    near[1] += 1e-5 * abs(near[1])
    there = discretized(problem.of_itinerary(problem.itinerary.unfolded(problem.system)), near)
    assert least(there, near) == (there, near)


def test_an_orbit_is_not_halved_by_a_symmetry_that_nobody_declared() -> None:
    problem, z = rocking(declared=False)
    assert problem.whole == ("full", 1)
    assert least(problem, z)[0] is problem


@pytest.mark.long
def test_half_an_orbit_that_goes_round_three_times_is_divided() -> None:
    problem, z = rocking()
    first = problem.itinerary.legs
    second = problem.itinerary.unfolded(problem.system).legs[1:]
    often = problem.of_itinerary(Itinerary(first + second + first, problem.itinerary.image), 3)
    there = discretized(often, images(problem, z, 3))
    part, start = least(there, images(problem, z, 3))
    assert (part.itinerary, part.subharmonic) == (problem.itinerary, problem.subharmonic)
    np.testing.assert_array_equal(start, z)


@pytest.mark.long
def test_what_follows_the_last_impact_of_two_periods_has_a_single_one() -> None:
    """An impact every other period ceases where the linear motion touches the stop: that has one period."""
    p = parameters(OMEGA, ZETA)
    motion = OneImpact(p, 2)
    p.force = 1.7  # above the fold at 1.535; the stop is touched without impacts from 5.78 on
    v = motion.velocity(mpmath.mpf(p.force), True)
    w = motion.wave(v)
    phase = math.atan2(2.0 * ZETA * OMEGA, 1.0 - OMEGA**2)
    impact = (math.atan2(-float(w[1]) / OMEGA, float(w[0])) + phase) / OMEGA
    x = motion.at(v, motion.duration - impact % (2.0 * math.pi / OMEGA))
    impacts, quiet = diagram(
        SYSTEM,
        "force",
        (1.0, 6.0),
        [float(x[0]), float(x[1])],
        vars(p),
        follow=("GR",),
        events={"GR": "switch"},
        max_step=0.3,
    )
    assert (impacts.info.signature, impacts.info.subharmonic) == (("impact",), 2)
    assert (quiet.info.signature, quiet.info.subharmonic) == ((), 1)
    # It is the machine's below the grazing, down to the end of the range.
    assert quiet.outcome.reason == "bound"
    assert np.all(quiet["admissible"])
    modulus = math.exp(-ZETA * 2.0 * math.pi / OMEGA)
    np.testing.assert_allclose(np.abs(quiet.points["spectrum"]), modulus, rtol=1e-7)


def test_what_a_simulation_finds_beyond_a_limit_is_closed_up_to_its_symmetry() -> None:
    """The linear motion touches both stops at once; from there on both are hit in turn."""
    response = 0.7 / (1.0 - 1.3**2 + 0.2j * 1.3)
    quiet, impacts = diagram(
        spring_between_stops(),
        "beta",
        (0.5, 0.9),
        [response.real, (1.3j * response).real],
        {"omega": 1.3, "beta": 0.7},
        follow=("GR",),
        events={"GR": "switch"},
        direction="up",
        max_step=0.3,
    )
    assert quiet.info.signature == ()
    assert (impacts.info.closure, len(impacts.info.signature)) == ("inversion", 1)


def test_a_doubled_orbit_that_is_its_own_image_is_closed_up_to_it() -> None:
    """A spring that is kicked by its own displacement at each tick of a clock: at rest until it swings.

    One round of the motion at rest is u+ = u - k x after x'' = -4 x - 0.1 x' for the time one; where -1 is
    its multiplier the spring begins to swing to one side in each round, the image of the round before.
    """

    def field(t, x, p, dx):
        dx[0], dx[1], dx[2] = 1.0, x[2], -4.0 * x[1] - 0.1 * x[2] - x[1] ** 3

    def tick(t, x, p, after):
        after[0], after[1], after[2] = 0.0, x[1], x[2] - p.k * x[1]

    def mirror(t, x, p, image):
        image[0], image[1], image[2] = x[0], -x[1], -x[2]

    system = machine(
        [State("clock"), State("x", scale=1.0), State("u", scale=1.0)],
        {"k": 2.0},
        {"on": field},
        [Transition("tick", "on", "on", lambda t, x, p: 1.0 - x[0], reset=tick)],
        symmetries=(Symmetry("mirror", "spatial", mirror),),
    )
    rest, swings = diagram(system, "k", (1.5, 3.5), [0.0, 0.0, 0.0], follow=("PD",), max_step=0.2)
    (doubling,) = [p for p in rest.special_points if p.label == "PD"]
    flow = expm(np.array([[0.0, 1.0], [-4.0, -0.1]]))
    # 1 + trace + determinant = 0, and the kick takes k flow_01 from the trace.
    exact = (1.0 + np.trace(flow) + np.linalg.det(flow)) / flow[0, 1]
    assert_met(doubling, "k", float(exact))
    assert swings.info.closure == "mirror"
    assert len(swings.info.signature) == 1
    assert swings.outcome.reason != "rejoined"
    assert np.ptp(swings["k"]) > 0.1
