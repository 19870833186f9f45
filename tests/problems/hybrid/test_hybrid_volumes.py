"""Starts of machines that lose nothing: with two frequencies they do not come back, and that is told."""

import math

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.errors import StartError
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.problems.initial.event_search import MOST_STEPS
from contwalk.problems.initial.recurrence import AtRest
from contwalk.system import Conserved, State, System, Transition

pytestmark = pytest.mark.slow

VALUES = {"k": 0.3, "c": 0.0, "e": 1.0, "push": 0.0}
START = np.array([0.5, 1.0, 2.0, 0.0])


def oscillators(t, x, p, dx):
    dx[0], dx[1] = x[2], x[3]
    dx[2] = -x[0] - p.k * (x[0] - x[1]) - p.c * x[2]
    dx[3] = -2.0 * x[1] - p.k * (x[1] - x[0]) - p.c * x[3] + p.push * (1.0 - x[1] ** 2) * x[3]


def stretched(t, x, p, dx):
    """The same in other coordinates: y is exp(q) - 1 of what oscillates; volumes go up and down."""
    q = math.log(1.0 + x[1])
    dx[0], dx[1] = x[2], (1.0 + x[1]) * x[3]
    dx[2] = -x[0] - p.k * (x[0] - q) - p.c * x[2]
    dx[3] = -2.0 * q - p.k * (q - x[0]) - p.c * x[3]


def driven(t, x, p, dx):
    oscillators(t, x, p, dx)
    dx[2] += 0.4 * math.cos(1.7 * t)


def pressed(t, x, p, dx):
    oscillators(t, x, p, dx)
    dx[2] += 50.0 * (1.0 - x[0])


def gap(t, x, p):
    return 1.0 - x[0]


def bounce(t, x, p, after):
    after[0], after[1], after[2], after[3] = x[0], x[1], -p.e * x[2], x[3]


WALL = [Transition("wall", "free", "free", gap, reset=bounce)]
SPRING = [
    Transition("touch", "free", "pressed", gap, "falling"),
    Transition("leave", "pressed", "free", gap, "rising"),
]
STATES = ["x", "y", "u", "v"]
HARD = machine(STATES, VALUES, {"free": oscillators}, WALL)
SOFT = machine(STATES, VALUES, {"free": oscillators, "pressed": pressed}, SPRING)
CURVED = machine(STATES, VALUES, {"free": stretched}, WALL)


def told(system: System, **values: float) -> StartError:
    with pytest.raises(StartError) as raised:
        recurrence_from(system, {**VALUES, **values}, START)
    return raised.value


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("system", "k"),
    [(HARD, 0.3), (HARD, 0.0), (SOFT, 0.3), (SOFT, 0.0), (CURVED, 0.3), (CURVED, 0.0)],
    ids=["wall", "wall, uncoupled", "spring", "spring, uncoupled", "coordinates", "coordinates, uncoupled"],
)
def test_a_machine_with_two_frequencies_that_loses_nothing_says_that_it_conserves_something(system, k):
    error = told(system, k=k)
    events = int(error.sentence.split("did not come back within ")[1].split(" events")[0])
    assert events == 401  # of 11000 that a search may take
    assert "quasi-periodic" in error.sentence
    assert "seems to conserve a quantity" in error.sentence
    assert "conserved=(Conserved(" in error.remedy
    assert "until: 0" in error.remedy or "near, a periodic orbit" in error.remedy


@pytest.mark.drawn(1)
@pytest.mark.parametrize("system", [HARD, CURVED], ids=["wall", "coordinates"])
@pytest.mark.parametrize("changed", [{"c": 0.001}, {"c": 1e-4}, {"e": 0.999}], ids=str)
def test_a_slight_loss_is_none_of_a_conserved_quantity(system, changed):
    # Volumes shrink by exp(-2 c t), at an impact by e^2: within a search to nothing.
    sentence = told(system, **changed).sentence
    assert "conserve" not in sentence
    assert "quasi-periodic" not in sentence


