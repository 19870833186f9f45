"""Diagrams of hybrid machines without files, and plugins of a few lines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

import contwalk as cw
from contwalk.branch import Branch, Outcome, SpecialPoint
from contwalk.continuation.settings import Mark, Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.diagram.opening import Opening
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Mode, Parameter, State, System, Transition

ACCURACY = 1e-9
DIRECTIONS = {"both": (1.0, -1.0), "up": (1.0,), "down": (-1.0,)}


def machine(
    states: Sequence[str | State],
    parameters: Mapping[str, float],
    modes: Mapping[str, Callable[..., None]] | Sequence[Mode],
    transitions: Sequence[Transition],
    **rest: Any,
) -> System:
    """A small hybrid system; states by name or declared, modes by name or declared."""
    if isinstance(modes, Mapping):
        modes = [Mode(name, field) for name, field in modes.items()]
    return System(
        "small",
        states=tuple(State(s) if isinstance(s, str) else s for s in states),
        parameters=tuple(Parameter(name, value) for name, value in parameters.items()),
        modes=tuple(modes),
        transitions=tuple(transitions),
        **rest,
    )


def opened(
    system: System,
    free: str,
    state: Sequence[float],
    parameters: Mapping[str, float] | None = None,
    *,
    mode: str | None = None,
    event: str | None = None,
    until: float | str | None = None,
    accuracy: float = ACCURACY,
    method: str = "auto",
    scheme: str = "shooting",
    segments: int | None = None,
    report_event: tuple[str, str] | None = None,
    settings: Settings | None = None,
) -> Opening | Outcome:
    """The orbit that a motion leads to, corrected, or why there is none.

    `event`: the state is right before it; without `until` it is on an orbit already.
    """
    return opened_orbit(
        system,
        system.defaults() | dict(parameters or {}),
        free,
        np.array(state, dtype=float),
        settings or Settings(),
        discretization=cw.Discretization(
            accuracy=accuracy, method=method, scheme=scheme, segments=segments, report_event=report_event
        ),
        until=until,
        mode=mode,
        event=event,
    )


def solution(*given: Any, **options: Any) -> tuple[HybridOrbit, np.ndarray]:
    """The problem of the orbit that a motion leads to, and the orbit; arguments as for `opened`."""
    opening = opened(*given, **options)
    assert isinstance(opening, Opening), opening.message
    assert isinstance(opening.problem, HybridOrbit)
    return opening.problem, opening.state.sample.z


def diagram(
    system: System,
    free: str,
    range: tuple[float, float],
    state: Sequence[float],
    parameters: Mapping[str, float] | None = None,
    *,
    events: Mapping[str, str] | None = None,
    follow: Sequence[str] = (),
    depth: int = 1,
    direction: str = "both",
    marks: Mapping[str, Sequence[float | str]] | None = None,
    max_points: int = 400,
    max_step: float = 0.1,
    **start: Any,
) -> list[Branch]:
    """All branches of a diagram; `start` holds further arguments of `opened`."""
    chosen = Settings(
        range=range,
        max_points=max_points,
        max_step=max_step,
        marks=tuple(
            Mark(name, tuple(float(v) for v in values if v != "extremum"), "extremum" in values)
            for name, values in (marks or {}).items()
        ),
        events={"GR": "stop", "OC": "switch", "AZ": "ignore"} | dict(events or {}),
    )
    values = system.defaults() | dict(parameters or {})
    opening = opened(system, free, state, parameters, settings=chosen, **start)
    plan = Plan(chosen, frozenset(follow), depth, DIRECTIONS[direction])
    found = Diagram([Start(system, free, values, opening, "the start")], plan)
    for _ in found.events():
        pass
    return found.branches


def branch_of(*given: Any, **options: Any) -> Branch:
    """The one branch of a diagram that follows nothing; arguments as for `diagram`."""
    (branch,) = diagram(*given, **options)
    return branch


def assert_met(point: SpecialPoint, name: str, truth: float, accuracy: float = ACCURACY) -> None:
    """The claimed error is an upper bound of the true one, and the accuracy that was asked for is met."""
    assert point.status == "located", point.note
    assert point.error is not None
    off = abs(point.parameters[name] - truth)
    # `truth` is a float, and a root of something that is known to some roundings.
    assert off <= point.error + 1e-15 * max(abs(truth), 1.0), (point.name, off, point.error)
    assert point.error <= accuracy * max(abs(truth), 1e-3), (point.name, point.error)
