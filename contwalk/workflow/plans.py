"""What a run file asks of the engine: settings, the discretization of orbits, what is covered, all starts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation.settings import Mark, Settings
from contwalk.diagram.ahead import Task
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.events import Plan
from contwalk.diagram.opening import Opening
from contwalk.problems.orbit.discretization import OF_ORBITS, Discretization, of_orbits
from contwalk.problems.problem import Problem
from contwalk.workflow.going_on import command_without_bound
from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.starting import Place, places, starts

# A run file without a sweep, where it starts, and notes on what does not exist.
Study = tuple[RunFile, list[Place] | list[Start], list[str]]


def studies_of(run_file: RunFile) -> list[Study]:
    """What a run consists of."""
    if run_file.second is not None:
        from contwalk.workflow import loci  # of few runs

        settings, discretization = settings_of(run_file), discretization_of(run_file)
        return [(run_file, loci.from_databases(run_file, settings, discretization), [])]
    return [(study, *places(study)) for study in run_file.studies()]


def discretization_of(run_file: RunFile) -> Discretization:
    """How finely a run's orbits are computed."""
    given = of_orbits(run_file.engine)
    place = run_file.report_at
    event = None if place is None or place.event is None else (place.event, place.side or "before")
    return Discretization(run_file.accuracy, report_at=_report_at(run_file), report_event=event, **given)


def _report_at(run_file: RunFile) -> tuple[int, float, float] | None:
    """State, value and direction at which orbits are reported."""
    place = run_file.report_at
    if place is None or place.section is None:
        return None
    name, value = place.section
    return run_file.system.state_names.index(name), value, 1.0 if place.direction == "rising" else -1.0


def settings_of(run_file: RunFile) -> Settings:
    """Settings of every walk of a run."""
    engine: dict[str, Any] = {k: v for k, v in run_file.engine.items() if k not in OF_ORBITS}
    if "newton_iterations" in engine:
        engine["newton_iterations"] = int(engine["newton_iterations"])
    return Settings(
        range=run_file.range,
        second_range=None if run_file.second is None else run_file.second[1],
        max_points=run_file.max_points,
        marks=tuple(Mark(m.name, m.values, m.extremum) for m in run_file.marks),
        stop_at=run_file.stop_at,
        events=run_file.events,
        **engine,
    )


def coverage_of(run_file: RunFile) -> Plan:
    """What a run covers."""
    follow = frozenset[str]() if run_file.second is not None else run_file.follow
    directions = {"both": (1.0, -1.0), "forward": (1.0,), "backward": (-1.0,)}[run_file.direction]
    return Plan(
        settings_of(run_file),
        follow,
        run_file.depth,
        directions,
        _parent_of,
        effort=run_file.effort,
        command=command_without_bound(run_file),
    )


def _parent_of(problem: Problem, point: SpecialPoint, settings: Settings) -> Opening | Outcome | None:
    from contwalk.studies.parents import parent_of  # compiled flows

    return parent_of(problem, point, settings)


def all_places(studies: Sequence[Study]) -> list[tuple[RunFile, Place | Start]]:
    """All places that a run starts from, each with its study; their order numbers the starts.

    Curves in two parameters have their starts already.
    """
    return [(own, place) for own, found, _ in studies for place in found]


def start_at(own: RunFile, place: Place | Start) -> Start:
    """The start at a place of a study."""
    if isinstance(place, Start):
        return place
    return next(starts(own, [place], settings_of(own), discretization_of(own)))


def all_starts(studies: Sequence[Study]) -> Iterator[Start]:
    """All starts of a run, each opened when its turn comes."""
    for number, (own, place) in enumerate(all_places(studies)):
        yield replace(start_at(own, place), number=(number,))


def first_tasks(run_file: RunFile, studies: Sequence[Study]) -> list[Task]:
    """What there is to walk of the branches of all starts, both directions by themselves."""
    signs = coverage_of(run_file).directions
    sides = signs if len(signs) > 1 else (None,)
    return [Task((number,), side) for number in range(len(all_places(studies))) for side in sides]
