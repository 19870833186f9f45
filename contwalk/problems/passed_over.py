"""Whether a smooth orbit of a machine with events passes one of them, soft ones too."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.errors import measured
from contwalk.system import System
from contwalk.system.declarations import ParameterValues


def passed_over(system: System, t: np.ndarray, x: np.ndarray, parameters: Mapping[str, float]) -> bool:
    """Whether a guard that leads out of the first mode is past zero somewhere on a motion.

    Parameters
    ----------
    t, x : ndarray, shapes (k,) and (k, n)
        Instants of the motion, and its states there.
    """
    if not system.has_events:
        return False
    p = ParameterValues(**parameters)
    for transition in system.leaving(system.modes[0].name):
        if transition.direction == "both":
            continue
        values = [
            measured(f"guard of '{transition.name}'", transition.guard, time, state, p)
            for time, state in zip(t.tolist(), x, strict=True)
        ]
        past = min(values) if transition.direction == "falling" else -max(values)
        if past < 0.0:
            return True
    return False
