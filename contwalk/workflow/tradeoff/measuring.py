"""Settings run and timed in turns, so that what else the machine does reaches all of them alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from contwalk.errors import ContwalkError
from contwalk.workflow.run_file.names import LOWEST_ACCURACY
from contwalk.workflow.tradeoff.trials import Setting, Trial

ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10)
# The truth is asked to be so much better than the best of the runs.
TRUER = 1e-2
# Runs are timed so many times, or fewer where they take longer than so many seconds. Of two settings that are
# alike three times each lie apart by more than both ranges in one or two of a hundred cases.
REPEATS, LEAST, BRIEF = 5, 3, 5.0

Report = Callable[[str], None]


@dataclass(frozen=True)
class Outcome:
    """One run of a setting: CPU seconds, work, errors by name (NaN: not found), and what does not exist."""

    seconds: float
    work: int
    errors: Mapping[str, float] = field(default_factory=dict)
    extra: tuple[str, ...] = ()


def tried(
    settings: Sequence[Setting],
    run: Callable[[Setting], Outcome],
    names: Iterable[str],
    in_words: Callable[[Setting], str],
    report: Report,
) -> list[Trial]:
    """Run each setting several times.

    Parameters
    ----------
    settings : sequence of Setting
    run : callable
        Runs one. What it raises as `ContwalkError` is why the setting has failed.
    names : iterable of str
        What there is to be found.
    in_words : callable
        A setting in words.
    report : callable
        Told what is being done.
    """
    trials: list[Trial] = []
    compiled: set[tuple[str, str]] = set()
    for setting in settings:
        try:
            if (setting.method, setting.model) not in compiled:
                report(f"{in_words(setting)}: compiling")
                run(setting)
                compiled.add((setting.method, setting.model))
            report(in_words(setting))
            done = run(setting)
            trials.append(Trial(setting, (done.seconds,), done.work, done.errors, done.extra))
        except ContwalkError as error:
            trials.append(Trial(setting, errors=dict.fromkeys(names, math.nan), failed=str(error)))
    for number in range(1, REPEATS):
        for k, trial in enumerate(trials):
            if not trial.failed and (number < LEAST or sum(trial.times) < BRIEF):
                report(f"{in_words(trial.setting)}: timed again ({number + 1})")
                trials[k] = replace(trial, times=(*trial.times, run(trial.setting).seconds))
    return trials


def every(accuracies: Sequence[float], methods: Sequence[str]) -> list[Setting]:
    """Each accuracy with each method, the coarse ones first."""
    return [Setting(a, method) for method in methods for a in sorted(accuracies, reverse=True)]


def tighter(accuracies: Sequence[float], lowest: float = LOWEST_ACCURACY) -> float:
    """What the truth is asked for.

    Raises
    ------
    ContwalkError
        For an accuracy that is not possible.
    """
    for accuracy in accuracies:
        if not lowest <= accuracy <= 0.5:
            raise ContwalkError(
                f"The accuracy {accuracy:g} is not possible.", f"Allowed: numbers from {lowest:g} to 0.5."
            )
    return max(TRUER * min(accuracies), lowest)


def apart(errors: Mapping[str, float], least: float = 0.0) -> tuple[list[str], float]:
    """Of the truth computed again: what is not found (NaN), and how far the rest is off, `least` or more."""
    lost = [name for name, value in errors.items() if math.isnan(value)]
    return lost, max([least, *(value for value in errors.values() if not math.isnan(value))])


def relative(difference: float, value: float) -> float:
    """A difference relative to a value; absolute where that is zero."""
    return abs(difference) / abs(value) if value != 0.0 else abs(difference)