def test_with_a_loss_the_machine_comes_to_rest():
    with pytest.raises(AtRest) as raised:
        recurrence_from(HARD, {**VALUES, "c": 0.02}, START)
    np.testing.assert_allclose(raised.value.state, 0.0, atol=1e-3)


def test_with_a_loss_and_a_drive_the_machine_settles_on_an_orbit():
    lap = recurrence_from(HARD, {**VALUES, "c": 0.02, "push": 0.3}, START)
    assert lap.missed < 1e-4
    assert "wall" in lap.itinerary.signature(HARD)


def test_a_wall_that_has_not_been_met_may_lose_something():
    # Nothing is said early: what has not happened yet is not known to keep anything.
    far = [*WALL, Transition("far", "free", "free", lambda t, x, p: x[1] - 1e3, reset=bounce)]
    error = told(machine(STATES, VALUES, {"free": oscillators}, far))
    events = int(error.sentence.split("within ")[1].split(" events")[0])
    assert events > MOST_STEPS / 100
    assert "seems to conserve" in error.sentence


def test_what_is_declared_to_be_conserved_is_not_asked_for():
    def energy(t, x, p):
        return 0.5 * (x[2] ** 2 + x[3] ** 2 + x[0] ** 2 + 2.0 * x[1] ** 2 + p.k * (x[0] - x[1]) ** 2)

    declared = machine(STATES, VALUES, {"free": oscillators}, WALL, conserved=(Conserved("energy", energy),))
    error = told(declared, energy=4.0)
    assert "quasi-periodic" in error.sentence
    assert "conserve" not in error.sentence + error.remedy


def test_a_driven_machine_without_losses_is_not_said_to_conserve_its_energy():
    system = machine(STATES, VALUES, {"free": driven}, WALL, period=lambda p: 2.0 * math.pi / 1.7)
    error = told(system)
    assert "nothing is lost" in error.sentence
    assert "conserve" not in error.sentence + error.remedy


def swinging(t, x, p, dx):
    """A mass on a spring that swings, in polar coordinates and their rates: volumes go with 1 / r^2."""
    r, angle, u, w = x[0], x[1], x[2], x[3]
    dx[0], dx[1] = u, w
    dx[2] = r * w * w + math.cos(angle) - 8.0 * (r - 1.0) - p.c * u
    dx[3] = (-math.sin(angle) - 2.0 * u * w) / r - p.c * w


ROPE = Transition(
    "rope", "free", "free", lambda t, x, p: 1.3 - x[0], reset=lambda t, x, p, after: bounced(x, p, after)
)


def bounced(x, p, after):
    after[0], after[1], after[2], after[3] = x[0], x[1], -p.e * x[2], x[3]


def swing(angle: float, period: float | None, **values: float) -> StartError:
    states = ["r", State("angle", period=period), "u", "w"]
    system = machine(states, VALUES, {"free": swinging}, [ROPE])
    with pytest.raises(StartError) as raised:
        recurrence_from(system, {**VALUES, **values}, np.array([1.2, angle, 0.4, 0.0]))
    return raised.value


@pytest.mark.drawn(1)
@pytest.mark.parametrize("angle", [1.5, 2.0])
@pytest.mark.parametrize("period", [None, 2.0 * math.pi])
def test_an_irregular_motion_in_coordinates_that_are_not_canonical_is_told_soon(angle, period):
    error = swing(angle, period)
    assert "did not come back within 401 events" in error.sentence
    assert "seems to conserve a quantity" in error.sentence


@pytest.mark.drawn(1)
@pytest.mark.parametrize("changed", [{"c": 1e-3}, {"e": 0.999}, {"e": 0.99}], ids=str)
def test_an_irregular_motion_that_loses_something_is_not_said_to_lose_nothing(changed):
    assert "conserve" not in swing(1.5, None, **changed).sentence
