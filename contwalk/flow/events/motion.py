"""One motion from a state on, step by step, with the events on its way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.events.crossings import Event, crossings
from contwalk.flow.events.guard import Guard
from contwalk.flow.integrate import controlled
from contwalk.flow.path import ErrorControl

STEPS_AT_ONCE = 50
PILOT_STEPS = 200


@dataclass(frozen=True, eq=False)
class Machine:
    """What moves: the compiled field of the mode that it is in, and what is watched.

    Parameters
    ----------
    field : CompiledField
    p, c : ndarray
        Parameters, and the field's constants made from them.
    guards : sequence of Guard
    mode : str
    """

    field: CompiledField
    p: np.ndarray
    c: np.ndarray
    guards: Sequence[Guard]
    mode: str


@dataclass(frozen=True, eq=False)
class SegmentPart:
    """Some steps of a motion.

    Parameters
    ----------
    times, states : ndarray, shapes (s + 1,) and (s + 1, n)
    events : list of Event
        Those within, in the order of time.
    evaluations : int
    status : str
        `ok`; `not_finite` or `step_too_small` where the motion could not go on.
    """

    times: np.ndarray
    states: np.ndarray
    events: list[Event]
    evaluations: int
    status: str


def segment_parts(
    machine: Machine,
    t0: float,
    x0: np.ndarray,
    t1: float,
    tolerance: float,
    weights: np.ndarray,
    method: str = "dop853",
) -> Iterator[SegmentPart]:
    """A motion from t0 until t1, which may be infinite if the caller stops asking.

    Parameters
    ----------
    machine : Machine
    t0, x0, t1
        Time and state of the start, time of the end.
    tolerance : float
        Local error of each step, in units of `weights`.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states.
    method : str
        One of `flow.METHODS`.
    """
    t, x = t0, np.asarray(x0, dtype=float)
    control = ErrorControl(tolerance, weights, STEPS_AT_ONCE)
    while t < t1:
        # Where the end is unknown, ask for more time than the steps can pass through.
        end = t1 if np.isfinite(t1) else t + _far(machine, t, x, weights)
        if not end > t:  # so fast that no time after this one can be told from it
            yield SegmentPart(np.array([t]), x[None], [], 0, "step_too_small")
            return
        path = controlled(machine.field, machine.c, t, x, end, control, method)
        found = crossings(
            machine.field, machine.c, machine.p, path.times, path.states, machine.guards, method
        )
        events = [
            Event(machine.guards[at.guard].name, at.time, at.rising, at.state, at.state, machine.mode)
            for at in found
        ]
        status = "ok" if path.status in ("ok", "too_many_steps") else path.status
        yield SegmentPart(path.times, path.states, events, path.evaluations, status)
        if status != "ok":
            return
        t, x = float(path.times[-1]), path.states[-1]


def _far(machine: Machine, t: float, x: np.ndarray, weights: np.ndarray) -> float:
    """A long time: at its present speed the motion would pass through its magnitudes many times."""
    speed = float(np.max(np.abs(machine.field(t, x, machine.c)) / weights, initial=0.0))
    return 1e4 / speed if np.isfinite(speed) and speed > 1e-4 else 1e4


def magnitudes(
    machine: Machine, t0: float, x0: np.ndarray, t1: float, given: Sequence[float | None], method: str
) -> np.ndarray:
    """Typical magnitudes of the states: those given, else those seen at the beginning of the motion.

    Parameters
    ----------
    x0 : ndarray, shape (n,)
    given : sequence of float or None, length n
        Declared scales.

    Returns
    -------
    ndarray, shape (n,)
    """
    known = np.array([np.nan if scale is None else scale for scale in given])
    if np.isfinite(known).all():
        return known
    first = np.where(np.isnan(known), np.where(x0 == 0.0, 1.0, np.abs(x0)), known)
    end = t1 if np.isfinite(t1) else t0 + _far(machine, t0, x0, first)
    control = ErrorControl(1e-6, first, PILOT_STEPS)
    path = controlled(machine.field, machine.c, t0, x0, end, control, method)
    if path.status not in ("ok", "too_many_steps"):
        return first  # what it came to on its way out of the numbers is not typical
    # Twice the mean over time, not the largest value: that of a motion on its way to infinity says nothing.
    seen = np.minimum(2.0 * _mean(path.times, np.abs(path.states)), np.abs(path.states).max(axis=0))
    return np.where(np.isnan(known), np.where(seen > 0.0, seen, 1.0), known)


def _mean(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Mean over time of each column, by the trapezoidal rule."""
    if len(times) < 2:
        return values[0]
    lengths = np.diff(times)[:, None]
    return (0.5 * lengths * (values[:-1] + values[1:])).sum(axis=0) / (times[-1] - times[0])
