"""Orbits of forced hybrid systems that meet no event."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk import flow
from contwalk.flow.hybrid.motions import MotionSegment, hybrid_machine
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.hybrid.mirrors import Span
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import System

RETURNED, NEARLY = 1e-5, 0.2


def strobes(
    system: System,
    parameters: Mapping[str, float],
    arc: MotionSegment,
    period: float,
    scale: np.ndarray,
    first: bool,
) -> HybridRecurrence | None:
    """The recurrence that a quiet motion repeats, seen at whole periods of the force; None if none yet.

    Parameters
    ----------
    scale : ndarray, shape (n,)
        Magnitudes by which states are compared.
    first : bool
        The first near return will do: the motion began on an orbit.
    """
    machine = hybrid_machine(system, parameters)
    mode = machine.mode(arc.mode)
    begin, end = float(arc.times[0]), float(arc.times[-1])
    times = period * np.arange(np.ceil(begin / period - 1e-9), np.floor(end / period + 1e-9) + 1.0)
    if len(times) < 2:
        return None
    states = flow.dense(
        mode.field, mode.c, arc.times, arc.states[:, mode.states], np.clip(times, begin, end), "dop853"
    )
    within = NEARLY if first else RETURNED
    for k in range(1, len(times)):
        apart = (states[k] - states[0]) / scale[mode.states]
        if float(np.linalg.norm(apart)) < within:
            start = machine.full(arc.mode, states[-1 if not first else 0])
            return HybridRecurrence((Span(Leg(arc.mode), 0.0, start, k * period, start),), scale, 0.0, start)
    return None
