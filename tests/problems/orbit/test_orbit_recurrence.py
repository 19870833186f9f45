"""Finding an orbit by watching a simulation: what settles, what rests, what never comes back."""

import math

import numpy as np
import pytest
from small_systems import small_system

from contwalk.errors import NotFinite, StartError
from contwalk.problems.initial import recurrence
from contwalk.problems.initial.recurrence import recurrent
from contwalk.system import State

# A return is one from 1e-4 of the motion's range on; what it is off multiplies into the period.
NEAR = 1e-3


def stuart_landau(t, x, p, dx):
    s = x[0] ** 2 + x[1] ** 2
    dx[0] = (p.mu - s) * x[0] - p.omega * x[1]
    dx[1] = p.omega * x[0] + (p.mu - s) * x[1]


@pytest.mark.parametrize("omega", [1e-3, 1.0, 1e4])
def test_a_cycle_is_found_with_its_period(omega):
    system = small_system(stuart_landau, "xy", {"mu": 4.0 * omega, "omega": omega})
    found = recurrent(system, system.defaults(), np.array([0.1, 0.1]) * math.sqrt(omega))
    assert found.period == pytest.approx(2.0 * math.pi / omega, rel=NEAR)
    assert np.hypot(*found.state) == pytest.approx(2.0 * math.sqrt(omega), rel=NEAR)
    np.testing.assert_allclose(found.variation, 2.0 * math.sqrt(omega), rtol=0.01)


def test_no_stretch_is_integrated_more_coarsely_than_what_the_motion_has_reached(monkeypatch):
    """From near rest to a cycle of a tenth, in several stretches."""
    given, run = [], recurrence.Simulation.run

    def noted(self, t, x, end, weights):
        given.append(weights)
        return run(self, t, x, end, weights)

    monkeypatch.setattr(recurrence.Simulation, "run", noted)
    system = small_system(stuart_landau, "xy", {"mu": 0.01, "omega": 1.0})
    found = recurrent(system, system.defaults(), np.array([1e-3, 0.0]))
    assert found.period == pytest.approx(2.0 * math.pi, rel=NEAR)
    assert len(given) > 2
    assert np.max(given) < 0.1


def test_a_given_time_of_simulation():
    system = small_system(stuart_landau, "xy", {"mu": 1.0, "omega": 2.0})
    found = recurrent(system, system.defaults(), np.array([0.1, 0.1]), until=30.0)
    assert found.period == pytest.approx(math.pi, rel=NEAR)


@pytest.mark.parametrize("until", [10.0, 2.0 * math.pi, 0.3])
def test_a_forced_motion_is_looked_at_from_the_phase_on_that_it_has_then(until):
    """x = 1 + 2 sin t, whenever the search begins: at the phase zero, where orbits begin, it is one."""

    def field(t, x, p, dx):
        dx[0] = 2.0 * np.cos(t)

    system = small_system(field, "x", {"mu": 1.0}, period=lambda p: 2.0 * math.pi)
    found = recurrent(system, system.defaults(), np.array([1.0]), until=until)
    assert found.state == pytest.approx([1.0], abs=2.0 * NEAR)
    assert found.period == pytest.approx(2.0 * math.pi, rel=1e-15)


def test_a_motion_with_several_loops_a_period():
    """x = sin t + 0.8 sin 3 t beside the cycle: the section is crossed more than once before it closes."""

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (1.0 - s) * x[0] - x[1]
        dx[1] = x[0] + (1.0 - s) * x[1]
        cos3 = 4.0 * x[0] ** 3 - 3.0 * x[0]
        dx[2] = -20.0 * (x[2] - 5.0 * cos3)

    system = small_system(field, "xyz", {"mu": 1.0})
    found = recurrent(system, system.defaults(), np.array([1.0, 0.3, 0.0]))
    assert found.period == pytest.approx(2.0 * math.pi, rel=NEAR)


