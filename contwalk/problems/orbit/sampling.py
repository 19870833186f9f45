"""Instants of an orbit that samples would miss: where a state is extreme, and where it passes a value."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk.problems.orbit.shooting import Curve
from contwalk.problems.passing import Place
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

# Parabolas through three instants, each nearer together than the last by the second number.
PASSES, NARROWER = 2, 0.03
MOST_BISECTIONS = 60


def with_extrema(curve: Curve, times: np.ndarray, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Samples with the instants added at which each state is largest and smallest.

    What observables make of a motion is most often a largest value: without these instants it would be
    that of the nearest sample, and jump along a branch from one sample to the next.
    """
    indices = np.concatenate([states.argmax(axis=0), states.argmin(axis=0)])
    which = np.tile(np.arange(states.shape[1]), 2)
    inside = (indices > 0) & (indices < len(times) - 1)
    indices, which = indices[inside], which[inside]
    if not len(indices):
        return times, states
    best, width = times[indices], 0.5 * (times[indices + 1] - times[indices - 1])
    for _ in range(PASSES):
        offsets = np.array([-1.0, 0.0, 1.0])
        instants = np.clip(best[:, None] + width[:, None] * offsets, times[0], times[-1])
        order = np.argsort(instants, axis=None, kind="stable")
        found = np.empty((instants.size, states.shape[1]))
        found[order] = curve.at(instants.ravel()[order])
        values = found.reshape(len(best), 3, -1)[np.arange(len(best)), :, which]
        bend = values[:, 0] - 2.0 * values[:, 1] + values[:, 2]
        slope = 0.5 * (values[:, 2] - values[:, 0])
        shift = np.divide(-slope, bend, out=np.zeros_like(slope), where=bend != 0.0)
        best = np.clip(best + width * np.clip(shift, -1.0, 1.0), times[0], times[-1])
        width = NARROWER * width
    best = np.sort(best)
    every = np.concatenate([times, best])
    order = np.argsort(every, kind="stable")
    return every[order], np.concatenate([states, curve.at(best)])[order]


def crossing(problem: PeriodicOrbit, z: np.ndarray, t: np.ndarray, x: np.ndarray, place: Place) -> np.ndarray:
    """The state at which a sampled motion first passes a value of a state; NaN if it never does."""
    begun = place.begun_at(x)
    if begun is not None:
        return begun
    found = place.passed(x)
    if found is None:
        return np.full(problem.states, np.nan)
    k, turn = found
    closure, p, curve = problem.closure, ParameterValues(**problem.values_of(z)), problem.curve(z)
    piece = k // (len(t) // closure.fold)
    low, high = t[k : k + 2] / problem.duration(z) - piece
    for _ in range(MOST_BISECTIONS):
        middle = 0.5 * (low + high)
        there = closure.image(curve.at(np.array([min(middle, 1.0)])), p, piece)[0]
        low, high = (middle, high) if place.beyond(there) < turn else (low, middle)
        if high - low < 1e-15:
            break
    return place.told(there, turn)
