"""The special points of a study for several models: what is left out, beside what it saves."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from contwalk.numerics.threads import one_thread
from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.tradeoff.branches import compared, ran, values_of
from contwalk.workflow.tradeoff.measuring import Outcome, Report, relative, tried
from contwalk.workflow.tradeoff.trials import MODELS, Setting, Tradeoff

WITHIN = 0.01  # of a point's place: how far a model may move it, where nobody says


@one_thread()
def measure_models(
    run_file: RunFile,
    variants: Sequence[tuple[str, RunFile]],
    wanted: float | None = None,
    progress: Report | None = None,
) -> Tradeoff:
    """Run a study with its own model and with others, and compare their special points.

    Parameters
    ----------
    run_file : RunFile
    variants : sequence of (str, RunFile)
        Model choices as they were written, and the run file with them.
    wanted : float, optional
        How far the points may move, relatively; 0.01 by default.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ContwalkError
        If the study finds nothing with its own model.
    """
    report = progress or (lambda text: None)
    files = {"": run_file, **dict(variants)}
    with tempfile.TemporaryDirectory(prefix="contwalk-") as folder:
        output = Path(folder) / "run.h5"
        report("the run file's own model")
        branches, _, _ = ran(run_file, run_file.accuracy, "", output)
        truth = values_of(branches)

        def once(setting: Setting) -> Outcome:
            file = files[setting.model]
            return compared(branches, *ran(file, file.accuracy, "", output))

        settings = [Setting(file.accuracy, "", model) for model, file in files.items()]
        trials = tried(settings, once, truth, lambda s: s.model or "the run file's own model", report)
    errors = [
        relative(point.error or 0.0, truth[f"{branch.name}/{point.name}"])
        for branch in branches
        for point in branch.special_points
        if f"{branch.name}/{point.name}" in truth
    ]
    sentence = (
        "Errors are differences from the points of the run file's own model, the first one, which are known "
        f"to {max(errors):.1e}."
    )
    return Tradeoff(MODELS, WITHIN if wanted is None else wanted, truth, sentence, max(errors), trials)
