"""Transitions that accumulate: a ball that comes to rest by infinitely many impacts in a finite time."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import GuardStatus

# Time until the next impact, in roundings of the time, that is no longer resolved.
INSTANT = 64.0

# The guard's way from zero and back, in its own uncertainties, that is no longer resolved.
INVISIBLE = 100.0

# So many events within this part of the time accumulate, whatever their law.
MOST_EVENTS, SHARE = 5000, 1e-8

# More transitions than this follow each other in no time only where a machine cannot leave.
MOST_AT_ONCE = 100


@dataclass(frozen=True)
class Verdict:
    """Whether a motion can go on after a transition; arguments as in `MotionSegment`."""

    status: str = "ok"
    reason: str = ""
    accumulation: float | None = None


class Pace:
    """Told of each transition, says whether they accumulate.

    After a transition the guard that leaves zero is back after 2 |rate / bend|, if its second derivative
    stays as it is, which it does in the limit. The ratio of this time to the one before is that of a
    geometric series, whose sum is the time that is left.

    Parameters
    ----------
    t0, t1 : float
        The motion's start and end.
    """

    def __init__(self, t0: float, t1: float) -> None:
        self._start, self._end = t0, t1
        self._last, self._back = t0, 0.0
        self._at_once = 0
        self._recent: deque[float] = deque(maxlen=MOST_EVENTS)

    def verdict(self, t: float, name: str, standing: Sequence[GuardStatus]) -> Verdict:
        """What a transition at this instant means, after which the guards that act stand like this."""
        duration, self._last = t - self._last, t
        self._recent.append(t)
        self._at_once = self._at_once + 1 if duration == 0.0 else 0
        if self._at_once > MOST_AT_ONCE:
            return Verdict(
                "sticking",
                f"More than {MOST_AT_ONCE} transitions follow each other at t = {t:.10g} without any time "
                f"between them, '{name}' among them. The plugin must declare a mode for what happens there; "
                "one that slides along the guard is derived by contwalk systems slide.",
            )
        left = self._left(t, duration, standing)
        if left < math.inf:
            return Verdict(
                "chatter",
                f"Transition '{name}' accumulates: infinitely many of it happen until t = {t + left:.15g}. "
                "The plugin must declare a mode for what comes after.",
                t + left,
            )
        span = (self._end if self._end < math.inf else t) - self._start
        if len(self._recent) == MOST_EVENTS and t - self._recent[0] <= SHARE * span:
            return Verdict(
                "chatter",
                f"{MOST_EVENTS} transitions happen between t = {self._recent[0]:.15g} and {t:.15g}, '{name}' "
                "among them: they accumulate. The plugin must declare a mode for what comes after.",
            )
        return Verdict()

    def _left(self, t: float, duration: float, standing: Sequence[GuardStatus]) -> float:
        """Time until the accumulation point; infinite where there is none, or where it is not yet near."""
        soonest = min(standing, key=lambda each: each.returns_after, default=None)
        if soonest is None:
            return math.inf
        before, back = self._back or duration, soonest.returns_after
        self._back = back if back < math.inf else 0.0
        if not back < before:
            return math.inf
        instant = back <= INSTANT * EPSILON * max(abs(t), abs(self._start))
        if instant or soonest.excursion <= INVISIBLE * soonest.value_noise:
            return back / (1.0 - back / before)
        return math.inf
