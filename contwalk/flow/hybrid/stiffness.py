"""Whether stability limits the steps of an explicit method on a leg."""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.flow.hybrid.motion_segment import MotionSegment

# Where the fastest decay lasts this part of a step, or less, an explicit method is at its limit: along the
# negative real axis dop853 is stable to 6.
LIMIT = 0.5
# The last steps of a motion, which tell how long they are.
LATELY = 50


def is_stiff(machine: HybridMachine, segment: MotionSegment) -> bool:
    """Whether the last steps of a segment are as long as the fastest decay of deviations allows."""
    lengths = np.diff(segment.times[-LATELY:])
    if not len(lengths) or not np.isfinite(segment.states[-1]).all():
        return False
    flow = machine.mode(segment.mode)
    jacobian = flow.field.jacobian(float(segment.times[-1]), segment.states[-1][flow.states], flow.c)
    if not np.isfinite(jacobian).all():
        return False
    fastest = min(np.linalg.eigvals(jacobian), key=lambda value: value.real, default=0.0)
    decays = -fastest.real > abs(fastest.imag)
    return bool(decays and -fastest.real * float(np.median(lengths)) > LIMIT)
