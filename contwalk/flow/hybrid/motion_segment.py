"""A smooth segment of a hybrid motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contwalk.flow.events.crossings import Event
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow

# An end in infinity is replaced by one so many times away as the motion needs to pass through its magnitudes.
FAR = 1e4


@dataclass(frozen=True, eq=False)
class MotionSegment:
    """What is smooth of a motion, in one mode, between two events.

    Parameters
    ----------
    mode : str
    times : ndarray, shape (s + 1,)
        Ends of the integrator's steps: `along` on them gives the states again, bitwise. A segment without
        length, between transitions that happen at once, has one instant.
    states : ndarray, shape (s + 1, n)
        Of full length; states that do not exist in the mode are 0.
    transition : str, optional
        The one that ended it; None where the time was up, or where `status` says why it ended.
    after : ndarray, shape (n,), optional
        The state after the transition, with which the next segment begins.
    watched : list of Event
        Crossings of watched transitions inside.
    evaluations : int
    status : str
        `ok`, or why the motion cannot go on: `not_finite`, `step_too_small`, `too_many_steps`; `chatter`:
        transitions accumulate; `sticking`: a transition is not left behind after it has happened.
    reason : str
        A sentence for a status that is not `ok`.
    accumulation : float, optional
        The instant at which transitions accumulate, where it is known.
    rising : bool
        Whether the guard of the transition rose through zero.
    collapsed : bool
        Whether it was past zero where the mode was entered.
    """

    mode: str
    times: np.ndarray
    states: np.ndarray
    transition: str | None = None
    after: np.ndarray | None = None
    watched: list[Event] = field(default_factory=list)
    evaluations: int = 0
    status: str = "ok"
    reason: str = ""
    accumulation: float | None = None
    rising: bool = False
    collapsed: bool = False


@dataclass(frozen=True, eq=False)
class Control:
    """How steps are controlled.

    Parameters
    ----------
    tolerance : float
        Local error of each step, in units of `weights`.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    method : str
        One of `flow.METHODS`.
    watched : bool
        Whether crossings of watched transitions are located, which costs as much as events do; steps are the
        same if they are not.
    """

    tolerance: float
    weights: np.ndarray
    method: str = "dop853"
    watched: bool = True


def part_of(
    machine: HybridMachine,
    flow: ModeFlow,
    times: np.ndarray,
    states: np.ndarray,
    watched: list[Event],
    evaluations: int,
) -> MotionSegment:
    """Some steps of a mode: times, shape (s + 1,), and the states that exist in it, shape (s + 1, m)."""
    return MotionSegment(
        flow.name, times, machine.full(flow.name, states), watched=watched, evaluations=evaluations
    )


def far(flow: ModeFlow, t: float, x: np.ndarray, weights: np.ndarray) -> float:
    """A long time: at its present speed the motion would pass through its magnitudes many times.

    `x` and `weights`, of shape (m,), are those of the states that exist in the mode.
    """
    speed = float(np.max(np.abs(flow.field(t, x, flow.c)) / weights, initial=0.0))
    return FAR / speed if np.isfinite(speed) and speed > 1e-4 else FAR


def at_once_too_fast(flow: ModeFlow, t: float, x: np.ndarray) -> MotionSegment:
    """The end of a motion so fast, at its state x of full length, that no time after t can be told from t."""
    status = "step_too_small"
    return MotionSegment(flow.name, np.array([t]), x[None], status=status, reason=why(flow, status, t))


def why(flow: ModeFlow, status: str, t: float) -> str:
    """A sentence for steps that cannot go on."""
    words = {"not_finite": "is not finite beyond", "step_too_small": "asks for steps below rounding at"}
    said = f"The field of mode '{flow.name}' {words[status]} t = {t:.10g}."
    if status == "not_finite":
        return said
    return (
        f"{said} If the motion runs to a pole there, as a spike does, an event has to act earlier on its way."
    )
