"""Whether the motion of an autonomous machine has come to rest in a mode."""

from __future__ import annotations

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.machine import ModeFlow
from contwalk.flow.hybrid.motions import MotionSegment
from contwalk.problems.initial.recurrence import AtRest
from contwalk.system import System

# Variation over the later half of an arc's time, in units of what the states have been. Steps control their
# errors to 1e-9 of that: what is left where stability limits them.
STILL = 1e-7
# Growth in units of the largest rate that counts as none: a rounded double eigenvalue of zero.
NEUTRAL = 1e-7


def check_moves(system: System, flow: ModeFlow, arc: MotionSegment, reached: np.ndarray) -> None:
    """Whether a motion still moves at the end of an arc without an event.

    Parameters
    ----------
    reached : ndarray, shape (n,)
        Largest magnitudes of the states on the whole way.

    Raises
    ------
    AtRest
        If it has come to rest in a mode of which equilibria can be followed.
    StartError
        If it has in one in which not all states exist.
    """
    own, middle = flow.states, 0.5 * (arc.times[0] + arc.times[-1])
    later = arc.states[arc.times >= middle][:, own]
    if len(later) < 2 or np.any(np.ptp(later, axis=0) > STILL * reached[own]):
        return
    t, x = float(arc.times[-1]), arc.states[-1]
    rates = _rates(flow, t, x)
    fastest = float(np.max(np.abs(rates), initial=0.0))
    if not fastest > 0.0 or rates.real.max() > NEUTRAL * fastest:
        return  # it does not change anything, or creeps past a saddle
    if len(own) == len(x):
        raise AtRest(x, flow.name)
    raise StartError(
        f"The simulation comes to rest in mode '{flow.name}' at t = {system.lasting(t)}.",
        "Equilibria are followed of modes in which all states exist. Start from a state that leads to a "
        "periodic motion, or give the mode all states.",
    )


def _rates(flow: ModeFlow, t: float, x: np.ndarray) -> np.ndarray:
    """Eigenvalues of the mode's field; none where they are not finite."""
    jacobian = flow.field.jacobian(t, x[flow.states], flow.c)
    return np.linalg.eigvals(jacobian) if np.isfinite(jacobian).all() else np.zeros(0)
