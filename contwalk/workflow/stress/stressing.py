"""`contwalk systems stress`: a study under each change, laid beside what it finds as it is."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from contwalk.comparing.databases import Comparison, diff
from contwalk.comparing.difference import BRANCH, END, KIND, POINT, ROWS, VALUE, Difference
from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.storage import open_database
from contwalk.storage.database import Database
from contwalk.workflow.run_file.reading import RunFile, read_run_file, read_run_text
from contwalk.workflow.runner import run
from contwalk.workflow.stress.cases import Case, cases_of
from contwalk.workflow.stress.own_units import in_own_units
from contwalk.workflow.stress.rescaled_run import rescaled_run

SAME, DIFFERS, REFUSED = "same", "differs", "refused"


@dataclass(frozen=True)
class Result:
    """What came of one change.

    Parameters
    ----------
    case : str
        The change in words.
    verdict : str
        `SAME`, `DIFFERS`, or `REFUSED` where the study says that it cannot be computed so.
    sentences : tuple of str
        What differs beyond the errors that both claim, or why it is refused.
    points : int
        Located special points.
    seconds : float
        CPU time, compilation included.
    """

    case: str
    verdict: str
    sentences: tuple[str, ...]
    points: int
    seconds: float


@dataclass(frozen=True)
class Stress:
    """A study under all changes; the first result is the study as it is.

    Parameters
    ----------
    system : str
    results : tuple of Result
    """

    system: str
    results: tuple[Result, ...]

    @property
    def same(self) -> bool:
        """Whether nothing differs; what is refused says so and does not."""
        return all(result.verdict != DIFFERS for result in self.results)


def run_to_stress(reference: str, model: dict[str, object] | None = None) -> RunFile:
    """The run file that is named, or the one that `contwalk init` would write for what is named."""
    if reference.endswith((".yaml", ".yml")):
        return read_run_file(reference)
    from contwalk.system import load_system
    from contwalk.workflow.run_file.template import starting_file

    return read_run_text(
        starting_file(load_system(reference, model), reference), Path(f"{reference}.yaml").name
    )


@one_thread()
def stressed(run_file: RunFile, progress: Callable[[Result], None] | None = None) -> Stress:
    """Run a study as it is and under each change, and compare what is found.

    Parameters
    ----------
    run_file : RunFile
        Its output and figures are left alone.
    progress : callable, optional
        Gets each result when it is there.

    Raises
    ------
    ContwalkError
        If the study fails as it is.
    """
    results: list[Result] = []

    def tell(result: Result) -> None:
        results.append(result)
        if progress is not None:
            progress(result)

    with TemporaryDirectory(prefix="contwalk-") as folder:
        first = Path(folder) / "as_it_is.h5"
        seconds = _computed(run_file, first)
        with open_database(first) as reference:
            _check_found(reference)
            tell(Result("as it is", SAME, (), _located(reference), seconds))
            for case in cases_of(run_file.system):
                tell(_result(run_file, case, reference, Path(folder) / "changed.h5"))
    return Stress(run_file.system.name, tuple(results))


def _check_found(database: Database) -> None:
    """Refuse a study that finds nothing as it is."""
    branches = database.branches()
    if not any(len(branch) for branch in branches):
        said = branches[0].outcome.message if branches else "It has no branch."
        raise ContwalkError(
            f"The study finds nothing as it is: {said}", "Give a run file with another start."
        )


def _result(run_file: RunFile, case: Case, reference: Database, output: Path) -> Result:
    begun = time.process_time()
    try:
        changed = run_file if case.accuracy is not None else rescaled_run(run_file, case.units)
        changed = replace(changed, accuracy=case.accuracy or run_file.accuracy)
        seconds = _computed(changed, output)
    except ContwalkError as error:
        return Result(case.name, REFUSED, (str(error),), 0, time.process_time() - begun)
    with open_database(output) as found, in_own_units(found, case.units) as own:
        compared = diff(reference, own)
        points = _located(found)
        failed = [
            f"{branch.name}: {branch.outcome.message}"
            for branch in found.branches()
            if branch.outcome.status == "failed"
        ]
        said = _said(compared, reference, own)
    if not said:
        return Result(case.name, SAME, (), points, seconds)
    return Result(case.name, DIFFERS, (*said, *failed), points, seconds)


def _said(compared: Comparison, a: Database, b: Database) -> list[str]:
    """What differs: branches and points that only one has come before numbers.

    Rows between special points stand elsewhere in other units and at other accuracies; how well a curve is
    known between two of them is no result. Neither is how near a branch has come to a limit that no equations
    locate, as a homoclinic orbit, where both end for the same reason.
    """
    order = (BRANCH, POINT, KIND, END)
    places = {what: k for k, what in enumerate(order)}
    differences = [*compared.differences]
    for family in compared.branches:
        alike = _reasons(a, family.a) == _reasons(b, family.b)
        differences += [each for each in family.differences if not (alike and _end_on_the_way(each, a, b))]
    differences = [each for each in differences if not _of_rows(each)]
    return [each.text for each in sorted(differences, key=lambda each: places.get(each.what, len(order)))]


def _reasons(database: Database, names: tuple[str, ...]) -> set[tuple[str, str]]:
    outcomes = [database.branch(name).outcome for name in names]
    return {(outcome.status, outcome.reason) for outcome in outcomes}


def _end_on_the_way(difference: Difference, a: Database, b: Database) -> bool:
    """Whether it is of an end at a place where no equations hold but the branch's own."""
    if difference.what != END:
        return False
    database, (branch, _, point) = (
        (a, difference.a.partition("/")) if difference.a else (b, difference.b.partition("/"))
    )
    return bool(point) and database.branch(branch).special(point).kind != "bound"


def _of_rows(difference: Difference) -> bool:
    return difference.what == ROWS or (difference.what == VALUE and "/" not in difference.a + difference.b)


def _computed(run_file: RunFile, output: Path) -> float:
    """Computes a study; CPU seconds."""
    begun = time.process_time()
    if run(replace(run_file, output=output, figures=()), force=True, figures=False).interrupted:
        raise KeyboardInterrupt
    return time.process_time() - begun


def _located(database: Database) -> int:
    return sum(
        point.status == "located" and point.label != "EP"
        for branch in database.branches()
        for point in branch.special_points
    )
