"""What becomes of a small deviation along an orbit, against neighbouring motions that scipy integrates."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from hybrid_invariants import written
from hybrid_machines import CASES, orbit, through
from hybrid_runs import machine, solution
from scipy.integrate import solve_ivp
from test_hybrid_mirror import MIRROR, START, field, travelling, two_sided
from test_soft_orbit import system as spring_and_wall

import contwalk as cw
from contwalk.diagram.reopening import reopened
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_orbit import SoftOrbit
from contwalk.problems.orbit.deviations import Deviations
from contwalk.problems.orbit.modes import chosen_multiplier

# Neighbours on both sides, this far away in units of the orbit's variation: differences are known to its
# square, and to scipy's errors over it.
APART = 1e-5
NEAR = 1e-6
SHARES = np.array([0.3, 0.5, 0.8])
CLOSURES = 2


def at(duration: np.ndarray) -> np.ndarray:
    """Instants of each of some legs that are away from events, seconds."""
    starts = np.concatenate([[0.0], np.cumsum(duration)[:-1]])
    return starts[:, None] + duration[:, None] * SHARES


def neighbour(problem: HybridOrbit, z: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Full states of a motion at the instants of `at` from the orbit's first one on, shape (legs, 3, n)."""
    p, system = SimpleNamespace(**problem.values_of(z)), problem.system
    durations = np.tile(z[problem.layout.durations], CLOSURES)
    begin = float(problem.starting_times(z)[0])
    instants, x, t, found = begin + at(durations), start, begin, []
    for i, lasting in enumerate(durations):
        leg = problem.itinerary.legs[i % problem.layout.legs]
        place = list(system.states_of(leg.mode))

        def full(y: np.ndarray, place: list[int] = place) -> np.ndarray:
            result = np.zeros(len(system.states))
            result[place] = y
            return result

        # scipy's dense output is of lower order: a run up to each instant is not.
        found.append([full(_until(system, leg.mode, p, full, place, x, t, time)) for time in instants[i]])
        x, t = through(system, leg, p, x, t, float(lasting), begin + float(durations[: i + 1].sum()))
    return np.array(found)


def _until(system, mode, p, full, place, x, t, time) -> np.ndarray:
    run = solve_ivp(
        lambda s, y: written(system.mode(mode).field, s, full(y), p)[place],
        (t, time),
        x,
        "DOP853",
        rtol=1e-13,
        atol=1e-15,
    )
    return run.y[:, -1]


def deviated(deviations, mode, legs: int) -> np.ndarray:
    """Deviations at the same instants over some closures."""
    d, found = mode.start.real, []
    for number in range(CLOSURES):
        found += deviations.closure(d, number % deviations.rounds, [SHARES] * legs)
        d = mode.after(number + 1, deviations.after(d))
    return np.array(found)


@cache
def soft_orbit() -> tuple[HybridOrbit, np.ndarray]:
    """One whose itinerary leaves out the soft transitions that it meets."""
    found = solution(spring_and_wall(), "force", [0.0, 0.5], {"force": 1.5}, until="settled", accuracy=1e-11)
    assert isinstance(found[0], SoftOrbit)
    return found


ORBITS = {name: lambda name=name: orbit(name, 1e-11) for name in CASES} | {"soft and hard": soft_orbit}


@pytest.mark.drawn(4)
@pytest.mark.parametrize("name", list(ORBITS))
def test_neighbouring_motions_go_as_the_deviation_says(name):
    deviations = Deviations(*ORBITS[name]())
    problem, z = deviations.problem, deviations.z
    for number in range(1, min(problem.spectrum_size, 3) + 1):
        mode = deviations.mode(number)
        start, scale = mode.start.real, problem.mesh.variation
        step = APART / np.max(np.abs(start) / scale[list(problem.passages[0].states)])
        x = problem.layout.inputs(0, z)[0]
        sides = [neighbour(problem, z, x + side * step * start) for side in (1.0, -1.0)]
        expected = (sides[0] - sides[1]) / (2.0 * step) / scale
        found = deviated(deviations, mode, problem.layout.legs) / scale
        assert np.max(np.abs(found - expected)) <= NEAR * np.max(np.abs(expected)), number


