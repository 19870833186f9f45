"""What is told of a study does not depend on studies of the same system before it in the same process."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.diagram.opening import Opening
from contwalk.problems.hybrid import hybrid_limits
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Mode, Neutral, Parameter, State, System, Transition

VALUES = {"F": 0.5, "k": 0.0}


def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.2 * x[1] - x[0] - 0.3 * x[0] * abs(x[0]) - p.k * abs(x[0]) + p.F * math.cos(0.8 * t)


def smooth() -> System:
    """Second derivatives jump at x = 0, and slopes do unless k = 0."""
    parameters = tuple(Parameter(name, value) for name, value in VALUES.items())
    states, period = (State("x"), State("v")), 2.0 * math.pi / 0.8
    return System(
        "s", states=states, parameters=parameters, modes=(Mode("m", swing),), period=lambda p: period
    )


def eventful() -> System:
    """The same with a stop."""

    def bounce(t, x, p, after):
        after[0], after[1] = x[0], -0.8 * x[1]

    hit = Transition("hit", "m", "m", lambda t, x, p: x[0] + 0.3, "falling", reset=bounce)
    return machine(["x", "v"], VALUES, {"m": swing}, [hit], period=lambda p: 2.0 * math.pi / 0.8)


def notes(system: System, k: float) -> list[str]:
    """What is told of kinks in a study of a system."""
    settings, values = Settings(range=(0.45, 0.6), max_points=4), VALUES | {"k": k}
    opening = opened_orbit(system, values, "F", np.array([0.5, 0.0]), settings, until="settled")
    assert isinstance(opening, Opening), opening.message
    made = Diagram([Start(system, "F", values, opening, "the start")], Plan(settings, frozenset(), 0))
    return [event.text for event in made.events() if isinstance(event, Noted) and "jump" in event.text]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("made", [smooth, eventful])
@pytest.mark.parametrize(("first", "then"), [(0.0, 0.5), (0.5, 0.0)])
def test_kinks_are_told_in_the_order_that_they_have(made, first: float, then: float) -> None:
    alone = notes(made(), then)
    system = made()
    before = notes(system, first)
    assert notes(system, then) == alone
    assert before != alone
    (slopes, second) = (alone, before) if then else (before, alone)
    assert "slopes of the field jump" in slopes[0]
    assert "second derivatives of the field jump" in second[0]


def test_neighbours_of_a_limit_are_those_of_its_own_orbits(monkeypatch) -> None:
    """They are remembered by all that they follow from: pins, turns and paths too."""
    system = eventful()
    settings, values = Settings(range=(0.45, 0.6)), system.defaults()
    opening = opened_orbit(system, values, "F", np.array([0.5, 0.0]), settings, until="settled")
    assert isinstance(opening, Opening)
    problem, z = opening.problem, opening.state.sample.z
    asked: list[object] = []
    monkeypatch.setattr(
        hybrid_limits.itineraries, "found", lambda problem, point: asked.append(problem) or ([], "")
    )

    def ask(orbit) -> int:
        point = Point(label="GR", unknowns=tuple(z))
        orbit.limited.neighbours(point)
        return len(asked)

    assert ask(problem) == ask(problem) == 1
    assert ask(problem.varied(turns=np.array([2.0 * math.pi, 0.0]))) == 2
    pinned = type(problem)(
        system,
        problem.itinerary,
        problem.parameters,
        "F",
        pins=(Neutral("n", lambda t, x, p, dx: None),),
        reference=z[:2],
    )
    monkeypatch.setattr(type(pinned), "values_of", lambda orbit, z: dict(values))
    assert ask(pinned) == 3
    ends = (values, values | {"k": 0.1})
    path = type(problem)(system, problem.itinerary, problem.parameters, "F", ends)
    assert ask(path) == 4
    assert (
        ask(type(problem)(system, problem.itinerary, problem.parameters, "F", (values, values | {"k": 0.2})))
        == 5
    )


class Point:
    """As much of a special point as is looked at."""

    def __init__(self, label: str, unknowns: tuple[float, ...]) -> None:
        self.label, self.unknowns = label, unknowns
