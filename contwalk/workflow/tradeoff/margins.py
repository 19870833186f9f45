"""The borders of margins over tolerances and integrators."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace

from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.workflow.margin_rays import Ray, Study, row_of, survival_of
from contwalk.workflow.margin_study import check_unpushed, rays_of, study_of
from contwalk.workflow.run_file.margins import MarginsFile
from contwalk.workflow.tradeoff.measuring import (
    ACCURACIES,
    TRUER,
    Outcome,
    Report,
    apart,
    every,
    relative,
    tighter,
    tried,
)
from contwalk.workflow.tradeoff.trials import MARGINS, Setting, Tradeoff

METHODS = ("dop853", "verner98")
# The truth and its check.
TRUE, CHECK = "verner98", "dop853"
LOWEST = 1e-14  # as `margins.tolerance` allows it


@one_thread()
def measure_margins(
    run: MarginsFile,
    tolerances: Sequence[float] = ACCURACIES,
    methods: Sequence[str] = METHODS,
    wanted: float | None = None,
    progress: Report | None = None,
) -> Tradeoff:
    """Find margins at every tolerance with every integrator, and compare with sharper ones.

    Parameters
    ----------
    run : MarginsFile
        Its tolerance and method are replaced.
    tolerances, methods : sequences
    wanted : float, optional
        The error of a border that is allowed, relatively; the section's `accuracy` by default.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ContwalkError
        As `contwalk margins` does, or if no border is met.
    """
    report = progress or (lambda text: None)
    tight = tighter(tolerances, LOWEST)
    study, modes, _ = study_of(run)
    rays, _ = rays_of(run, study, modes)
    check_unpushed(study)
    sharp = TRUER * study.accuracy
    report(f"the truth: tolerance {tight:g}")
    truth, _ = _borders(_at(study, tight, TRUE, sharp), rays)
    if not truth:
        raise ContwalkError("No border is met that could be more or less accurate.", "See farthest.")
    report(f"the truth, by {CHECK}")
    again, _ = _borders(_at(study, tight, CHECK, sharp), rays)
    # A border lies in an interval of the relative width that was asked for.
    lost, doubt = apart(_errors(truth, again), least=sharp)

    def once(setting: Setting) -> Outcome:
        chosen = _at(study, setting.accuracy, setting.method, study.accuracy)
        survival_of(chosen)  # compiled before it is timed
        begun = time.process_time()
        found, work = _borders(chosen, rays)
        seconds = time.process_time() - begun
        extra = tuple(name for name in found if name not in truth)
        return Outcome(seconds, work, _errors(truth, found), extra)

    settings = every(tolerances, methods)
    trials = tried(settings, once, truth, lambda s: f"{s.method}: tolerance {s.accuracy:g}", report)
    sentence = (
        f"Truth: {len(truth)} border{'s' * (len(truth) > 1)} to {sharp:g} by {TRUE} at tolerance {tight:g}, "
        f"found again by {CHECK}: they agree to {doubt:.1e}, and smaller errors are not told apart."
    )
    notes = tuple(f"{CHECK} does not find the border of {name} again" for name in lost)
    allowed = run.margins.accuracy if wanted is None else wanted
    return Tradeoff(MARGINS, allowed, truth, sentence, doubt, trials, notes, not lost)


def _at(study: Study, tolerance: float, method: str, accuracy: float) -> Study:
    rule = replace(study.rule, tolerance=tolerance, method=method)
    return replace(study, rule=rule, accuracy=accuracy)


def _borders(study: Study, rays: Sequence[Ray]) -> tuple[dict[str, float], int]:
    """The innermost border of each ray on which one was met, by the ray's name; and simulations in all."""
    rows = [row_of(study, ray) for ray in rays]
    found = {
        f"{row['state']}{'+' if row['sign'] > 0 else '-'} at {row['instant']}": float(row["border"])
        for row in rows
        if row["border"] is not None
    }
    return found, sum(int(row["simulations"]) for row in rows)


def _errors(truth: dict[str, float], found: dict[str, float]) -> dict[str, float]:
    return {name: relative(found.get(name, math.nan) - value, value) for name, value in truth.items()}
