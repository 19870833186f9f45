"""Branches along which deviations grow to a millionfold a round and more: the orbit is cut while they do."""

from __future__ import annotations

import numpy as np
import pytest
from peers.problems import plant_in_a_current
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.continuation import outcomes
from contwalk.diagram.reopening import reopened
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.layout import LEAST_CHOSEN, times_chosen
from contwalk.problems.orbit.transport import MOST_GROWTH, growth, segments_of_growth
from contwalk.studies import opening_smooth

# A point is a solution if its residual is at most so many times its own error (docs/theory.md).
SOLVED = 20.0


def segments(branch: Branch) -> list[int]:
    """Into how many segments the orbit of each row is cut; times of cuts that are chosen are unknowns too."""
    n, found = len(branch.info.states), []
    for z in map(branch.unknowns, range(len(branch))):
        times = times_chosen(z, n, 2)  # beside the states the period and the parameter
        found.append((len(z) - 2) // n if times is None else len(times))
    return found


# Into how many segments the orbits below are cut at last: halves of halves are enough.
SCHEMES = pytest.mark.parametrize(("scheme", "most"), [("shooting", 4), ("auto", 4)])


def beside_a_circle(t, x, p, dx):
    """The unit circle, gone round in 2 pi, drives a third state that runs off: as exp(2 pi a) in a round."""
    growth = 1.0 - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = growth * x[1] + x[0]
    dx[2] = p.a * x[2] + x[0]


def beside_two_circles(t, x, p, dx):
    """The same between two others, so that only orbits nearby run off so fast."""
    beside_a_circle(t, x, p, dx)
    dx[2] = p.a * x[2] - x[2] ** 3 + x[0]


@pytest.mark.drawn(1)
@SCHEMES
def test_multipliers_keep_their_digits_while_they_grow(scheme, most):
    system = small_system(beside_a_circle, ("x", "y", "z"), {"a": 0.5})
    chosen = Discretization(scheme=scheme)
    problem = cw.PeriodicOrbit(system, system.defaults(), "a", discretization=chosen)
    branch = cw.continue_branch(
        problem, [1.0, 0.0, 0.0], range=(0.5, 6.0), period=2.0 * np.pi, direction="forward"
    )
    assert branch.outcome.reason == "bound"
    assert (segments(branch)[0], segments(branch)[-1]) == (1, most)
    off = np.abs(branch["max_abs"] / np.exp(2.0 * np.pi * branch["a"]) - 1.0)
    # Local errors of 1e-6 at most, two digits on the safe side, at some fifty steps.
    assert off.max() < 5e-5


@pytest.mark.drawn(1)
@SCHEMES
def test_an_orbit_is_a_solution_on_the_segments_that_it_was_cut_into(scheme, most):
    system = small_system(beside_two_circles, ("x", "y", "z"), {"a": 0.5})
    chosen = Discretization(scheme=scheme)
    problem = cw.PeriodicOrbit(system, system.defaults(), "a", discretization=chosen)
    branch = cw.continue_branch(
        problem, [1.0, 0.0, 0.0], range=(0.5, 6.0), period=2.0 * np.pi, direction="forward"
    )
    assert branch.outcome.reason == "bound"
    assert segments(branch)[-1] == most
    assert branch.points["residual"].max() < SOLVED
    # Where Newton's method reaches is what limits a step: cut in time, they are limited by curvature.
    assert len(branch) < 150


def test_what_more_segments_would_mend_is_told_with_them():
    system = small_system(beside_a_circle, ("x", "y", "z"), {"a": 0.0})

    def known(a: float) -> str:
        # z = -(a x - y) / (1 + a^2) goes round with the circle
        orbit = np.array([1.0, 0.0, -a / (1.0 + a * a), 2.0 * np.pi, a])
        problem = cw.PeriodicOrbit(system, system.defaults(), "a").adapted_to(orbit, np.ones(5))
        return problem.diagnosis.obstacle(orbit)

    assert known(1.0) == ""
    assert "1 segments" not in known(3.0)
    assert "engine: {segments: 2}" in known(3.0)  # exp(6 pi) is 2e8
    told = outcomes.stuck("no_convergence", "It does not contract.", 1e-12, "a", 3.0, known(3.0))
    assert told.reason == "step_too_small"
    assert told.message.endswith(known(3.0))


def laser(t, x, p, dx):
    """Optical injection at detuning 0.3 (S. Wieczorek et al., Phys. Rep. 416 (2005) 1)."""
    u, v, n = x[0], x[1], x[2]
    dx[0] = p.K + 0.5 * n * u - (n - 0.3) * v
    dx[1] = 0.5 * n * v + (n - 0.3) * u
    dx[2] = -0.07 * n - (1.0 + 0.03 * n) * (u * u + v * v - 1.0)


# Behind three doublings of the cycle from HB1; 105.7 is two of its periods.
ON_THE_LONG_ORBIT = [0.3184214813837366, -0.6305950227722237, -0.9344979115273251]
TWICE_ROUND = 105.68377229599471


def long_orbits(until):
    system = small_system(laser, ("u", "v", "n"), {"K": 0.2932})
    problem = cw.PeriodicOrbit(system, system.defaults(), "K")
    given = {"range": (until, 0.2933), "period": TWICE_ROUND, "direction": "backward"}
    return cw.continue_branch(problem, ON_THE_LONG_ORBIT, **given)


def test_a_long_orbit_goes_on_where_its_multiplier_passes_a_million(monkeypatch):
    """Gone round twice: the square of the multiplier of one round."""
    monkeypatch.setattr(opening_smooth, "repetitions", lambda problem, z: 1)
    branch = long_orbits(0.2825)
    assert branch.outcome.reason == "bound", branch.outcome.message
    assert branch.points["residual"].max() < SOLVED
    assert branch["max_abs"].max() > 1e6
    assert branch["trivial_error"].max() < 1e-3  # where the flow misses its velocity by that, it is cut


def test_an_orbit_begun_twice_round_is_found_where_deviations_grow():
    """Its halves are compared on its own steps: on others they come to lie apart."""
    branch = long_orbits(0.293)
    assert branch["period"].max() < 0.51 * TWICE_ROUND
    assert branch["max_abs"].min() == pytest.approx(2.1438, rel=1e-3)  # once round, not its square


def test_a_burster_is_cut_where_halves_on_other_steps_lead_elsewhere():
    """Its canard repels on the way by far more than a round, which forgets it: an orbit on steps of halves is
    out of reach of corrections, and over one segment Newton's method ended at a period of 16344.
    """
    system = plant_in_a_current.SYSTEM
    machine = cw.Equilibrium(system, system.defaults() | {"I": -0.1}, free="I")
    start = [-66.535, 0.98736, 0.0086276, 0.0772518, 0.135619]
    rest = cw.continue_branch(machine, start, range=(-0.18, 0.3))
    cycles = cw.switch_branch(machine, rest, "HB1", range=(-0.18, 0.3), max_points=75)
    assert cycles.outcome.reason == "max_points", cycles.outcome.message
    assert cycles["period"].max() > 16400.0
    assert cycles["trivial_error"][-5:].max() < 1e-3  # where the flow misses its velocity by that, it is cut
    assert segments(cycles)[0] == 1
    assert segments(cycles)[-1] >= LEAST_CHOSEN


def beside_a_circle_for_a_while(t, x, p, dx):
    """z on the unit circle (cos t, sin t): a deviation is exp(a (1 - cos t)) times as large after t."""
    growth = 1.0 - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = growth * x[1] + x[0]
    dx[2] = p.a * x[1] * x[2] + p.b - x[2] * p.b


@pytest.mark.parametrize("a", [2.0, -2.0])
def test_what_grows_up_to_somewhere_counts_and_what_grows_from_somewhere_on(a):
    """By exp(2 |a|) over the half round that grows; the other half forgets it again, before or after."""
    system = small_system(beside_a_circle_for_a_while, ("x", "y", "z"), {"a": a, "b": 1e-3})
    problem = cw.PeriodicOrbit(system, system.defaults(), "a")
    settings = {"range": (a - 0.5, a + 0.5), "period": 2.0 * np.pi, "max_points": 2}
    branch = cw.continue_branch(problem, [1.0, 0.0, 1.0], **settings)
    there, sample = reopened(system, branch, int(np.flatnonzero(branch["s"] == 0.0)[0]))
    # What holds z near one damps a deviation too: by some thousandths.
    assert growth(there, sample.z) == pytest.approx(np.exp(2.0 * abs(a)), rel=0.05)


@pytest.mark.parametrize("growth_of_all", [1.5, 1e3, 1e5, 1e9, 1e20])
def test_over_each_segment_deviations_grow_by_no_more_than_allowed(growth_of_all):
    """And by more than that over fewer segments."""
    exponent = np.log(growth_of_all)
    count = segments_of_growth(exponent)
    assert np.exp(exponent / count) <= MOST_GROWTH * (1.0 + 1e-12)
    assert count == 1 or np.exp(exponent / (count - 1)) > MOST_GROWTH
