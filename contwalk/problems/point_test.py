"""What tells that a special point lies between two neighbouring solutions."""

from __future__ import annotations

from enum import Enum


class Test(Enum):
    """What tells that a special point lies between two neighbouring solutions.

    Every curve of solutions has the first three, so that the engine computes them; a kind of point that they
    do not tell has a function of its own.
    """

    TURN = "the parameter's share of the unit tangent changes its sign"
    ORIENTATION = "the sign of det [DF; tangent] changes"
    STABILITY = "a stability measure passes zero"
    TOGETHER = "stability measures are zero together, unseen by the orientation"
    VALUE = "the function `value` of the kind passes zero"
    MARGIN = "what must stay positive for solutions to be the machine's passes zero"
    MARK = "the user asks for it"
    END = "the branch ends there"
