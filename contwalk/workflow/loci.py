"""Curves in two parameters: from a point of another database, or from all special points of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from contwalk.branch import Branch, SpecialPoint
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.events import Plan
from contwalk.diagram.opening import Opening
from contwalk.errors import StartError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.unbegun import unbegun
from contwalk.storage import open_database
from contwalk.studies.loci import opened_locus
from contwalk.workflow.going_on import command_without_bound
from contwalk.workflow.run_file.reading import RunFile, StartSpec
from contwalk.workflow.stored.points import branch_of, place_of


def from_databases(run_file: RunFile, settings: Settings, discretization: Discretization) -> list[Start]:
    """The starts of a run along two parameters, each a special point of another database.

    Raises
    ------
    StartError
        If a point is none that curves are followed from, or lies outside the ranges.
    """
    assert run_file.second is not None
    found = []
    for spec in run_file.starts:
        with spec.errors_placed():
            branch, point = _stored(run_file, spec)
            given = _Given(run_file, settings, discretization, (run_file.free, run_file.second[0]))
            origin = f"{spec.point} of {spec.file.name}" if spec.file else ""
            found.append(_start(given, branch, point, origin))
    return found


def from_branches(
    run_file: RunFile,
    branches: Sequence[Branch],
    settings: Settings,
    discretization: Discretization,
    note: Callable[[str, str], None],
) -> Iterator[Start]:
    """Starts at all special points of a study that it asks for, in the order of branches and points.

    `note` is given a key and a sentence for a point that no curve can be followed from.
    """
    assert run_file.loci is not None
    settings = replace(settings, second_range=run_file.loci.range)
    given = _Given(run_file, settings, discretization, (run_file.free, run_file.loci.second))
    low, high = run_file.loci.range
    for branch in branches:
        if branch.info.problem == "locus":
            continue
        for point in branch.special_points:
            wanted = point.label in run_file.loci.of and point.status == "located"
            if not wanted or "pairs" in point.coefficients:
                continue
            if not low <= point.parameters[run_file.loci.second] <= high:
                continue
            origin = f"{branch.name}/{point.name}"
            try:
                start = _start(given, branch, point, origin)
            except StartError as error:
                note(f"no curve from {origin}", f"{branch.name}: {error.sentence}")
                continue
            yield replace(start, parent=(branch.name, point.s), depth=1)


def coverage_of(run_file: RunFile, settings: Settings) -> Plan:
    """What is followed of the curves of a study."""
    assert run_file.loci is not None
    ranged = replace(settings, second_range=run_file.loci.range)
    return Plan(
        ranged,
        run_file.loci.follow,
        run_file.depth,
        by_generation=True,
        effort=run_file.effort,
        command=command_without_bound(run_file),
    )


class _Given:
    """What all curves of a run share."""

    def __init__(
        self, run_file: RunFile, settings: Settings, discretization: Any, free: tuple[str, str]
    ) -> None:
        self.system, self.settings, self.discretization, self.free = (
            run_file.system,
            settings,
            discretization,
            free,
        )


def _start(given: _Given, branch: Branch, point: SpecialPoint, origin: str) -> Start:
    opening = opened_locus(given.system, branch, point, given.free, given.settings, given.discretization)
    known = {name: float(point.parameters[name]) for name in given.system.parameter_names}
    would_be = {} if isinstance(opening, Opening) else unbegun(point.label, given.free, branch.info.problem)
    return Start(given.system, given.free[0], known, opening, origin, would_be=would_be)


def _stored(run_file: RunFile, spec: StartSpec) -> tuple[Branch, SpecialPoint]:
    """The special point of another database that a start names, and its branch."""
    assert spec.file is not None
    with open_database(spec.file) as db:
        branch = branch_of(db, spec.file, str(spec.point), run_file.system)
        place = place_of(branch, spec.file, str(spec.point))
    if isinstance(place, int):
        raise StartError(
            f"{spec.point} is no special point, and a curve in two parameters is one of special points.",
            "Give the name of a special point, as b1/HB1.",
        )
    return branch, place
