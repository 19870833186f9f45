"""A smooth function along a segment that vanishes where more than one branch passes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.continuation.folds import NO_SHARE
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.numerics.linear import Factored, critical_pair, deficiency, solution_plane
from contwalk.problems.problem import Sample


def singularity(segment: Segment, p: Sample, q: Sample) -> Callable[[Sample], float]:
    """A smooth function that vanishes where [DF; tangent] is singular.

    It is the corner of the inverse of that matrix bordered once more: by the left critical vector of F_u,
    and by the direction of the other branch, both taken at the end at which F_u is nearer to being singular.
    """
    size = len(segment.chord)

    nearer, critical, plane = _nearer(segment, p, q)
    basis, _ = np.linalg.qr(plane / segment.weights[:, None])
    own = nearer.tangent / segment.weights
    along = basis.T @ own
    other = basis @ np.array([-along[1], along[0]])  # in the plane, at a right angle to this branch
    right, left = other / segment.weights, np.append(critical, 0.0)

    def value(sample: Sample) -> float:
        bordered = np.zeros((size + 1, size + 1))
        bordered[: size - 1, :size] = segment.problem.linearize(sample.z).jacobian
        bordered[size - 1, :size] = sample.tangent / sample.weights**2
        bordered[:size, size] = left
        bordered[size, :size] = right
        try:
            return float(Factored(bordered).solve(np.append(np.zeros(size), 1.0))[size])
        except np.linalg.LinAlgError:
            raise LostBranch("The border of the branch point test is singular.") from None

    return value


def _nearer(segment: Segment, p: Sample, q: Sample) -> tuple[Sample, np.ndarray, np.ndarray]:
    """Of two samples the one nearer to a branch point, the left critical vector there, and the directions of
    solutions.

    The critical vector is that of F_u; where the parameter stands still F_u is singular everywhere, and it is
    DF's.
    """
    jacobians = [segment.problem.jacobian(sample.z) for sample in (p, q)]
    if max(abs(p.share), abs(q.share)) <= NO_SHARE:
        found = [deficiency(jacobian, segment.weights) for jacobian in jacobians]
        nearer = int(found[1].value < found[0].value)
        return (p, q)[nearer], found[nearer].left, found[nearer].plane
    pairs = [critical_pair(jacobian[:, :-1]) for jacobian in jacobians]
    nearer = int(abs(pairs[1].value) < abs(pairs[0].value))
    try:
        plane = solution_plane(jacobians[nearer], pairs[nearer])
    except np.linalg.LinAlgError:
        raise LostBranch("The directions of solutions are not determined.") from None
    return (p, q)[nearer], pairs[nearer].left.real, plane
