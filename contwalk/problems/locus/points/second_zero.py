"""A second eigenvalue that vanishes where one does all along a curve: with one vector (BT), or with its own.

With two columns and rows as borders of F_u - s E, chosen for its two smallest singular values, the corner
G(s) of the inverse, (2, 2), has det G = 0 at eigenvalues. Where that vanishes all along, d det G / ds = 0 is
a second one, whether or not the two have one vector together (Govaerts 2000, section 4.1).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.numerics.linear import balanced
from contwalk.problems.locus.plane import Place
from contwalk.problems.locus.points.point import located_by
from contwalk.problems.problem import Located, Sample

# The second singular value against the first, below which there are two vectors.
TWO_VECTORS = 1e-8


def second_zero(problem: Any, sample: Sample) -> Located | None:
    """The point of a curve near a sample at which a second eigenvalue vanishes."""
    plane = problem.plane
    if plane.size < 2:
        return None
    scaled, d = balanced(plane.jacobian(problem.in_plane(sample.z))[:, : plane.size])
    u, _, vh = np.linalg.svd(scaled)
    columns, rows = u[:, -2:] * d[:, None], vh[-2:] / d

    def function(place: Place, told: Any, own: Any) -> Any:
        return _rate(place, columns, rows)

    own = [problem.own(sample.z)] * problem.curve.own
    return located_by(problem, problem.augmented, sample, own, function)


def _rate(place: Place, columns: np.ndarray, rows: np.ndarray) -> Any:
    """d det G / ds at s = 0."""
    bordered = np.block([[place.matrix, columns], [rows, np.zeros((2, 2))]])
    size, finite = len(bordered) - 2, place.plane.finite
    units = np.eye(size + 2)[size:]
    right, left = zip(*(place.solved(bordered, unit, unit) for unit in units), strict=True)
    g = [[right[j][size + i] for j in (0, 1)] for i in (0, 1)]
    slopes = [[left[i][:size] @ (finite * right[j][:size]) for j in (0, 1)] for i in (0, 1)]
    return g[0][0] * slopes[1][1] + g[1][1] * slopes[0][0] - g[0][1] * slopes[1][0] - g[1][0] * slopes[0][1]


def two_vectors(problem: Any, z: np.ndarray) -> bool:
    """Whether a double zero at z, shape (N + 1,), has two vectors."""
    scaled = balanced(problem.plane.jacobian(problem.in_plane(z))[:, : problem.plane.size])[0]
    values = np.linalg.svd(scaled, compute_uv=False)
    return bool(len(values) > 1 and values[-2] <= TWO_VECTORS * values[0])
