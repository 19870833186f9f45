"""Starts by simulation: motions that accumulate or come back late, and the bound on looking for a return."""

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.continuation.settings import Settings
from contwalk.errors import StartError
from contwalk.problems.initial import event_search as recurrence
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Transition


def falling(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0


def bounce(t, x, p, after):
    after[0] = x[0]
    after[1] = -p.e * x[1]


BALL = machine(
    ["y", "v"],
    {"e": 0.5},
    {"free": falling},
    [Transition("hit", "free", "free", lambda t, x, p: x[0], reset=bounce)],
)


@pytest.mark.drawn(2)
@pytest.mark.parametrize("until", ["settled", 1.0])
@pytest.mark.parametrize("e", [0.5, 0.9, 0.97])
def test_a_motion_whose_impacts_accumulate_has_no_orbit(e, until):
    # From height 1 the impacts end at sqrt(2) (1 + e) / (1 - e). Flights near there are alike to any part of
    # the motion's size, and slow ones (e = 0.97) shorten by less than a twentieth each.
    ends = np.sqrt(2.0) * (1.0 + e) / (1.0 - e)
    with pytest.raises(StartError, match="accumulates") as raised:
        recurrence_from(BALL, {"e": e}, np.array([1.0, 0.0]), until=until)
    told = float(raised.value.sentence.split("until t = ")[1].split(". ")[0])
    # The sum of a series, of which the last flights are known to some digits.
    assert told == pytest.approx(ends, rel=1e-9)
    assert "until: 0" in raised.value.remedy  # two flights were alike enough for a first near return


def ticking(t, x, p, dx):
    dx[0] = 1.0
    dx[1] = 0.0


def settle(t, x, p, after):
    after[0] = 0.0
    after[1] = p.rate * x[1] + (1.0 - p.rate) * p.goal


CLOCK = machine(
    ["time", "y"],
    {"rate": 0.995, "goal": 1.0},
    {"free": ticking},
    [Transition("tick", "free", "free", lambda t, x, p: 1.0 - x[0], reset=settle)],
)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("until", ["settled", 1500.0])
def test_a_motion_that_takes_more_than_a_thousand_events_to_settle_is_found(until):
    # y misses 1 by rate^n: its change in one lap is below 1e-5 of its range (1/2) after 1380 of them.
    lap = recurrence_from(CLOCK, {"rate": 0.995, "goal": 1.0}, np.zeros(2), until=until)
    assert lap.itinerary.signature(CLOCK) == ("tick",)
    assert lap.stretches[0].start > 1000.0
    assert abs(lap.stretches[0].state[1] - 1.0) < 2e-3  # 0.995^1242


@pytest.mark.parametrize(("rate", "told"), [(1.00001, True), (0.99, False)])
def test_an_orbit_that_is_unstable_though_the_motion_was_to_settle_is_told(rate, told):
    """From 1.001 it leaves y = 1 by 1e-8 in each lap: for a simulation it has settled."""
    values = {"rate": rate, "goal": 1.0}
    settings = Settings(range=(0.5, 2.0))
    opening = opened_orbit(CLOCK, values, "goal", np.array([0.0, 1.001]), settings, until="settled")
    assert opening.state.sample.z[1] == pytest.approx(1.0, rel=1e-9)
    assert ("unstable, though the simulation was to settle" in opening.message) == told


def logistic(t, x, p, after):
    after[0] = 0.0
    after[1] = p.rate * x[1] * (1.0 - x[1])


# A parameter at which the logistic map has no stable orbit to be seen.
CHAOS = machine(
    ["time", "y"],
    {"rate": 3.9},
    {"free": ticking},
    [Transition("tick", "free", "free", lambda t, x, p: 1.0 - x[0], reset=logistic)],
)


@pytest.mark.long
def test_an_irregular_motion_that_comes_near_to_where_it_was_has_not_settled(monkeypatch):
    # Among 1400 values in an interval, each with the 64 before it, some pairs are nearer than 1e-5.
    monkeypatch.setattr(recurrence, "MOST_STEPS", 50_000)
    with pytest.raises(StartError, match="not periodic"):
        recurrence_from(CHAOS, {"rate": 3.9}, np.array([0.0, 0.3]))


def test_a_search_that_is_given_up_says_how_long_it_has_looked(monkeypatch):
    monkeypatch.setattr(recurrence, "MOST_STEPS", 2000)
    with pytest.raises(StartError, match=r"given up after \d+ events and \d+ steps at t = ") as raised:
        recurrence_from(CHAOS, {"rate": 3.9}, np.array([0.0, 0.3]))
    assert "nearest return missed by" in raised.value.sentence
    assert "until: SECONDS" in raised.value.remedy
    # What passes before the time that was asked for does not count.
    with pytest.raises(StartError, match=r"after 67 events .* at t = 167\b"):
        recurrence_from(CHAOS, {"rate": 3.9}, np.array([0.0, 0.3]), until=100.0)
    monkeypatch.setattr(recurrence, "BEFORE", 1)
    with pytest.raises(StartError, match="more than may pass before until") as raised:
        recurrence_from(CHAOS, {"rate": 3.9}, np.array([0.0, 0.3]), until=1e6)
    assert "until: SECONDS" not in raised.value.remedy
