"""Orbits of a branch at the same number of instants each, close enough to be drawn by straight lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.workflow.stored.orbit_motions import Motion


@dataclass(frozen=True, eq=False)
class Sampled:
    """Motions at chosen instants.

    Parameters
    ----------
    times, states : list of ndarray, shapes (k,) and (k, n)
        Of each motion, the first instant being zero; at an event, its instant twice.
    error : float
        The largest distance of a state from the straight line between its instants, in parts of its range.
    """

    times: list[np.ndarray]
    states: list[np.ndarray]
    error: float


def sampled(motions: Sequence[Motion], tolerance: float, least: float, most: int = 256) -> Sampled:
    """Instants of some motions, as many of each phase for all motions that have as many phases.

    Parameters
    ----------
    motions : sequence of Motion
    tolerance : float
        In parts of each state's range; finer and finer instants are taken until the lines are as close.
    least : float
        A range counts as at least so much of the largest one among the motions: a motion that has hardly
        begun to swing consists of rounding.
    most : int
        Of a phase; the error says what is reached with it.
    """
    phases = [_phases(motion) for motion in motions]
    ranges = np.array([np.ptp(motion.states, axis=0) for motion in motions])
    largest = ranges.max(axis=0, initial=0.0) if len(motions) else np.zeros(0)
    scales = np.maximum(ranges, least * np.where(largest > 0.0, largest, 1.0))
    counts: dict[tuple[int, int], int] = {}
    errors: dict[tuple[int, int], float] = {}
    for motion, own, scale in zip(motions, phases, scales, strict=True):
        for number, rows in enumerate(own):
            key = len(own), number
            count = counts.get(key, 4)
            error = _error(motion, rows, _chosen(motion, rows, scale, count), scale)
            while error > tolerance and count < most:
                count = min(count + max(count // 4, 1), most)
                error = _error(motion, rows, _chosen(motion, rows, scale, count), scale)
            counts[key] = count
    times, states = [], []
    for motion, own, scale in zip(motions, phases, scales, strict=True):
        rows_of = [_chosen(motion, rows, scale, counts[len(own), k]) for k, rows in enumerate(own)]
        for number, (rows, chosen) in enumerate(zip(own, rows_of, strict=True)):
            key = len(own), number
            errors[key] = max(errors.get(key, 0.0), _error(motion, rows, chosen, scale))
        all_times = np.concatenate(rows_of)
        times.append(all_times - motion.times[0])
        states.append(np.concatenate([_at(motion, rows, t) for rows, t in zip(own, rows_of, strict=True)]))
    return Sampled(times, states, max(errors.values(), default=0.0))


def _phases(motion: Motion) -> list[np.ndarray]:
    """Rows of a motion between its events; where two events come at once, nothing lies between them."""
    found = np.split(np.arange(len(motion.times)), motion.jumps)
    return [rows for rows in found if motion.times[rows[-1]] > motion.times[rows[0]]] or found[:1]


def _chosen(motion: Motion, rows: np.ndarray, scale: np.ndarray, count: int) -> np.ndarray:
    """Instants of a phase, dense where the motion bends: the error of a line is its bend times its length
    squared, so that equal parts of the root of the bend make equal errors.
    """
    times = motion.times[rows]
    if len(rows) < 3 or times[-1] <= times[0]:
        return np.linspace(times[0], times[-1], count)
    slopes = np.diff(motion.states[rows] / scale, axis=0) / np.diff(times)[:, None]
    middles = 0.5 * (times[1:] + times[:-1])
    bends = np.linalg.norm(np.diff(slopes, axis=0) / np.diff(middles)[:, None], axis=1)
    density = np.sqrt(np.interp(middles, times[1:-1], bends))
    density += density.mean() / count + 1.0 / (times[-1] - times[0]) / count
    length = np.append(0.0, np.cumsum(density * np.diff(times)))
    chosen = np.interp(np.linspace(0.0, length[-1], count), length, times)
    chosen[[0, -1]] = times[[0, -1]]
    return chosen


def _at(motion: Motion, rows: np.ndarray, times: np.ndarray) -> np.ndarray:
    """States within a phase at some times, shape (k, n)."""
    known = motion.times[rows]
    return np.stack([np.interp(times, known, column) for column in motion.states[rows].T], axis=1)


def _error(motion: Motion, rows: np.ndarray, chosen: np.ndarray, scale: np.ndarray) -> float:
    """How far the states are from the lines between chosen instants, in parts of their ranges."""
    known, states = motion.times[rows], _at(motion, rows, chosen)
    lines = np.stack([np.interp(known, chosen, column) for column in states.T], axis=1)
    return float(np.max(np.abs(lines - motion.states[rows]) / scale))
