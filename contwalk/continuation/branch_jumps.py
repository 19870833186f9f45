"""Whether a step ended on its own branch, or on another one that lies beside it and points the same way.

The chord of a smooth step departs from the mean direction of the tangents at its ends by h^2 k' / 12, where h
is the step's length and k' the rate of its curvature: by a sixth of the turn where a bend begins in the step,
by far less elsewhere. A step onto a branch at the distance d departs by d / h. Both may be of one size;
but half of a step is departed from by a quarter of the first, and by twice the second. So a step in doubt is
halved.
"""

from __future__ import annotations

import math

import numpy as np

from contwalk.continuation.arc import Arc
from contwalk.continuation.newton import correct
from contwalk.continuation.segment import Segment

# What smooth steps stay below: parts of the turn; and where they do not turn, what rounding makes of a chord.
OF_TURN, NO_TURN = 0.1, 1e-5
# Newton's method takes more iterations where its guess lies between two branches.
EASY = 3
# What a half departs by, in parts of what the whole does: by less than the first it is smooth, by more than
# the second it has jumped.
QUARTERED, NOT_LESS = 0.35, 0.75
# So often a part in doubt is halved; and after many iterations, where the shape of the whole tells nothing.
HALVINGS, LABORIOUS = 3, 2


def jumped(segment: Segment, iterations: int) -> bool:
    """Whether a step seems to have left its branch; it is looked at closely only where its shape is odd.

    Parameters
    ----------
    segment : Segment
        The step as it would be taken.
    iterations : int
        What the corrector took.
    """
    laborious = iterations > EASY
    known = sum(error for error in (segment.a.error, segment.b.error) if math.isfinite(error))
    if _smooth(segment, known) and not laborious:
        return False
    return _jumped(segment, segment, known, HALVINGS, LABORIOUS if laborious else 0)


def _jumped(segment: Segment, arc: Arc, known: float, halvings: int, at_least: int) -> bool:
    """Whether the halves of a part are no smoother than it, or the halves of these."""
    if halvings == 0:
        return False
    halves = _halves(segment, arc)
    if halves is None:
        return True
    odd = [half for half in halves if not _smooth(half, known) and half.departure > QUARTERED * arc.departure]
    if any(half.departure > NOT_LESS * arc.departure for half in odd):
        return True
    doubtful = odd if at_least <= 1 else halves
    return any(_jumped(segment, half, known, halvings - 1, at_least - 1) for half in doubtful)


def _smooth(arc: Arc, known: float) -> bool:
    """Whether an arc, whose ends are known to `known`, departs by no more than smooth ones do."""
    return arc.departure <= max(OF_TURN * arc.turn, NO_TURN, known / max(arc.length, 1e-300))


def _halves(segment: Segment, arc: Arc) -> tuple[Arc, Arc] | None:
    """The parts of an arc before and after its middle; None where there is no solution."""
    middle = correct(segment.problem, arc.guess(0.5), arc.normal, arc.weights)
    if not middle.ok or middle.linearization is None:
        return None
    try:
        tangent = middle.linearization.tangent(arc.normal, arc.weights)
    except np.linalg.LinAlgError:
        return None
    (a, b), (before, after) = arc.ends, arc.tangents
    return Arc((a, middle.z), (before, tangent), arc.weights), Arc(
        (middle.z, b), (tangent, after), arc.weights
    )
