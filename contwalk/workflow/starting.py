"""From the `start` entries of a run file to starts of the diagram."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.diagram import not_begun
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.opening import Opening
from contwalk.errors import DatabaseError, StartError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.studies.opening import opened
from contwalk.workflow.run_file.reading import RunFile, StartSpec
from contwalk.workflow.stored.points import StoredItinerary, stored_point


@dataclass(frozen=True)
class Place:
    """A state to start from, with the values of all parameters there.

    `orbit` says that it lies on a periodic orbit, of `period` seconds; with `until` a simulation finds it.
    Of a hybrid system, `mode` is the one that the state is in, `event` the transition that it is right
    before; an orbit taken from a database comes with its `itinerary`. `kept`: it is a point of a database,
    and no parameter is changed.
    """

    state: np.ndarray
    parameters: dict[str, float]
    origin: str
    period: float | None = None
    until: float | str | None = None
    orbit: bool = False
    mode: str | None = None
    event: str | None = None
    itinerary: StoredItinerary | None = None
    kept: bool = False


def places(run_file: RunFile) -> tuple[list[Place], list[str]]:
    """All states that a study starts from, and notes on what does not exist.

    Raises
    ------
    StartError
        For a start that does not exist, or a point of another database that cannot be read.
    """
    found: list[Place] = []
    notes: list[str] = []
    for spec in run_file.starts:
        try:
            found += [_with_own_values(run_file, place) for place in _places(run_file, spec)]
        except (StartError, DatabaseError) as error:
            if spec.optional and isinstance(error, StartError):
                notes.append(error.sentence)
                continue
            with spec.errors_placed():
                raise
    if not found:
        raise StartError(f"{run_file.path}: nothing to start from. {' '.join(notes)}", "Change `start`.")
    return found, notes


def _places(run_file: RunFile, spec: StartSpec) -> list[Place]:
    parameters = dict(spec.parameters)
    if spec.kind == "equilibrium":
        name = str(spec.name)
        states = run_file.system.named_states(name, parameters)
        several = len(states) > 1
        return [
            Place(x, parameters, f"equilibrium {name}" + (f" ({i})" if several else ""))
            for i, x in enumerate(states, start=1)
        ]
    if spec.kind == "state" and spec.state is not None:
        orbit = spec.at is not None
        return [Place(spec.state, parameters, "the given state", orbit=orbit, mode=spec.mode, event=spec.at)]
    if spec.kind == "from":
        return [_stored_place(run_file, spec)]
    assert spec.state is not None
    until = "settled" if spec.until is None else spec.until
    return [
        Place(
            spec.state,
            parameters,
            "the simulation",
            until=until,
            orbit=True,
            mode=spec.mode,
            event=spec.at,
        )
    ]


def _with_own_values(run_file: RunFile, place: Place) -> Place:
    """The place with what its state has of conserved quantities whose values the run file does not give."""
    system = run_file.system
    if not system.conserved:
        return place
    from contwalk.problems.conserving import with_own_values  # compiled functions

    mode = place.mode or system.modes[0].name
    parameters = with_own_values(system, place.parameters, place.state, mode)
    low, high = run_file.range
    value = parameters.get(run_file.free)
    if run_file.parameter_path is None and value is not None and not low <= value <= high:
        raise StartError(
            f"the start has {run_file.free} = {value:.10g}, outside the range [{low:g}, {high:g}].",
            "Widen continue.range, or start from another state.",
        )
    return replace(place, parameters=parameters)


def _stored_place(run_file: RunFile, spec: StartSpec) -> Place:
    """A point of another database; its parameters, changed by those the run file gives."""
    assert spec.file is not None
    assert spec.point is not None
    found = stored_point(spec.file, spec.point, run_file.system)
    parameters = {**found.parameters, **spec.given}
    low, high = run_file.range
    if run_file.parameter_path is None and not low <= parameters[run_file.free] <= high:
        raise StartError(
            f"{spec.point} of {spec.file} has {run_file.free} = {parameters[run_file.free]:.10g}, "
            f"outside the range [{low:g}, {high:g}].",
            "Widen continue.range, or start from another point.",
        )
    origin = f"{spec.point} of {spec.file.name}"
    if not np.isfinite(found.period):
        return Place(found.state, parameters, origin, mode=found.mode)
    kept = parameters == found.parameters
    orbit = Place(found.state, parameters, origin, found.period, orbit=True, itinerary=found.itinerary)
    return replace(orbit, kept=kept)


def starts(
    run_file: RunFile, found: list[Place], settings: Settings, discretization: Discretization
) -> Iterator[Start]:
    """Starts of the diagram, each corrected to a solution when its turn comes."""
    at = run_file.range[0] if run_file.parameter_path is not None else None
    system, free, path = run_file.system, run_file.free, run_file.parameter_path
    for place in found:
        given = system, place.parameters, free, place.state, settings, path, at, discretization
        if place.orbit or system.period is not None:
            from contwalk.studies.opening_eventful import opened_itinerary  # compiled flows
            from contwalk.studies.opening_orbits import opened_orbit

            if place.itinerary is not None:
                begins = system, place.parameters, free, settings
                opening = opened_itinerary(*begins, path, at, discretization, place.itinerary)
            else:
                opening = opened_orbit(
                    *given, period=place.period, until=place.until, mode=place.mode, event=place.event
                )
        else:
            opening = opened(system.beginning_in(place.mode), *given[1:])
        if not isinstance(opening, Outcome) and place.kept:
            opening = _same_orbit(place, opening, discretization.accuracy)
        orbit = place.orbit or system.period is not None
        yield Start(system, free, place.parameters, opening, place.origin, orbit=orbit)


def _same_orbit(place: Place, opening: Opening, accuracy: float) -> Opening | Outcome:
    """The opening, unless the corrector has come from a stored orbit to another one: periods tell.

    Half the digits of the accuracy tell two apart, or what the found one is known to, where that is more:
    where deviations grow without measure, a state tells an orbit no more. What is found may be the stored one
    gone round once, where that was gone round several times.
    """
    sample = opening.state.sample
    assert place.period is not None
    found, rounds = sample.period, place.period / sample.period
    within = max(math.sqrt(accuracy), sample.error)
    if abs(rounds - max(round(rounds), 1)) <= within * rounds:
        return opening
    return not_begun.refused(
        f"The orbit {place.origin} has the period {place.period:.6g}, and from its state the corrector comes "
        f"to one with {found:.6g}: deviations grow too much for its state to tell which orbit it is.",
        "Start from a point nearer to where the branch begins, or ask for a finer `accuracy`.",
    )
