"""`contwalk tradeoff`: a study over accuracies and integrators, timed and compared with the truth."""

from __future__ import annotations

import csv
import math
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.storage import open_database
from contwalk.storage.failures import check_writable, failures_of, refuse_existing
from contwalk.studies.comparison import Comparison
from contwalk.workflow.file_names import beside
from contwalk.workflow.pairing import counted, paired, value_of
from contwalk.workflow.run_file.names import LOWEST_ACCURACY
from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.runner import run
from contwalk.workflow.verifying import points_of, verify

ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10)
METHODS = ("dop853", "verner98", "auto")
COLLOCATION = "collocation"
# Runs shorter than this (s) are timed three times, and the shortest time counts.
BRIEF, REPEATS = 5.0, 3
# Times that differ by no more than this factor are equal.
ALIKE = 1.1
# The truth is asked to be so much better than the best of the runs.
TRUER = 1e-2


@dataclass(frozen=True)
class Trial:
    """One run of the study.

    Parameters
    ----------
    accuracy, method : float, str
        What was asked.
    seconds : float
        CPU time of the run in this process, compilation not included.
    rhs : int
        Evaluations of the vector field.
    errors : mapping
        True relative error by the name of the point; NaN where it was not found.
    extra : tuple of str
        Points that the truth does not have.
    failed : str
        Why there is no result, or nothing.
    """

    accuracy: float
    method: str
    seconds: float = math.nan
    rhs: int = 0
    errors: Mapping[str, float] = field(default_factory=dict)
    extra: tuple[str, ...] = ()
    failed: str = ""

    @property
    def found(self) -> int:
        """Points that were found."""
        return sum(not math.isnan(error) for error in self.errors.values())

    @property
    def missing(self) -> tuple[str, ...]:
        """Points that were not."""
        return tuple(name for name, error in self.errors.items() if math.isnan(error))

    @property
    def worst(self) -> float:
        """Largest true relative error of the points that were found."""
        return max((e for e in self.errors.values() if not math.isnan(e)), default=math.nan)

    @property
    def held(self) -> bool:
        """Whether the accuracy asked for was met, at every point that there is."""
        return self.meets(self.accuracy)

    def meets(self, accuracy: float) -> bool:
        """Whether every point was found, to this relative accuracy."""
        return not self.failed and not self.missing and not self.extra and not self.worst > accuracy


@dataclass(frozen=True)
class Tradeoff:
    """All trials with what they were compared with.

    Parameters
    ----------
    wanted : float
        The run file's own accuracy.
    truth : mapping
        Name of each point to its true value.
    truth_accuracy : float
        What the run for the truth was asked.
    checked : list of Comparison
        The truth recomputed with another integrator.
    doubt : float
        The largest relative difference of the two: errors below it are not told apart.
    trials : list of Trial
    """

    wanted: float
    truth: dict[str, float]
    truth_accuracy: float
    checked: list[Comparison]
    doubt: float
    trials: list[Trial]

    @property
    def best(self) -> Trial | None:
        """The cheapest trial that met the run file's accuracy."""
        good = [trial for trial in self.trials if trial.meets(self.wanted)]
        if not good:
            return None
        least = min(trial.seconds for trial in good)
        # Times this near to each other are equal; the promise then decides.
        return min((t for t in good if t.seconds <= ALIKE * least), key=lambda t: (t.accuracy, t.seconds))

    @property
    def recommendation(self) -> str:
        """What to set, in a sentence."""
        best = self.best
        if best is None:
            return f"No setting met the accuracy of {self.wanted:g} that the run file asks for."
        ((key, value),) = setting_of(best.method).items()
        given = f"accuracy: {best.accuracy:g} with engine: {{{key}: {value}}}"
        kept = next((t for t in self.trials if t.accuracy == self.wanted and t.method == best.method), None)
        text = (
            f"The cheapest setting that met the run file's accuracy of {self.wanted:g} is {given}: "
            f"{best.seconds:.2g} s, and every point to {max(best.worst, self.doubt):.1e} at least."
        )
        if best.accuracy > self.wanted and kept is not None and kept.held:
            text += (
                f" It promises {best.accuracy:g} only; accuracy: {self.wanted:g} keeps its promise for "
                f"{kept.seconds:.2g} s."
            )
        return text


@one_thread()
def measure(
    run_file: RunFile,
    accuracies: Sequence[float] = ACCURACIES,
    methods: Sequence[str] = METHODS,
    progress: Callable[[str], None] | None = None,
) -> Tradeoff:
    """Run a study at every accuracy with every integrator, and compare with a still tighter run.

    Parameters
    ----------
    run_file : RunFile
        Its accuracy, tolerance, method, output and figures are replaced.
    accuracies, methods : sequences
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ContwalkError
        For bad input, or if the study fails at the tightest accuracy.
    """
    report = progress or (lambda text: None)
    _check(accuracies)
    tight = max(TRUER * min(accuracies), LOWEST_ACCURACY)
    with tempfile.TemporaryDirectory(prefix="contwalk-") as folder:
        output = Path(folder) / "run.h5"
        report(f"the truth: accuracy {tight:g}")
        branches, _, _ = _ran(run_file, tight, "auto", output)
        truth = {
            f"{branch.name}/{point.name}": value_of(point)
            for branch in branches
            for point in branch.special_points
            if counted(point)
        }
        if not truth:
            raise ContwalkError(
                "The study has no special point whose place could be more or less accurate.",
                "Take a run file that finds some, such as HB, PD or LP.",
            )
        report("the truth, with another integrator")
        checked = _checked(run_file, output, branches, report)
        trials = []
        for method in methods:
            report(f"{method}: compiling")
            _tried(run_file, max(accuracies), method, output, branches, truth, timed=False)
            for accuracy in sorted(accuracies, reverse=True):
                report(f"{method}: accuracy {accuracy:g}")
                trials.append(_tried(run_file, accuracy, method, output, branches, truth))
    doubt = max(
        (_relative(c.difference, c.stored) for c in checked if c.recomputed == c.recomputed), default=0.0
    )
    return Tradeoff(run_file.accuracy, truth, tight, checked, doubt, trials)


