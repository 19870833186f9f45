"""The special points of a study over accuracies and integrators."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.storage import open_database
from contwalk.verification.checking import checked
from contwalk.verification.finding import Finding
from contwalk.workflow.pairing import counted, paired, value_of
from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.runner import run
from contwalk.workflow.tradeoff.measuring import ACCURACIES, Outcome, Report, every, relative, tighter, tried
from contwalk.workflow.tradeoff.trials import BRANCHES, COLLOCATION, Setting, Tradeoff
from contwalk.workflow.verifying import ranges_of

METHODS = ("dop853", "verner98", "auto")


@one_thread()
def measure(
    run_file: RunFile,
    accuracies: Sequence[float] = ACCURACIES,
    methods: Sequence[str] = METHODS,
    wanted: float | None = None,
    progress: Report | None = None,
) -> Tradeoff:
    """Run a study at every accuracy with every integrator, and compare with a still tighter run.

    Parameters
    ----------
    run_file : RunFile
        Its accuracy, tolerance, method, output and figures are replaced.
    accuracies, methods : sequences
    wanted : float, optional
        The relative error that is allowed; the run file's accuracy by default.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ContwalkError
        For bad input, or if the study fails at the tightest accuracy.
    """
    report = progress or (lambda text: None)
    tight = tighter(accuracies)
    with tempfile.TemporaryDirectory(prefix="contwalk-") as folder:
        output = Path(folder) / "run.h5"
        report(f"the truth: accuracy {tight:g}")
        branches, _, _ = ran(run_file, tight, "auto", output)
        truth = values_of(branches)
        report("the truth, with another integrator")
        checked = _checked(run_file, output, branches, report)

        def once(setting: Setting) -> Outcome:
            return compared(branches, *ran(run_file, setting.accuracy, setting.method, output))

        settings = every(accuracies, methods)
        trials = tried(settings, once, truth, lambda s: f"{s.method}: accuracy {s.accuracy:g}", report)
    doubt = max(
        (relative(c.difference, c.stored) for c in checked if c.recomputed == c.recomputed), default=0.0
    )
    recomputed = ", ".join(dict.fromkeys(c.method for c in checked if c.method))
    sentence = (
        f"Truth: {len(truth)} point{'s' * (len(truth) > 1)} at accuracy {tight:g}, recomputed by "
        f"{recomputed}: they agree to {doubt:.1e}, and smaller errors are not told apart."
    )
    notes = tuple(f"{c.branch}/{c.record}: {c.verdict}, {c.reason}" for c in checked if c.reason)
    allowed = run_file.accuracy if wanted is None else wanted
    sure = not any(c.failed for c in checked)
    return Tradeoff(BRANCHES, allowed, truth, sentence, doubt, trials, notes, sure)


def values_of(branches: Sequence[Branch]) -> dict[str, float]:
    """Name of each special point whose place is a result, with its place.

    Raises
    ------
    ContwalkError
        If there is none.
    """
    found = {
        f"{branch.name}/{point.name}": value_of(point)
        for branch in branches
        for point in branch.special_points
        if counted(point)
    }
    if not found:
        raise ContwalkError(
            "The study has no special point whose place could be more or less accurate.",
            "Take a run file that finds some, such as HB, PD or LP.",
        )
    return found


def compared(truth: Sequence[Branch], branches: Sequence[Branch], seconds: float, work: int) -> Outcome:
    """A run beside the true branches."""
    values, found = values_of(truth), paired(truth, branches)
    errors = {
        name: math.nan if value is None else relative(value - values[name], values[name])
        for name, value in found.values.items()
    }
    return Outcome(seconds, work, errors, tuple(found.extra))


def ran(run_file: RunFile, accuracy: float, method: str, output: Path) -> tuple[list[Branch], float, int]:
    """Branches, CPU seconds and right-hand sides of the study; without a method the file's own is taken."""
    engine = dict(run_file.engine)
    if method:
        engine = {key: value for key, value in engine.items() if key not in ("tolerance", "method")}
        if method != "auto":
            engine.pop("discretization", None)  # it chooses its methods itself
        engine["discretization" if method == COLLOCATION else "method"] = method
    chosen = replace(run_file, accuracy=accuracy, engine=engine, output=output, figures=())
    begun = time.process_time()
    result = run(chosen, force=True, figures=False)
    seconds = time.process_time() - begun
    if result.interrupted:
        raise KeyboardInterrupt
    return result.branches, seconds, sum(int(branch.cost.get("rhs", 0)) for branch in result.branches)


def _checked(run_file: RunFile, output: Path, branches: Sequence[Branch], report: Report) -> list[Finding]:
    """The truth recomputed."""
    with open_database(output) as db:
        header = db.header
    points = [(branch, point) for branch in branches for point in branch.special_points if counted(point)]
    return checked(
        run_file.system,
        points,
        ranges_of(header),
        math.inf,
        progress=lambda c: report(f"the truth, by another integrator: {c.branch}/{c.record}"),
    )
