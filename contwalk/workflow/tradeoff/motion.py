"""The end of a motion, and the instants of its last events, over tolerances and integrators."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.errors import RunFileError
from contwalk.numerics.threads import one_thread
from contwalk.workflow.run_file.motions import Simulation
from contwalk.workflow.run_file.simulate import SimulationFile
from contwalk.workflow.simulated import Simulated
from contwalk.workflow.simulating import moved
from contwalk.workflow.tradeoff.measuring import ACCURACIES, Outcome, Report, apart, every, tighter, tried
from contwalk.workflow.tradeoff.trials import MOTION, Setting, Tradeoff

METHODS = ("dop853", "verner98", "radau5", "radau9")
# The truth and its check: an explicit and an implicit method of high order, each with code of its own.
TRUE, CHECK = "verner98", "radau9"
LOWEST = 1e-14  # as `simulate.tolerance` allows it


@one_thread()
def measure_motion(
    run: SimulationFile,
    tolerances: Sequence[float] = ACCURACIES,
    methods: Sequence[str] = METHODS,
    wanted: float | None = None,
    progress: Report | None = None,
) -> Tradeoff:
    """Compute a motion at every tolerance with every integrator, and compare with a still tighter one.

    Parameters
    ----------
    run : SimulationFile
        Its tolerance and method are replaced.
    tolerances, methods : sequences
    wanted : float, optional
        The error that is allowed, relative to the magnitudes of the states along the motion, and of instants
        to its length; the run file's accuracy by default.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ContwalkError
        If the motion has no given end.
    """
    report = progress or (lambda text: None)
    if run.simulation.until == "settled":
        raise RunFileError(
            f"{run.path}: simulate.until is settled, so that the motion has no end that could be compared.",
            "Give a length of time: --set simulate.until=20.",
        )
    tight = tighter(tolerances, LOWEST)
    report(f"the truth: tolerance {tight:g}")
    motion, _ = _moved(run, tight, TRUE)
    truth = _quantities(run, motion)
    scales = _scales(run, motion)
    report(f"the truth, by {CHECK}")
    again, _ = _moved(run, tight, CHECK)
    lost, doubt = apart(_errors(truth, _quantities(run, again), scales))

    def once(setting: Setting) -> Outcome:
        found, seconds = _moved(run, setting.accuracy, setting.method)
        quantities = _quantities(run, found)
        extra = tuple(name for name in quantities if name not in truth)
        return Outcome(seconds, found.evaluations, _errors(truth, quantities, scales), extra)

    settings = every(tolerances, methods)
    trials = tried(settings, once, truth, lambda s: f"{s.method}: tolerance {s.accuracy:g}", report)
    allowed = run.accuracy if wanted is None else wanted
    sentence = (
        f"Truth: the motion by {TRUE} at tolerance {tight:g}, recomputed by {CHECK}: they agree to "
        f"{doubt:.1e} of the states' magnitudes, and smaller errors are not told apart."
    )
    notes = [f"{CHECK} does not find {name} again: the motion is not known" for name in lost]
    if doubt > allowed:
        notes.append(f"The motion is not known to the accuracy of {allowed:g}: give a shorter time")
    return Tradeoff(MOTION, allowed, truth, sentence, doubt, trials, tuple(notes), not notes)


def _moved(run: SimulationFile, tolerance: float, method: str) -> tuple[Simulated, float]:
    """The motion, and CPU seconds."""
    section = Simulation(**{**run.simulation.model_dump(), "tolerance": tolerance, "method": method})
    begun = time.process_time()
    motion = moved(replace(run, simulation=section))
    return motion, time.process_time() - begun


def _quantities(run: SimulationFile, motion: Simulated) -> dict[str, float]:
    """The state at the end, when that is, and the instant of the last event of each name with its number."""
    found = dict(zip(run.system.state_names, motion.values[-1].tolist(), strict=True))
    counts: Counter[str] = Counter()
    last: dict[str, float] = {}
    for event in motion.events:
        counts[event.name] += 1
        last[event.name] = event.time
    found |= {f"time of {name} {counts[name]}": at for name, at in last.items()}
    return found | {f"time of the end ({motion.status})": float(motion.times[-1])}


def _scales(run: SimulationFile, motion: Simulated) -> dict[str, float]:
    """Magnitudes of the states along the motion, 1 for one that is zero; for instants its length."""
    sizes = np.nanmax(np.abs(motion.values), axis=0)
    named = zip(run.system.state_names, np.where(sizes > 0.0, sizes, 1.0).tolist(), strict=True)
    return {**dict(named), "": float(motion.times[-1] - motion.times[0]) or 1.0}


def _errors(truth: dict[str, float], found: dict[str, float], scales: dict[str, float]) -> dict[str, float]:
    return {
        name: abs(found.get(name, math.nan) - value) / scales.get(name, scales[""])
        for name, value in truth.items()
    }