def _check(accuracies: Sequence[float]) -> None:
    for accuracy in accuracies:
        if not LOWEST_ACCURACY <= accuracy <= 0.5:
            raise ContwalkError(
                f"The accuracy {accuracy:g} is not possible.",
                f"Allowed: numbers from {LOWEST_ACCURACY:g} to 0.5.",
            )


def _ran(run_file: RunFile, accuracy: float, method: str, output: Path) -> tuple[list[Branch], float, int]:
    """Branches, CPU seconds and right-hand sides of the study at these settings."""
    engine = {key: value for key, value in run_file.engine.items() if key not in ("tolerance", "method")}
    if method != "auto":
        engine.pop("discretization", None)  # it chooses its methods itself
    engine |= setting_of(method)
    chosen = replace(run_file, accuracy=accuracy, engine=engine, output=output, figures=())
    begun = time.process_time()
    result = run(chosen, force=True, figures=False)
    seconds = time.process_time() - begun
    if result.interrupted:
        raise KeyboardInterrupt
    return result.branches, seconds, sum(int(branch.cost.get("rhs", 0)) for branch in result.branches)


def setting_of(method: str) -> dict[str, str]:
    """What the engine is asked for: an integrator, or collocation, which is a discretisation with its own."""
    return {"discretization" if method == COLLOCATION else "method": method}


def _checked(
    run_file: RunFile, output: Path, branches: Sequence[Branch], report: Callable[[str], None]
) -> list[Comparison]:
    """The truth recomputed."""
    with open_database(output) as db:
        header = db.header
    points = [(branch, point) for branch, point in points_of(branches) if counted(point)]
    return verify(
        run_file.system,
        header,
        points,
        progress=lambda c: report(f"the truth, with another integrator: {c.branch}/{c.point}"),
    )


def _tried(
    run_file: RunFile,
    accuracy: float,
    method: str,
    output: Path,
    true_branches: Sequence[Branch],
    truth: Mapping[str, float],
    timed: bool = True,
) -> Trial:
    try:
        branches, seconds, rhs = _ran(run_file, accuracy, method, output)
        for _ in range(REPEATS - 1 if timed and seconds < BRIEF else 0):
            seconds = min(seconds, _ran(run_file, accuracy, method, output)[1])
    except ContwalkError as error:
        return Trial(accuracy, method, errors=dict.fromkeys(truth, math.nan), failed=str(error))
    found = paired(true_branches, branches)
    errors = {
        name: math.nan if value is None else _relative(value - truth[name], truth[name])
        for name, value in found.values.items()
    }
    return Trial(accuracy, method, seconds, rhs, errors, tuple(found.extra))


def _relative(difference: float, value: float) -> float:
    """A difference relative to a value; absolute where that is zero."""
    return abs(difference) / abs(value) if value != 0.0 else abs(difference)


def names_of_files(run_file: RunFile) -> tuple[Path, Path]:
    """Table and figure, beside the run's output."""
    return beside(run_file.output, "tradeoff.csv"), beside(run_file.output, "tradeoff.png")


def write(run_file: RunFile, found: Tradeoff, figure: bool = True) -> list[Path]:
    """Write the table, and the figure."""
    from contwalk import plotting

    table, picture = names_of_files(run_file)
    names = list(found.truth)
    head = [
        "accuracy",
        "method",
        "cpu_seconds",
        "rhs",
        "worst_error",
        "promise_held",
        "found",
        "missing",
        "extra",
    ]
    with failures_of(table, "create"), table.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow([*head, *[f"error {name}" for name in names]])
        for t in found.trials:
            row = [repr(t.accuracy), t.method, f"{t.seconds:.4f}", t.rhs, f"{t.worst:.3e}", t.held, t.found]
            row += [" ".join(t.missing), " ".join(t.extra)]
            writer.writerow([*row, *[f"{t.errors[name]:.3e}" for name in names]])
    timed = [trial for trial in found.trials if trial.seconds > 0.0]
    if not figure or not timed:
        return [table]
    methods = list(dict.fromkeys(trial.method for trial in timed))
    panels = {
        method: {name: [(t.seconds, t.errors[name]) for t in timed if t.method == method] for name in names}
        for method in methods
    }
    asked = {method: [(t.seconds, t.accuracy) for t in timed if t.method == method] for method in methods}
    axes = plotting.plot_tradeoff_panels(panels, asked, doubt=found.doubt)
    plotting.save(axes[0], picture)
    return [table, picture]


def refuse_existing_files(run_file: RunFile, force: bool, figure: bool) -> None:
    """Refuse to replace results, and a folder that takes none, before anything is computed."""
    table, picture = names_of_files(run_file)
    check_writable(table)
    refuse_existing([table, picture] if figure else [table], force)
