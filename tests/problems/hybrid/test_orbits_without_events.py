"""Orbits that meet no event of their machine: one leg that ends where it began, in any number of segments."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, machine
from small_systems import labelled

import contwalk as cw
from contwalk.branch import Branch
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.diagram.opening import Opening
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.studies.opening import opened
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import System, Transition

# The double-well Duffing oscillator, as in test_orbit_duffing: a pitchfork of its symmetric orbit, and the
# period doubling of those that leave.
BREAKING, DOUBLING = 2.247962733915481, 2.8345639957877022
SYMMETRIC = [1.67967, 1.64822011]
GROWS, DECAYS = 1.5, 0.3


def pushed(t, x, p, after):
    for i in range(len(x)):
        after[i] = 0.5 * x[i]


def far_from_its_event(names: list[str], values: dict[str, float], field, **rest) -> System:
    """A machine whose event is not met by the orbits that are asked for."""
    event = Transition("far", "free", "free", lambda t, x, p: 50.0 - x[0], reset=pushed)
    return machine(names, values, {"free": field}, [event], **rest)


def duffing() -> System:
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -p.d * x[1] + x[0] - x[0] * x[0] * x[0] + p.F * np.cos(t)

    return far_from_its_event(["x", "v"], {"d": 0.3, "F": 1.5}, field, period=lambda p: 2.0 * math.pi)


def circles() -> System:
    """A cycle of radius sqrt(mu) in x and y, from which z - x grows and w - y decays."""

    def field(t, x, p, dx):
        s = p.mu - x[0] ** 2 - x[1] ** 2
        dx[0] = s * x[0] - x[1]
        dx[1] = x[0] + s * x[1]
        dx[2] = GROWS * (x[2] - x[0]) + dx[0]
        dx[3] = -DECAYS * (x[3] - x[1]) + dx[1]

    return far_from_its_event(["x", "y", "z", "w"], {"mu": 0.2}, field)


def walked(
    system: System, free: str, state: list[float], range_, segments: int, until=None, **rest
) -> list[Branch]:
    settings = Settings(range=range_)
    steps = cw.Discretization(accuracy=ACCURACY, segments=segments)
    values = system.defaults()
    opening = opened_orbit(
        system, values, free, np.array(state), settings, discretization=steps, until=until, mode="free"
    )
    assert isinstance(opening, Opening), opening.message
    assert isinstance(opening.problem, HybridOrbit)
    plan = Plan(settings, frozenset(rest.get("follow", ())), rest.get("depth", 0), (1.0,))
    made = Diagram([Start(system, free, values, opening, "the start")], plan)
    for _ in made.events():
        pass
    return made.branches


@pytest.mark.drawn(1)
@pytest.mark.parametrize("segments", [1, 2, 5])
def test_multipliers_are_the_same_on_any_number_of_segments(segments: int) -> None:
    (branch,) = walked(
        circles(), "mu", [math.sqrt(0.2), 0.0, math.sqrt(0.2), 0.0], (0.2, 0.4), segments, until=2.0 * math.pi
    )
    assert np.isfinite(branch.points["unknowns"]).sum(axis=1).max() == 4 * segments + 1
    T = 2.0 * math.pi
    for mu, found in zip(branch["mu"], branch.points["spectrum"], strict=True):
        expected = sorted([math.exp(GROWS * T), math.exp(-2.0 * mu * T), math.exp(-DECAYS * T)], reverse=True)
        np.testing.assert_allclose(found.real, expected, rtol=1e-5)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("segments", [1, 3])
def test_pitchforks_and_doublings_of_forced_orbits(segments: int) -> None:
    """Nobody declared the symmetry: steps are alike in both halves, so that its loss is a pitchfork still."""
    symmetric, broken, *doubled = walked(
        duffing(), "F", SYMMETRIC, (1.0, 3.0), segments, until="settled", follow=("BP", "PD"), depth=2
    )
    (point,) = labelled(symmetric, "BP", "PD", "LP", "NS")[:1]
    assert (point.label, point.kind) == ("BP", "pitchfork")
    assert_met(point, "F", BREAKING)
    (doubling, *_) = labelled(broken, "PD")
    assert_met(doubling, "F", DOUBLING)
    assert doubled
    assert doubled[0].info.subharmonic == 2
    np.testing.assert_allclose(doubled[0]["period"], 4.0 * math.pi, rtol=1e-12)
    # Beside its birth the doubled orbit's largest multiplier is one.
    assert doubled[0].points["spectrum"][0].real.max() == pytest.approx(1.0, abs=1e-4)


def test_multipliers_where_a_cycle_is_born() -> None:
    """At the Hopf point the orbit stands still: what is left out is the way that it is about to move."""
    system = circles()
    settings = Settings(range=(-0.1, 0.2))
    steps = cw.Discretization(accuracy=ACCURACY)
    values = system.defaults() | {"mu": -0.1}
    opening = opened(system, values, "mu", np.zeros(4), settings, discretization=steps)
    made = Diagram([Start(system, "mu", values, opening, "the start")], Plan(settings, frozenset({"HB"}), 1))
    for _ in made.events():
        pass
    _, cycle = made.branches
    assert cycle.info.problem == "hybrid_orbit"
    assert np.isfinite(cycle.points["unknowns"]).sum(axis=1).min() > 5  # z grows by e^9: several segments
    T = 2.0 * math.pi
    expected = [math.exp(GROWS * T), 1.0, math.exp(-DECAYS * T)]
    first = cycle.points[int(np.argmin(np.abs(cycle["s"])))]
    np.testing.assert_allclose(first["spectrum"].real, expected, rtol=1e-5)
    for mu, found in zip(cycle["mu"], cycle.points["spectrum"], strict=True):
        assert sorted(found.real)[1] == pytest.approx(math.exp(-2.0 * mu * T), abs=1e-4) or mu > 0.15


@pytest.mark.drawn(2)
@pytest.mark.parametrize("until", [None, "settled"])
@pytest.mark.parametrize("rest", [0.0, 1.0, 1e-300, 1e5])
def test_states_that_stay_where_they_are_exactly(rest: float, until: str | None) -> None:
    def field(t, x, p, dx):
        s = p.mu - x[0] ** 2 - x[1] ** 2
        dx[0] = s * x[0] - x[1]
        dx[1] = x[0] + s * x[1]
        dx[2] = -DECAYS * (x[2] - rest)

    system = far_from_its_event(["x", "y", "z"], {"mu": 0.2}, field)
    (branch,) = walked(system, "mu", [math.sqrt(0.2), 0.0, rest], (0.2, 0.4), 1, until=until)
    T = 2.0 * math.pi
    np.testing.assert_allclose(branch.points["state"][:, 2], rest, rtol=1e-12, atol=1e-290)
    for mu, found in zip(branch["mu"], branch.points["spectrum"], strict=True):
        expected = sorted([math.exp(-2.0 * mu * T), math.exp(-DECAYS * T)], reverse=True)
        np.testing.assert_allclose(found.real, expected, rtol=1e-5)
