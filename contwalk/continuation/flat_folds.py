"""Folds at which an eigenvalue passes zero while the parameter hardly moves, as along explosions."""

from __future__ import annotations

import numpy as np

from contwalk.continuation.kinds import crossed, kind_of_test
from contwalk.continuation.locating import Disagreement, Found, first_accepted
from contwalk.continuation.segment import Segment
from contwalk.continuation.turns import FLAT, NEARLY_FLAT
from contwalk.problems.problem import Located, Sample, Test

# What is said where an eigenvalue passes zero along a branch on which the parameter stands still.
SECOND = (
    "A second real eigenvalue passes zero on a branch along which the parameter stands still: the branch "
    "turns back in a state, and no other one leaves there. The place is told as it is bracketed."
)


def flat_fold(segment: Segment, low: float, high: float, crossings: list[tuple[float, int]]) -> Found:
    """The fold at which an eigenvalue passes zero while the parameter hardly moves.

    In an explosion of cycles the parameter may turn by less than it is known to: then the fold is where the
    eigenvalue passes, and known along the branch as well as that is.
    """
    ends = [segment.at(theta) for theta in (low, high)]
    share = max(abs(end.share) for end in ends)
    kind = kind_of_test(segment.problem, Test.TURN)
    if share > FLAT:
        _refuse_jump(segment, ends, crossings[0][1])
        likely = kind if share < NEARLY_FLAT else kind_of_test(segment.problem, Test.ORIENTATION)
        raise Disagreement(
            likely, "A real eigenvalue passes zero where there is no fold and no branch point."
        )
    theta, which = crossings[0]
    sample, width = segment.at(theta), abs(float(segment.chord[-1]))
    if segment.vertical:  # every point of it solves the equations of a fold
        known = max(width, float(np.spacing(abs(sample.parameter))))
        located = Located(sample.z, known, {"note": SECOND}, refined=False)
        return Found(theta, kind, located, sample, kind="unlocated")
    around = min(doubt(segment.at(low), segment.at(high), which), 1.0)
    fold = first_accepted(segment, (*kind.flat, kind), sample, which, low - around, high + around)
    if fold is not None:
        return fold
    note = "A real eigenvalue passes zero, and the parameter turns by less than it is known to."
    return Found(
        theta, kind, Located(sample.z, width, {"note": note}, refined=False), sample, kind="unlocated"
    )


def _refuse_jump(segment: Segment, ends: list[Sample], which: int) -> None:
    """Refuse an eigenvalue that is critical on neither side, as where a field or a reset bends.

    Where its unstable side is no real eigenvalue's, the point is of the kind of that side.

    Raises
    ------
    Disagreement
    """
    kind = crossed(segment.problem, max(ends, key=lambda end: float(end.measures[which])), which)
    if kind is None:
        return
    beside = [complex(end.eigenvalues[which]) for end in ends]
    values = " and ".join(f"{value if value.imag else value.real:.4g}" for value in beside)
    raise Disagreement(
        kind, f"An eigenvalue jumps over what is critical: it is {values} beside it, as where equations bend."
    )


def doubt(p: Sample, q: Sample, which: int) -> float:
    """How far from its point a real eigenvalue may seem to pass its critical value, in parts of the
    segment.
    """
    known = max((s.spectrum_error or 0.0) + np.nan_to_num(s.trivial_error) for s in (p, q))
    change = abs(float(p.measures[which] - q.measures[which]))
    return 1e-3 + 10.0 * known / max(change, 1e-300)