@pytest.mark.parametrize("name", list(ORBITS))
def test_a_closure_multiplies_a_mode(name):
    """But for what it moves along the orbit; every multiplier of the spectrum has its mode."""
    deviations = Deviations(*ORBITS[name]())
    problem, z = deviations.problem, deviations.z
    spectrum = problem.multipliers(z, problem.jacobian(z)).values
    for number, multiplier in enumerate(spectrum, start=1):
        mode = deviations.mode(number)
        assert mode.multiplier == multiplier
        carried = deviations.after(mode.start.real) + 1j * deviations.after(mode.start.imag)
        left = (carried - multiplier * mode.start) / mode.magnitudes
        along = mode.neutral / mode.magnitudes[:, None]
        left = left - along @ np.linalg.lstsq(along, left, rcond=None)[0]
        assert np.linalg.norm(left) <= 1e-9 * np.linalg.norm(mode.start / mode.magnitudes)


# -- orbits of half a period: the field is smooth, so that scipy needs no events -----------------------------


@cache
def travelling_orbit() -> tuple[HybridOrbit, np.ndarray]:
    options = {"mode": "right", "until": "settled", "accuracy": 1e-11}
    return solution(two_sided(True), "rho", [*START, 7.0, -2.0], **options)


@cache
def smooth_orbit() -> tuple[cw.PeriodicOrbit, np.ndarray]:
    system = machine(["x", "y", "z"], {"rho": 325.0}, {"all": field}, [], symmetries=(MIRROR,))
    given = cw.Discretization(accuracy=1e-11)
    problem = cw.PeriodicOrbit(system, system.defaults(), "rho", discretization=given)
    branch = cw.continue_branch(problem, START, range=(320.0, 330.0), until="settled", max_points=2)
    found, sample = reopened(system, branch, 0, given)
    return found, sample.z


def checked(
    deviations, problem, z: np.ndarray, x: np.ndarray, f: Callable[..., None], duration: float
) -> None:
    """Both multipliers' modes over two closures, which are a period, from the ground."""
    p, scale = SimpleNamespace(**problem.values_of(z)), problem.mesh.variation
    instants = at(np.full(CLOSURES, duration)).ravel()
    for number in (1, 2):
        mode = deviations.mode(number)
        start = mode.start.real
        step = APART / np.max(np.abs(start) / scale)
        sides = []
        for side in (1.0, -1.0):
            y = x + side * step * start
            run = [
                solve_ivp(lambda t, y: written(f, t, y, p), (0.0, s), y, "DOP853", rtol=1e-13, atol=1e-13)
                for s in instants
            ]
            sides.append(np.array([r.y[:, -1] for r in run]))
        expected = (sides[0] - sides[1]) / (2.0 * step) / scale
        found = deviated(deviations, mode, 1).reshape(len(instants), -1) / scale
        assert np.max(np.abs(found - expected)) <= NEAR * np.max(np.abs(expected)), number


@pytest.mark.long
def test_a_mirrored_half_with_pinned_directions():
    """The second half is seen as the image of an integrated one; places that are pinned start undisplaced."""
    problem, z = travelling_orbit()
    assert problem.itinerary.image == "mirror"
    deviations = Deviations(problem, z)
    x = problem.stretches(z)[0].start[1]
    assert np.allclose(deviations.mode(1).start[3:], 0.0, atol=1e-12)
    checked(deviations, problem, z, x, travelling, problem.duration(z))


def test_a_smooth_orbit_of_half_a_period():
    problem, z = smooth_orbit()
    assert problem.itinerary.closures == 2
    checked(Deviations(problem, z), problem, z, problem.first_state(z), field, problem.duration(z))


@pytest.mark.parametrize("kind", ["hybrid", "smooth"])
def test_modes_beyond_the_spectrum_are_refused(kind):
    deviations = Deviations(*(orbit("walker") if kind == "hybrid" else smooth_orbit()))
    number = len(
        deviations.problem.multipliers(deviations.z, deviations.problem.jacobian(deviations.z)).values
    )
    with pytest.raises(cw.ContwalkError, match=f"no mode {number + 1}.* Name one of the modes 1 to {number}"):
        deviations.mode(number + 1)


def test_an_infinite_multiplier_has_no_mode():
    with pytest.raises(cw.ContwalkError, match=r"infinite multiplier.* Name a point beside it"):
        chosen_multiplier(np.array([complex(np.inf), 0.5]), 1)
    assert chosen_multiplier(np.array([complex(np.inf), 0.5]), 2) == 0.5
