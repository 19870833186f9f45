"""`contwalk verify X_margins.h5`: what was pushed, and what surviving meant, read from where it stands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.storage import open_database
from contwalk.storage.stored_system import StoredSystem, system_of_run
from contwalk.storage.trajectory import Margins, read_margins
from contwalk.studies.margins.solution import TOGETHER
from contwalk.studies.margins.survival import LAPS, MANY
from contwalk.system import System
from contwalk.verification import budget
from contwalk.verification.equations import along_pins
from contwalk.verification.finding import Finding
from contwalk.verification.functions import Functions, Parameters
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.pushed import checked_basin, checked_rays, sampled
from contwalk.verification.pushing import Pushing, Rule, Twice
from contwalk.verification.records import equations_of
from contwalk.workflow.basin import SETTLING
from contwalk.workflow.file_names import database_named
from contwalk.workflow.margin_study import LEAST_TOLERANCE, PERIODS, RETURNS, SHARE, TOLERANCE
from contwalk.workflow.run_file.kept_form import form_of
from contwalk.workflow.run_file.motions import Margins as Section
from contwalk.workflow.stored.points import branch_of, place_of


@dataclass(frozen=True)
class StoredMargins:
    """A file of margins, the section of its run file, and the system once it may run."""

    path: Path
    margins: Margins
    section: Section
    system: System


def stored_margins(path: str, trust: bool) -> tuple[StoredMargins, str]:
    """What a file of margins holds, and a sentence where its system has changed since.

    Raises
    ------
    ContwalkError
        If the file, or its system, cannot be read.
    """
    margins, place = read_margins(path), Path(path)
    header: Any = margins.header
    stored: StoredSystem = system_of_run(
        header["provenance"], header.get("model", {}), margins.system, place, trust
    )
    _, model = form_of(str(header["config"]), str(path), tuple(header.get("overrides", ())))
    if model.margins is None:
        raise ContwalkError(f"The run file stored in {path} asks for no margins.", "Compute them again.")
    return StoredMargins(place, margins, model.margins, stored.system), stored.changed


def records_of(stored: StoredMargins) -> dict[str, int]:
    """How many numbers of a file are recomputed, by the name of what they are of."""
    rays, places = len(stored.margins.rows), len(stored.margins.basin.get("labels", ()))
    parts = {"margins": rays, "basin": len(sampled(places))}
    return {name: count for name, count in parts.items() if count}


@one_thread()
def verified_margins(
    stored: StoredMargins, part: str, seconds: float, progress: Callable[[Finding], None] | None = None
) -> list[Finding]:
    """The rays and every tenth place of the plane, pushed once more within so many seconds of CPU.

    Raises
    ------
    ContwalkError
        If the database of the solution that was pushed is not there, or holds another one.
    """
    margins, wanted, found = stored.margins, stored.section, list[Finding]()
    file = _database(stored)
    with open_database(file) as database, budget.within(seconds):
        branch = branch_of(database, file, wanted.of.point, stored.system)
        begin = _Begin(stored, branch, place_of(branch, file, wanted.of.point))
        begin.check(file)
        rule = begin.rule()
        instants = range(len(margins.instants))
        needed = {int(row["instant"]) for row in margins.rows}
        needed |= {wanted.basin.instant} if margins.basin and wanted.basin is not None else set()
        both = {k: begin.twice(rule, margins.instants[k]) for k in instants if k in needed}
        with np.errstate(all="ignore"):  # what is not finite shows in what comes out
            each = checked_rays(both, margins.rows if part != "basin" else (), rule)
            for finding in each:
                found.append(finding)
                if progress is not None:
                    progress(finding)
            if not margins.basin or wanted.basin is None or part == "margins":
                return found
            others = {}
            for name in sorted(set(margins.basin["labels"]) - {wanted.of.point}):
                if "/" in name:
                    other = branch_of(database, file, name, stored.system)
                    beside = _Begin(stored, other, place_of(other, file, name))
                    others[name] = beside.twice(beside.rule(), beside.instant())
            for finding in checked_basin(both[wanted.basin.instant], margins.basin, wanted.of.point, others):
                found.append(finding)
                if progress is not None:
                    progress(finding)
    return found


def _database(stored: StoredMargins) -> Path:
    """The database of the solution: beside the margins, or where the run file was."""
    name = str(stored.section.of.from_)
    places = [database_named(stored.path.parent, name)]
    run = stored.margins.header.get("provenance", {}).get("run_file_directory")
    places += [] if run is None else [Path(str(run)) / name]
    for place in places:
        if place.exists():
            return place
    raise ContwalkError(
        f"The solution that {stored.path} pushes is in {name}, which is not there.",
        f"Put it beside {stored.path}, or compute it again: contwalk continue.",
    )


@dataclass(frozen=True)
class _Begin:
    """A stored solution that motions set out from."""

    stored: StoredMargins
    branch: Branch
    place: SpecialPoint | int

    def check(self, file: Path) -> None:
        """Refuse another solution than the one that was pushed."""
        values, own = self.stored.margins.header["parameters"], self._parameters()
        if any(own.get(name, value) != value for name, value in values.items()):
            raise ContwalkError(
                f"{self.stored.section.of.point} of {file} has other parameters than what was pushed.",
                "The database has been computed again since: compute the margins again as well.",
            )

    def _parameters(self) -> dict[str, float]:
        if isinstance(self.place, int):
            return dict(self.branch.parameters_at(self.place))
        return dict(self.place.parameters)

    def instant(self) -> dict[str, Any]:
        """Time, mode and state, (N,), at which the stored solution begins."""
        equations = equations_of(self.stored.system, self.branch, self.place)
        state = np.zeros(len(self.branch.info.states))
        if isinstance(equations, OrbitEquations):
            mode, start = equations.legs[0][0], equations.z[equations.size - 1]
            state[list(self.stored.system.states_of(mode))] = equations.first[0]
            return {"time": float(start), "mode": mode, "state": state}
        mode = str(self.branch.info.settings.get("mode") or self.stored.system.modes[0].name)
        state[list(self.stored.system.states_of(mode))] = equations.z[: equations.size]
        return {"time": 0.0, "mode": mode, "state": state}

    def rule(self) -> Rule:
        """What surviving meant, as the run file asks for it."""
        wanted, system = self.stored.section, self.stored.system
        survive, place = wanted.survive, self.place
        fold = int(self.branch.info.settings.get("fold", 1))
        own = self.branch["period"][place] if isinstance(place, int) else place.period
        period = np.nan if own is None or self.branch.info.problem == "equilibrium" else fold * float(own)
        duration = survive.time if survive.time is not None else (survive.periods or PERIODS) * period
        eventful = self.branch.info.problem == "hybrid_orbit"
        sequence = survive.sequence == "kept" and eventful
        judged = system.fallen is not None or sequence
        returns = survive.returns if survive.returns is not None else None if judged else RETURNS
        tolerance = wanted.tolerance or max(min(TOLERANCE, SHARE * wanted.accuracy), LEAST_TOLERANCE)
        instant = self.instant()
        mode = str(instant["mode"])
        x = np.array(instant["state"])[list(system.states_of(mode))]
        functions, p = self._functions()
        held = [direction for direction, _ in along_pins(functions, self.branch.info, mode, x, p)]
        alone = [int(np.flatnonzero(v)[0]) for v in held if np.count_nonzero(v) == 1]
        return Rule(
            duration=float(duration),
            period=period,
            sequence=sequence,
            returns=returns,
            near=survive.returns or RETURNS,
            tolerance=tolerance,
            accuracy=wanted.accuracy,
            neutral=tuple(system.states_of(mode)[k] for k in alone),
            most=MANY,
            together=TOGETHER,
            laps=LAPS,
            settling=SETTLING,
        )

    def _functions(self) -> tuple[Functions, np.ndarray]:
        """The machine's functions, and its parameters, shape (p,)."""
        settings = {key: value for key, value in self.branch.info.settings.items() if key != "path"}
        values = {**self.stored.system.defaults(), **self.stored.margins.header["parameters"]}
        info = replace(self.branch.info, free=(), parameters=values, settings=settings)
        functions = Functions(self.stored.system, Parameters(self.stored.system, info))
        return functions, functions.parameters.at(np.zeros(0))

    def twice(self, rule: Rule, instant: Any) -> Twice:
        """Pushes of an instant, by two tolerances."""
        functions, p = self._functions()
        return Twice(lambda relative: Pushing(functions, p, rule, instant, relative), rule.tolerance)
