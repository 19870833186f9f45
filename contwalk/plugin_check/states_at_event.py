"""States at which an event happens, found from sampled states, and how its guard moves there."""

from __future__ import annotations

import numpy as np

from contwalk.plugin_check.functions import EPSILON
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced
from contwalk.system import Transition

TRIES = 40
ITERATIONS = 30
# Share of Newton's step that is taken back where the guard has no value at its zero.
SHORT_OF_ZERO = 8.0 * EPSILON
# Rounding leaves a guard this far from zero, in units of the rounding of its terms.
FACTOR = 1e3
_SEED = 21  # any; fixed, so that two checks of one plugin say the same


def states_at_event(
    transition: Transition,
    guard: Traced,
    field: Traced,
    samples: Samples,
    tries: int = TRIES,
    enough: int = TRIES,
) -> list[tuple[float, np.ndarray]]:
    """Times and states (n,) on the guard that approach it in its direction, as many as are enough."""
    random = np.random.default_rng(_SEED)
    found = []
    for k in range(tries):
        row = k % len(samples.states)
        t = float(samples.times[row])
        x = samples.states[row] + samples.scales * random.standard_normal(len(samples.scales))
        at = state_on(guard, t, guard.given(x), samples)
        if at is None:
            continue
        rate = rate_of(guard, field, t, at, samples)
        if np.isfinite(rate) and rate != 0.0 and _sign(transition, rate) * rate > 0.0:
            found.append((t, at))
            if len(found) == enough:
                break
    return found


def state_on(guard: Traced, t: float, x: np.ndarray, samples: Samples) -> np.ndarray | None:
    """The state (n,) where the guard is zero, reached along its gradient in the metric of the scales.

    Where the guard has no value at its zero, and beyond, the state is the last one before it.
    """
    step: np.ndarray | None = None
    for _ in range(ITERATIONS):
        value = guard.values(t, x, samples.values)[0]
        if not np.isfinite(value) and step is not None:
            x = x - SHORT_OF_ZERO * step
            value = guard.values(t, x, samples.values)[0]
        if not np.isfinite(value):
            return None
        if abs(value) <= _level(guard, t, x, samples):
            return x
        slope = guard.slopes(t, x, samples.values)[0, 1:]
        scaled = slope * samples.scales
        largest = float(np.max(np.abs(scaled), initial=0.0))
        if not 0.0 < largest < np.inf:
            return None
        way = scaled / largest  # its square does not overflow, whatever the guard's units are
        step = -(value / largest) * samples.scales * way / (way @ way)
        x = x + step
    return None


def rate_of(guard: Traced, field: Traced, t: float, x: np.ndarray, samples: Samples) -> float:
    """Rate of the guard along the motion at x (n,), exactly zero where it is so but for rounding."""
    slope = guard.slopes(t, x, samples.values)[0]
    terms = slope * np.array([1.0, *field.values(t, x, samples.values)])
    rate = float(terms.sum())
    return 0.0 if abs(rate) <= FACTOR * EPSILON * np.abs(terms).sum() else rate


def _level(guard: Traced, t: float, x: np.ndarray, samples: Samples) -> float:
    """What rounding leaves of the guard at a zero."""
    slope = guard.slopes(t, x, samples.values)[0]
    bound = guard.roundings(t, x, samples.values)[0]
    return 2.0 * EPSILON * float(bound + np.abs(slope) @ np.abs([t, *x]))


def _sign(transition: Transition, rate: float) -> float:
    """The sign that the guard's rate has at the event."""
    if transition.direction == "both":
        return float(np.sign(rate))
    return -1.0 if transition.direction == "falling" else 1.0
