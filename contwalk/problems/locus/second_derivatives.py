"""Second derivatives of an orbit's equations in the plane of two parameters.

Each orbit is known on lines: along the first parameter, the second, or a direction of both. A derivative by
both is what is left of that along a direction when those along both axes are taken away.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.orbit import variations


def known(orbit: Any, z: np.ndarray) -> bool:
    """Whether an orbit at its unknowns z, shape (N + 1,), has second derivatives: not where soft transitions
    are condensed, or the field bends.
    """
    return not isinstance(orbit, SoftEquations) and orbit.at_kinks(z) is orbit


def of_products(
    plane: Any, place: np.ndarray, which: int, psi: np.ndarray, vectors: np.ndarray, sizes: np.ndarray
) -> np.ndarray:
    """Derivatives of psi DF v by (u, second, first), shape (m, N + 2).

    Parameters
    ----------
    plane : OrbitPlane
    place : ndarray, shape (N + 2,)
        (u, second, first).
    which : int
        DF is by the unknowns and the first parameter, 0, or the second one, 1.
    psi : ndarray, shape (N,)
    vectors : ndarray, shape (m, N + 1)
    sizes : ndarray, shape (2,)
        Typical magnitudes of the second and of the first parameter.
    """
    n = plane.size
    own, other = (plane.on_lines(place)[k] for k in (which, 1 - which))
    at_own, at_other = (np.append(place[:n], place[-1 - k]) for k in (which, 1 - which))
    mixed = float(psi @ by_both(plane, place, sizes))
    along_other = np.append(np.zeros(n), 1.0)
    rows = np.zeros((len(vectors), n + 2))
    for row, v in zip(rows, vectors, strict=True):
        by_own = psi @ variations.derivative_along(own, at_own, v)
        row[:n], row[-1 - which] = by_own[:n], by_own[n]
        moved = variations.cycle_rate(other, at_other, v[:n], along_other)
        row[-2 + which] = float(psi @ moved) + mixed * v[n]
    return rows


def by_both(plane: Any, place: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The second derivative of F by both parameters, shape (N,); arguments as of `of_products`."""
    n, (second, first) = plane.size, sizes
    unit, rates = np.append(np.zeros(n), 1.0), np.concatenate([np.zeros(n), sizes])
    lines = (plane.on_tangent(place, rates), *plane.on_lines(place))
    places = (np.append(place[:n], at) for at in (0.0, place[-1], place[-2]))
    along, by_first, by_second = (
        variations.rate_along(line, z, unit, unit) for line, z in zip(lines, places, strict=True)
    )
    return np.asarray((along - first**2 * by_first - second**2 * by_second) / (2.0 * first * second))
