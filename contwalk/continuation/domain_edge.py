"""Where the equations cease to have a value as the parameter goes on."""

from __future__ import annotations

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.problems.problem import Problem, Sample, equations_at

# An edge this near, in magnitudes of the parameter, is reached: along roots of the way to it solutions would
# pile up before it, a step each.
REACHED = 1e-12


def reached(problem: Problem, sample: Sample) -> bool:
    """Whether the equations have no value right ahead of a solution, where only the parameter changes."""
    z = sample.z.copy()
    z[-1] += np.copysign(REACHED * sample.weights[-1], sample.tangent[-1])
    try:
        with np.errstate(all="ignore"):
            return not equations_at(problem, z)[1].finite
    except ContwalkError:
        return True
