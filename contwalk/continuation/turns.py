"""How the parameter moves along a branch: its share of the tangent, and when that tells of a turn."""

from __future__ import annotations

import numpy as np

from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample

# Below this share of the parameter in the unit tangent, its sign is rounding noise.
NO_SHARE = 1e-9
# At a branch point the tangent comes from second derivatives at a point that is known to about this.
FAINT_SHARE = 1e-6
# With a smaller share of the parameter than the first a branch goes straight up; than the second, it turns.
FLAT, NEARLY_FLAT = 1e-7, 1e-3


def share_of(sample: Sample, tangent: np.ndarray | None = None) -> float:
    """The parameter's share of the unit tangent, zero where it is noise.

    `tangent`, of shape (N + 1,), is that of a branch point.
    """
    if tangent is not None:
        return float(at_branch_point(tangent, sample.weights)[-1] / sample.weights[-1])
    return sample.share if abs(sample.share) > NO_SHARE else 0.0


def at_branch_point(tangent: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """A tangent at a branch point, shape (N + 1,), without a share of the parameter that is noise.

    The sign of that noise would tell of a fold beside the pitchfork.
    """
    if abs(tangent[-1] / weights[-1]) > FAINT_SHARE * np.linalg.norm(tangent / weights):
        return tangent
    return np.append(tangent[:-1], 0.0)


def multipliers_tell(segment: Segment, low: float, high: float) -> bool:
    """Whether the parameter stands still between two positions, and multipliers tell what lies there.

    Along an explosion of cycles its share of the tangent is rounding, and turns elsewhere than they say, by
    far more than it takes them to go from beyond 1 to beyond -1.
    """
    p, q = segment.at(low), segment.at(high)
    still = max(abs(share_of(p)), abs(share_of(q))) <= FLAT and not segment.vertical
    return segment.problem.meshed is not None and still and p.unstable != q.unstable


def only_noise(segment: Segment, low: float, high: float) -> bool:
    """Whether the parameter's share between two positions tells nothing but errors of the equations.

    Along an explosion of cycles the parameter stands still to these errors, while solutions move on: they
    alone turn it. At a fold of its own an eigenvalue would pass its critical value.
    """
    ends = [segment.at(theta) for theta in (low, high)]
    errors = np.nan_to_num([end.error for end in ends])
    share = max(abs(end.share) for end in ends)
    if segment.problem.meshed is None or share > float(errors.sum()) / max(segment.length, 1e-300):
        return False
    certain = [np.abs(end.measures) > end.errors for end in ends]
    return ends[0].unstable == ends[1].unstable and bool(np.all(certain[0] == certain[1]))
