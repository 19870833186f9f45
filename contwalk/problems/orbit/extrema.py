"""The largest and the least value of each state over an orbit: where it turns, not where it is sampled."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

# Samples of each step.
PARTS = 4
_SHARES = np.arange(PARTS) / PARTS
# A turn that the cubic puts so much below the best sample, in parts of the range, is not looked at.
BELOW = 0.05
# Displacement, in parts of what is passed in the whole time, over which a map of the states is differenced.
BESIDE = 1e-4
# Parabolas through three instants, each nearer together than the last by the second number.
PASSES, NARROWER = 2, 0.03


@dataclass(frozen=True, eq=False)
class Smooth:
    """A smooth stretch of a motion, sampled.

    Parameters
    ----------
    times : ndarray, shape (k,)
        In growing order; one may be repeated, where states or rates miss by the error of the steps.
    states, rates : ndarray, shape (k, n)
    at : callable
        States at any times in growing order, exact as the integrator's own interpolation is.
    rate_at : callable
        Rates at times (m,) and states (m, n) there.
    """

    times: np.ndarray
    states: np.ndarray
    rates: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]
    rate_at: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def mapped(self, shown: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Smooth:
        """The stretch as a map (times, states) -> states shows it, as that to a mirror image."""
        seen = shown(self.times, self.states)
        if seen is self.states:
            return self

        def rate(times: np.ndarray, states: np.ndarray, rates: np.ndarray) -> np.ndarray:
            h = BESIDE * (self.times[-1] - self.times[0])
            ahead, behind = (shown(times + s, states + s * rates) for s in (h, -h))
            return (ahead - behind) / (2.0 * h)

        def at(times: np.ndarray) -> np.ndarray:
            return shown(times, self.at(times))

        def rate_at(times: np.ndarray, _: np.ndarray) -> np.ndarray:
            states = self.at(times)
            return rate(times, states, self.rate_at(times, states))

        return Smooth(self.times, seen, rate(self.times, self.states, self.rates), at, rate_at)

    def brackets(self, own: np.ndarray) -> tuple[np.ndarray, ...]:
        """Which of some states turn between two samples, and there: times, values and rates of both."""
        t, x, r = self.times, self.states, self.rates
        sign, among = np.sign(r), np.zeros(x.shape[1], dtype=bool)
        among[own] = True
        k, j = np.nonzero((sign[:-1] * sign[1:] < 0.0) & (t[1:] > t[:-1])[:, None] & among)
        return j, t[k], t[k + 1], x[k, j], x[k + 1, j], r[k, j], r[k + 1, j]


def extremes_of(stretches: Sequence[Smooth], own: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of each state over some stretches, shapes (n,).

    `own` are the states that each has; where none has one, they are inf and -inf. NaN where a stretch has no
    value.
    """
    n = stretches[0].states.shape[1]
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    for stretch, which in zip(stretches, own, strict=True):
        low[which] = np.minimum(low[which], stretch.states.min(axis=0)[which])
        high[which] = np.maximum(high[which], stretch.states.max(axis=0)[which])
    brackets = [stretch.brackets(which) for stretch, which in zip(stretches, own, strict=True)]
    j, a, b, va, vb, ra, rb = (np.concatenate(parts) for parts in zip(*brackets, strict=True))
    near, bend = turns(a, b, va, vb, ra, rb), (rb - ra) / (b - a)
    cubic = cubics_at(near, (a, b, va, vb, ra, rb))
    slack = BELOW * (high - low)[j]
    wanted = np.where(ra > 0.0, cubic >= high[j] - slack, cubic <= low[j] + slack)
    ends = np.cumsum([len(found[0]) for found in brackets])
    for stretch, begin, end in zip(stretches, [0, *ends], ends, strict=False):
        order = begin + np.flatnonzero(wanted[begin:end])
        if not len(order):
            continue
        order = order[np.argsort(near[order], kind="stable")]
        found = stretch.at(near[order])
        places = np.arange(len(order)), j[order]
        left = stretch.rate_at(near[order], found)[places]
        # What the rate that is left there still gives: the parabola's own top.
        values = found[places] - 0.5 * left * left / bend[order]
        with np.errstate(invalid="ignore"):
            np.minimum.at(low, j[order], values)
            np.maximum.at(high, j[order], values)
    return low, high


def sampled(steps: np.ndarray) -> np.ndarray:
    """Instants within steps, their ends among them. Steps have the shape (s + 1,), instants (4 s + 1,)."""
    found = np.empty(PARTS * (len(steps) - 1) + 1)
    parts = (steps[1:] - steps[:-1])[:, None] * _SHARES
    found[:-1] = (steps[:-1, None] + parts).ravel()
    found[-1] = steps[-1]
    return found


