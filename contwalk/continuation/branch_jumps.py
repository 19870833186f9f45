"""Whether a step ended on its own branch, or on another one that lies beside it and points the same way.

The chord of a smooth step departs from the mean direction of the tangents at its ends by h^2 k' / 12, where
h is the step's length and k' the rate of its curvature; a step onto a branch at the distance d departs by
d / h. Both may be of one size. But half of a step is departed from by a quarter of the first, and by twice
the second: a step in doubt is halved.

Where the curvature begins, or the tangent jumps, as where a soft transition comes into being, the half with
the corner departs as far as the whole. There it is walked to its middle from both of its ends. From the ends
of a branch these two walks meet; from two branches they do not, as soon as the part is so short that a
tangent tells the two apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contwalk.continuation import control
from contwalk.continuation.attempt import Cause, Prediction, Refusal
from contwalk.continuation.newton import correct
from contwalk.continuation.segment import Segment
from contwalk.continuation.settings import Settings
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Problem, Sample

# What smooth steps stay below: parts of the turn; and where they do not turn, what rounding makes of a chord.
OF_TURN, NO_TURN = 0.1, 1e-5
# Newton's method takes more iterations where its guess lies between two branches.
EASY = 4
# A smooth half departs by less than this part of what the whole does.
QUARTERED = 0.35
# A chord between the directions of two tangents departs from their mean by less than this part of the turn.
BETWEEN = 0.5
# So often a part in doubt is halved; what is in doubt then is taken for a corner.
HALVINGS = 8
# Two walks meet if they end this near to one another: in parts of how far the part's ends are beside each
# other, in what solutions are known to, and in the metric.
MEET, KNOWN, NEAR = 1e-2, 100.0, 1e-7
# A step this short, in the metric, is not doubted: a branch nearer than a fiftieth of it is none beside it.
SHORT = 1e-4
ELSEWHERE = "The step does not lie along the branch: it may have left it for another one."


@dataclass(frozen=True)
class _Middle:
    """A solution across the middle of an arc, and the branch's tangent there; shapes (N + 1,)."""

    z: np.ndarray
    tangent: np.ndarray


def misshapen(
    a: Sample, z: np.ndarray, tangent: np.ndarray, prediction: Prediction, settings: Settings, shorter: bool
) -> Refusal | None:
    """Why a step is refused on which the branch turns too much, or that may have ended on another branch.

    z, where it ends, and the tangent there have the shape (N + 1,). Where longer ones have led to the
    parabola that a branch begins as, what is none is errors: `shorter`.
    """
    cause, angle = Cause.BLURRED if shorter else Cause.TURNS, control.turn(a, tangent)
    moved = norm_in(z - prediction.guess, a.weights)
    if angle > settings.max_angle or moved > 0.5 * prediction.length:
        parabola = a.orientation == 0.0 and not prediction.to_bound and control.is_parabola(a, z, tangent)
        sentence = f"The branch turns by {angle:.0f} degrees in one step."
        return Refusal(Cause.PARABOLA if parabola else cause, sentence)
    return Refusal(cause, ELSEWHERE) if control.left_branch(a, z, tangent, angle) else None


def jumped(segment: Segment, effort: float) -> bool:
    """Whether a step seems to have left its branch; it is looked at closely only where its shape is odd.

    Parameters
    ----------
    segment : Segment
        The step as it would be taken.
    effort : float
        How many corrections it took. Many are odd as well: between two branches the shape may tell nothing.
    """
    known = sum(error for error in (segment.a.error, segment.b.error) if math.isfinite(error))
    laborious = effort > EASY
    # Where it departs by less than its ends are known to, nothing can be told.
    if segment.length < SHORT or segment.departure <= _nothing(segment, known):
        return False
    if not laborious and _smooth(segment, known):
        return False
    arc = HermiteCurve(segment.ends, segment.tangents, segment.weights)
    for halving in range(HALVINGS):
        middle = None if halving > 0 or laborious else _across(segment.problem, arc, arc.guess(0.5))
        if middle is None:
            before, after = _from_both_ends(segment.problem, arc)
            if before is None or after is None:
                # No wonder beside another branch; nor at a sharp corner, of which the chord lies between the
                # tangents, and which is easily passed.
                return laborious or arc.departure > BETWEEN * arc.turn
            near = max(MEET * arc.departure * arc.length, KNOWN * known, NEAR)
            if norm_in(after.z - before.z, arc.weights) > near:
                return True
            middle = before
        half = max(_parts(arc, middle), key=lambda part: part.departure)
        if half.departure < max(QUARTERED * arc.departure, _nothing(half, known)):
            return False
        if not laborious and _smooth(half, known):
            return False
        arc = half
    return False


def _nothing(arc: HermiteCurve, known: float) -> float:
    """What an arc, whose ends are known to `known`, may depart by for no reason."""
    return max(NO_TURN, known / max(arc.length, 1e-300))


def _smooth(arc: HermiteCurve, known: float) -> bool:
    """Whether an arc departs by no more than smooth ones do."""
    return arc.departure <= max(OF_TURN * arc.turn, _nothing(arc, known))


def _from_both_ends(problem: Problem, arc: HermiteCurve) -> list[_Middle | None]:
    """Where walks from an arc's ends, along their tangents, come to its middle; None where one does not."""
    shares = (0.5, -0.5)
    ends = zip(arc.ends, arc.tangents, shares, strict=True)
    guesses = [end + share * tangent / float(arc.normal @ tangent) for end, tangent, share in ends]
    return [_across(problem, arc, guess) for guess in guesses]


def _across(problem: Problem, arc: HermiteCurve, guess: np.ndarray) -> _Middle | None:
    """The solution near a guess in the plane across an arc's middle; None where none is found."""
    found = correct(problem, guess, arc.normal, arc.weights)
    tangent = found.tangent(arc.normal, arc.weights)
    return None if tangent is None else _Middle(found.z, tangent)


def _parts(arc: HermiteCurve, middle: _Middle) -> tuple[HermiteCurve, HermiteCurve]:
    """The parts of an arc before and after its middle."""
    (a, b), (before, after) = arc.ends, arc.tangents
    return (
        HermiteCurve((a, middle.z), (before, middle.tangent), arc.weights),
        HermiteCurve((middle.z, b), (middle.tangent, after), arc.weights),
    )
