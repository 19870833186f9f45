"""A real multiplier at 1 or -1 along a branch on which the parameter stands still.

Its logarithm moves evenly there, over many powers of ten. Beside a homoclinic orbit of a saddle-focus it does
so between two points only: one multiplier goes from beyond 1 to beyond -1 while the other, which the product
of both holds, meets it on the way. Where no multiplier is positive, the product of what all lack to the
critical value tells on which side of the point an orbit is, and by how much.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.orbit.augmented import BESIDE, Augmented, where_zero
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Sample

# Displacements along the branch become shorter by this, down to the shortest, until the function changes by
# no more than one: its rate is that at the sample then.
SHORTER, SHORTEST = 0.1, 1e-11


def along_branch(problem: OrbitData, sample: Sample, multiplier: float) -> Augmented | None:
    """F = 0 and a real multiplier at 1 or -1 near a sample, along the branch; None where it has no rate."""
    sign, size = _apart(problem, sample.z, multiplier, (1.0, 0.0))[1:]

    def value(there: OrbitData, z: np.ndarray) -> float:
        return _apart(there, z, multiplier, (sign, size))[0]

    beside, here = BESIDE, value(problem, sample.z)
    while beside > SHORTEST:
        sides = (value(problem, sample.z + h * sample.tangent) for h in (beside, -beside))
        if max(abs(side - here) for side in sides) <= 1.0:
            break
        beside *= SHORTER
    system = where_zero(problem, sample, value, beside)
    # On other steps the branch is as far along as errors of the steps are worth, where the multiplier is
    # another by far.
    return None if system is None else replace(system, across=sample.tangent / sample.weights**2)


def _apart(
    problem: OrbitData, z: np.ndarray, multiplier: float, known: tuple[float, float]
) -> tuple[float, float, float]:
    """How far the nearest multiplier is from a critical value; sign and logarithm of what the others lack.

    `known` are these two at the sample.
    """
    values = problem.multipliers(z, problem.linearize(z).jacobian).values * multiplier
    nearest = int(np.argmin(np.abs(values - 1.0)))
    lacking = np.delete(values, nearest) - 1.0
    sign, logarithm = _product(lacking)
    own = complex(values[nearest])
    if own.imag == 0.0 < own.real:
        return float(np.log(own.real)), sign, logarithm
    side, size = known
    all_signs, all_sizes = _product(values - 1.0)
    far = all_sizes - size
    # asinh of the product in units of the others: itself where it is small, its logarithm where it is not
    grown = np.arcsinh(np.exp(far)) if far < 0.0 else far + np.log(1.0 + np.hypot(1.0, np.exp(-far)))
    return side * all_signs * float(grown), sign, logarithm


def _product(factors: np.ndarray) -> tuple[float, float]:
    """Sign and logarithm of the size of a product that is real."""
    with np.errstate(divide="ignore"):
        logarithm = float(np.sum(np.log(np.abs(factors))))
    negative = np.count_nonzero((factors.imag == 0.0) & (factors.real < 0.0))
    return (-1.0 if negative % 2 else 1.0), logarithm
