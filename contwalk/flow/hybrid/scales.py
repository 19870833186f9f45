"""Typical magnitudes of the states of a hybrid machine, seen at the beginning of a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import parts

PILOT_STEPS, PILOT_TOLERANCE = 200, 1e-6


def magnitudes(
    machine: HybridMachine,
    t0: float,
    x0: np.ndarray,
    mode: str,
    t1: float,
    given: Sequence[float | None],
    method: str,
    just_after: str | None = None,
) -> np.ndarray:
    """Those given, else those seen while the states exist, else 1; full length.

    Parameters
    ----------
    given : sequence of float or None
        Declared scales; the other arguments are those of `motion_segments`.
    """
    known = np.array([np.nan if scale is None else scale for scale in given])
    if np.isfinite(known).all():
        return known
    x0 = machine.existing(mode, x0)
    first = np.where(np.isnan(known), np.where(x0 == 0.0, 1.0, np.abs(x0)), known)
    sums, spans, largest = (np.zeros(len(known)) for _ in range(3))
    steps = 0
    pilot = Control(PILOT_TOLERANCE, first, method)
    for part in parts(machine, t0, x0, mode, t1, pilot, just_after):
        if part.status in ("not_finite", "step_too_small"):
            return first  # what it came to on its way out of the numbers is not typical
        existing, sizes = machine.mode(part.mode).states, np.abs(part.states)
        lengths = np.diff(part.times)[:, None]
        total = (0.5 * lengths * (sizes[:-1] + sizes[1:])).sum(axis=0)
        sums[existing] += total[existing]
        spans[existing] += part.times[-1] - part.times[0]
        largest = np.maximum(largest, sizes.max(axis=0))
        steps += len(part.times)
        if steps >= PILOT_STEPS:
            break
    # Twice the mean over time, not the largest value: that of a motion on its way to infinity says nothing.
    seen = np.minimum(2.0 * sums / np.where(spans > 0.0, spans, 1.0), largest)
    return np.where(np.isnan(known), np.where(seen > 0.0, seen, first), known)