@pytest.mark.parametrize(("ratio", "periods"), [(1.0, 1), (0.5, 2), (1.0 / 3.0, 3)])
def test_forced_motions_and_subharmonic_ones(ratio, periods):
    """A cycle at a part of the forcing's frequency, which does not feel it: it closes after several
    periods.
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (1.0 - s) * x[0] - ratio * x[1]
        dx[1] = ratio * x[0] + (1.0 - s) * x[1]
        dx[2] = -x[2] + np.cos(t)

    system = small_system(field, "xyz", {"mu": 1.0}, period=lambda p: 2.0 * math.pi)
    found = recurrent(system, system.defaults(), np.array([0.5, 0.1, 0.0]))
    assert found.period == pytest.approx(2.0 * math.pi * periods, rel=1e-12)


def test_an_angle_that_turns_is_no_obstacle():
    def field(t, x, p, dx):
        dx[0] = 2.0 + 0.5 * np.cos(x[0])
        dx[1] = -x[1] + np.sin(x[0])

    states = (State("phi", period=2.0 * math.pi), State("y"))
    system = small_system(field, states, {"mu": 1.0})
    found = recurrent(system, system.defaults(), np.array([0.0, 0.0]))
    # The integral of dphi / (2 + cos(phi) / 2) over a turn.
    assert found.period == pytest.approx(2.0 * math.pi / math.sqrt(4.0 - 0.25), rel=NEAR)


def test_a_motion_that_comes_to_rest():
    system = small_system(stuart_landau, "xy", {"mu": -1.0, "omega": 1.0})
    with pytest.raises(StartError, match="rest"):
        recurrent(system, system.defaults(), np.array([0.5, 0.0]))


def test_a_motion_that_ends():
    def field(t, x, p, dx):
        dx[0] = 1.0 + x[0] ** 2

    system = small_system(field, "x", {"mu": 1.0})
    with pytest.raises(NotFinite):
        recurrent(system, system.defaults(), np.array([0.0]))


def test_a_motion_that_is_not_periodic(monkeypatch):
    """Two frequencies in the golden ratio: returns come as near as one likes, but none within the search."""
    golden = 0.5 * (1.0 + math.sqrt(5.0))

    def field(t, x, p, dx):
        s, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        dx[0] = (1.0 - s) * x[0] - x[1]
        dx[1] = x[0] + (1.0 - s) * x[1]
        dx[2] = (1.0 - q) * x[2] - golden * x[3]
        dx[3] = golden * x[2] + (1.0 - q) * x[3]

    system = small_system(field, "xyzw", {"mu": 1.0})
    monkeypatch.setattr(recurrence, "STRETCHES", 12)  # all of them would take half a minute
    with pytest.raises(StartError, match="did not come back"):
        recurrent(system, system.defaults(), np.array([1.0, 0.0, 1.0, 0.0]))


@pytest.mark.parametrize("rate", [50.0, 400.0, 4000.0])
def test_a_round_may_take_more_steps_than_a_first_stretch(rate):
    """What follows the motion fast keeps the steps of an explicit method short: the cycle attracts still."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = (1.0 - x[0] ** 2) * x[1] - x[0]
        dx[2] = -p.rate * (x[2] - x[0] * x[1])

    system = small_system(field, "xyz", {"rate": rate})
    found = recurrent(system, system.defaults(), np.array([2.0, 0.0, 0.0]))
    assert found.period == pytest.approx(6.6632868593, rel=NEAR)  # van der Pol's, whatever follows it


def test_instants_of_returns_are_found_all_at_once():
    """A sine that is pressed flat against its zeros: false position alone would creep."""

    def side(t):
        seen.append(t)
        return np.sin(t) ** 3

    seen: list[np.ndarray] = []
    times = np.linspace(-1.0, 60.0, 100)
    sampled = np.sin(times) ** 3
    passed = np.flatnonzero((sampled[:-1] < 0.0) & (sampled[1:] >= 0.0))
    instants = recurrence._zeros(side, times, sampled, passed)
    assert len(seen) <= recurrence.TRIALS
    turns = 2.0 * np.pi * np.arange(len(passed))
    # What is left of the sine at a triple zero is the cube root of rounding.
    np.testing.assert_allclose(instants, turns, rtol=0.0, atol=1e-5)