def turns(
    a: np.ndarray, b: np.ndarray, va: np.ndarray, vb: np.ndarray, ra: np.ndarray, rb: np.ndarray
) -> np.ndarray:
    """Where the cubics through two values with their rates, of opposite signs, turn between them.

    All have the shape (k,).
    """
    h, steepest = b - a, np.maximum(np.abs(ra), np.abs(rb))
    # In units in which no product of two overflows, or is lost.
    d, ra, rb = (vb - va) / h / steepest, ra / steepest, rb / steepest
    # derivative of the Hermite cubic: ra + 2 (3 d - 2 ra - rb) s + 3 (ra + rb - 2 d) s^2
    c1, c2 = 2.0 * (3.0 * d - 2.0 * ra - rb), 3.0 * (ra + rb - 2.0 * d)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # Two zeros that keep their digits; the one at which it goes to the sign of rb lies between.
        root = np.sqrt(np.maximum(c1 * c1 - 4.0 * c2 * ra, 0.0))
        q = -0.5 * (c1 + np.where(c1 >= 0.0, root, -root))
        between = np.where((c1 >= 0.0) == (rb > 0.0), ra / q, q / c2)
    return a + h * np.minimum(np.maximum(between, 0.0), 1.0)


def cubics_at(t: np.ndarray, ends: Iterable[np.ndarray]) -> np.ndarray:
    """The cubics through two values with their rates, at instants between them, shape (k,).

    `ends` are times, values and rates, before and behind each, as `turns` takes them.
    """
    a, b, va, vb, ra, rb = ends
    h, d = b - a, vb - va
    s, first, last = (t - a) / h, h * ra, h * rb
    return va + s * (first + s * (3.0 * d - 2.0 * first - last + s * (first + last - 2.0 * d)))


def with_extrema(
    at: Callable[[np.ndarray], np.ndarray], times: np.ndarray, states: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Samples with the instants added at which each state is largest and smallest.

    What observables make of a motion is most often a largest value: without these instants it would be
    that of the nearest sample, and jump along a branch from one sample to the next.

    Times have the shape (k,), states (k, n), before and after; `at` has states at times in growing order.
    """
    best, width, which = _peaks(times, states)
    if not len(best):
        return times, states
    for _ in range(PASSES):
        offsets = np.array([-1.0, 0.0, 1.0])
        instants = np.clip(best[:, None] + width[:, None] * offsets, times[0], times[-1])
        order = np.argsort(instants, axis=None, kind="stable")
        found = np.empty((instants.size, states.shape[1]))
        found[order] = at(instants.ravel()[order])
        values = found.reshape(len(best), 3, -1)[np.arange(len(best)), :, which]
        bend = values[:, 0] - 2.0 * values[:, 1] + values[:, 2]
        slope = 0.5 * (values[:, 2] - values[:, 0])
        shift = np.divide(-slope, bend, out=np.zeros_like(slope), where=bend != 0.0)
        best = np.clip(best + width * np.clip(shift, -1.0, 1.0), times[0], times[-1])
        width = NARROWER * width
    best = np.setdiff1d(best, times)
    every = np.concatenate([times, best])
    order = np.argsort(every, kind="stable")
    return every[order], np.concatenate([states, at(best)])[order]


def _peaks(times: np.ndarray, states: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where a state, (k, n), may be at its largest or least: instants, how far beside, and which state, (m,).

    Of peaks of almost one height the largest sample need not be at the highest: each counts whose sample is
    below the largest one by no more than the peak may rise above it. One at an end may be a peak within the
    first or last step; a motion that goes on may have turned there.
    """
    indices, which, (count, n) = [], [], states.shape
    beyond = np.full((1, n), np.inf)
    way = np.abs(np.diff(states, axis=0))
    # How far it goes within the steps beside each sample; at an end within the two next to it.
    steep = np.maximum(
        way[np.r_[min(1, count - 2), 0 : count - 1]], way[np.r_[0 : count - 1, max(count - 3, 0)]]
    )
    for x in (states, -states):
        step = np.diff(x, axis=0)
        rises, falls = np.concatenate([beyond, step]) > 0.0, np.concatenate([-step, beyond]) >= 0.0
        k, j = np.nonzero(rises & falls & (steep > 0.0) & (x + 0.5 * steep >= x.max(axis=0)))
        indices.append(k)
        which.append(j)
    k = np.concatenate(indices)
    before, after = times[np.maximum(k - 1, 0)], times[np.minimum(k + 1, count - 1)]
    inside = (k > 0) & (k < count - 1)
    middle = np.where(inside, times[k], 0.5 * (before + after))
    return middle, 0.5 * (after - before), np.concatenate(which)
