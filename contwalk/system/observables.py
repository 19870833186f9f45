"""What is measured of a motion: observables and signals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.system.names import require_callable, require_name, require_side, require_texts


@dataclass(frozen=True)
class Observable:
    """A number computed from a motion: `function(t, x, p)` with `t` of shape (k,) and `x` of shape (k, n).

    An equilibrium is handed over as a motion of one instant (k = 1). A motion through events has two
    instants at each: before and after. With `at` the number belongs to an event instead: `t` is its time and
    `x`, shape (n,), the state before or after it (`side`), where it happens for the first time in a period.
    `latex` is how figures write its name.
    """

    name: str
    function: Callable[..., float]
    unit: str = "1"
    about: str = ""
    at: str | None = None
    side: str = "before"
    latex: str = ""

    def __post_init__(self) -> None:
        require_name("An observable", self.name)
        require_texts(f"Observable '{self.name}'", self, "unit", "about", "latex")
        require_callable(f"The function of observable '{self.name}'", self.function)
        require_side(f"Observable '{self.name}'", self.side)


@dataclass(frozen=True)
class Signal:
    """A quantity that figures show along a motion: `function(t, x, p)`, of the shapes that observables take.

    It returns an array of shape (k,), NaN where the quantity does not exist: the height of a foot, the force
    on it. With `extremes` its largest and its least value along a motion are observables, `NAME_max` and
    `NAME_min`; else nothing is computed with it.
    """

    name: str
    function: Callable[..., Any]
    unit: str = "1"
    about: str = ""
    extremes: bool = False

    def __post_init__(self) -> None:
        require_name("A signal", self.name)
        require_callable(f"The function of signal '{self.name}'", self.function)


@dataclass(frozen=True)
class SignalExtreme:
    """The largest or the least value of a signal along a motion, as an observable's function.

    Between instants it is that of the parabola through three of them, and so known to the third order of what
    lies between them. Of a motion of one instant it is the value there; where the signal does not exist it is
    not looked at.

    Parameters
    ----------
    signal : Signal
    sign : float
        1 for the largest value, -1 for the least.
    """

    signal: Signal
    sign: float

    def __call__(self, t: Any, x: Any, p: Any) -> Any:
        """The value; t has the shape (k,), x the shape (k, n)."""
        found = self.signal.function(t, x, p)
        if len(t) == 1:
            return found[0]
        values = self.sign * np.asarray(found, dtype=float)
        if not np.isfinite(values).any():
            return np.nan
        best = int(np.nanargmax(values))
        top = values[best]
        if 0 < best < len(t) - 1 and np.isfinite(values[best - 1 : best + 2]).all():
            low, high = t[best] - t[best - 1], t[best + 1] - t[best]
            if low > 0.0 and high > 0.0:  # no event beside it
                fall, rise = (top - values[best - 1]) / low, (values[best + 1] - top) / high
                bend, slope = (rise - fall) / (low + high), (fall * high + rise * low) / (low + high)
                top += 0.0 if bend == 0.0 else -0.25 * slope * slope / bend
        return self.sign * top


def with_extremes(observables: tuple[Observable, ...], signals: tuple[Signal, ...]) -> tuple[Observable, ...]:
    """The observables, and `NAME_max` and `NAME_min` of each signal whose extremes are observables too."""
    known = {observable.name for observable in observables}
    added = [
        Observable(
            f"{signal.name}_{what}", SignalExtreme(signal, sign), signal.unit, f"{word} {signal.about}"
        )
        for signal in signals
        if signal.extremes
        for what, sign, word in (("max", 1.0, "largest"), ("min", -1.0, "least"))
    ]
    return (*observables, *(each for each in added if each.name not in known))
