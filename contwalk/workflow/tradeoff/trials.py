"""Settings that were tried, each with its times and its true errors, and which of them to take.

Times scatter. Each setting is timed several times; the least time is the one with the least else in it, and
the spread of the times is its error. Two settings whose times differ by no more than both errors are a tie.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

MANY = 4  # times, of which the slowest says more of the machine than of the setting


@dataclass(frozen=True)
class Setting:
    """What is tried.

    Parameters
    ----------
    accuracy : float
        Of branches the accuracy asked for, of motions and margins the tolerance of the integration.
    method : str
        The integrator, or collocation.
    model : str
        Model choices, `hip=locked,torso=balanced`; empty for those of the run file.
    """

    accuracy: float
    method: str
    model: str = ""


@dataclass(frozen=True)
class Trial:
    """What came of a setting.

    Parameters
    ----------
    setting : Setting
    times : tuple of float
        CPU seconds of its runs in this process, compilation not included.
    work : int
        Right-hand sides, or of margins simulations, of one run.
    errors : mapping
        True relative error by the name of what was computed; NaN where it was not found.
    extra : tuple of str
        What was found and does not exist.
    failed : str
        Why there is no result, or nothing.
    """

    setting: Setting
    times: tuple[float, ...] = ()
    work: int = 0
    errors: Mapping[str, float] = field(default_factory=dict)
    extra: tuple[str, ...] = ()
    failed: str = ""

    @property
    def seconds(self) -> float:
        """The least time; NaN where there is none."""
        return min(self.times, default=math.nan)

    @property
    def spread(self) -> float:
        """How far the times lie apart, but for the slowest of many: the error of the least one."""
        times = sorted(self.times)
        return times[-2 if len(times) >= MANY else -1] - times[0] if times else math.nan

    @property
    def found(self) -> int:
        """How much was found."""
        return sum(not math.isnan(error) for error in self.errors.values())

    @property
    def missing(self) -> tuple[str, ...]:
        """What was not."""
        return tuple(name for name, error in self.errors.items() if math.isnan(error))

    @property
    def worst(self) -> float:
        """Largest true relative error of what was found."""
        return max((e for e in self.errors.values() if not math.isnan(e)), default=math.nan)

    def meets(self, accuracy: float) -> bool:
        """Whether everything was found, to this relative accuracy."""
        return not self.failed and not self.missing and not self.extra and not self.worst > accuracy

    def ties(self, other: Trial) -> bool:
        """Whether which of two is faster is not known: their times differ by no more than both spreads."""
        return abs(self.seconds - other.seconds) <= self.spread + other.spread


@dataclass(frozen=True)
class Kind:
    """What is measured, in words.

    Parameters
    ----------
    asked : str
        The column of the setting's number: `accuracy` or `tolerance`.
    work : str
        What the work is counted in.
    results : str
        What is compared: points, quantities of a motion, borders.
    form : str
        How a setting is written in a run file, with `{accuracy}`, `{method}` and `{model}`.
    promises : bool
        Whether a setting's number is a promise of the results' own accuracy.
    """

    asked: str
    work: str
    results: str
    form: str
    promises: bool = False

    def written(self, setting: Setting) -> str:
        """A setting as it stands in a run file."""
        key = "discretization" if setting.method == COLLOCATION else "method"
        model = setting.model.replace("=", ": ").replace(",", ", ")
        written = f"{setting.accuracy:g}"
        return self.form.format(
            accuracy=written, method=f"{key}: {setting.method}", model=model or "as it is"
        )


COLLOCATION = "collocation"
BRANCHES = Kind(
    "accuracy", "right-hand sides", "points", "accuracy: {accuracy} with engine: {{{method}}}", promises=True
)
MOTION = Kind("tolerance", "right-hand sides", "quantities", "simulate: {{tolerance: {accuracy}, {method}}}")
MARGINS = Kind("tolerance", "simulations", "borders", "margins: {{tolerance: {accuracy}, {method}}}")
MODELS = Kind("accuracy", "right-hand sides", "points", "model: {{{model}}}")


@dataclass(frozen=True)
class Tradeoff:
    """All trials with what they were compared with.

    Parameters
    ----------
    kind : Kind
    wanted : float
        The relative error that is allowed.
    truth : mapping
        Name of each result to its true value.
    compared : str
        A sentence on what the errors are differences from.
    doubt : float
        Errors below it are not told apart.
    trials : list of Trial
    notes : tuple of str
        Sentences on what is not sure of the truth.
    sure : bool
        Whether the truth has been found again.
    """

    kind: Kind
    wanted: float
    truth: Mapping[str, float]
    compared: str
    doubt: float
    trials: Sequence[Trial]
    notes: tuple[str, ...] = ()
    sure: bool = True

    def held(self, trial: Trial) -> bool:
        """Whether a trial met what it was asked for: its own accuracy where that is a promise."""
        return trial.meets(trial.setting.accuracy if self.kind.promises else self.wanted)

    @property
    def ties(self) -> list[Trial]:
        """The cheapest trial that met what is wanted, and all whose times are not told from its own.

        The most accurate comes first.
        """
        good = [trial for trial in self.trials if trial.meets(self.wanted)]
        if not good:
            return []
        least = min(good, key=lambda t: t.seconds)
        return sorted((t for t in good if t.ties(least)), key=self._rank)

    def _rank(self, trial: Trial) -> tuple[float, float, float]:
        asked = trial.setting.accuracy if self.kind.promises else 0.0
        return asked, max(trial.worst, self.doubt), trial.seconds
