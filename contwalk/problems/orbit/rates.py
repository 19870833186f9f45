"""How fast multipliers and observables of an orbit change along its branch."""

from __future__ import annotations

import numpy as np

from contwalk import quantities
from contwalk.problems.orbit import variations
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.sample import Rates, Sample

# Rates are computed of multipliers whose moduli lie between these: a pair of crossings may hide between two
# points far from the unit circle.
LEAST, MOST = 0.4, 1e8
# Displacement along the branch, in the metric, for the rate of an observable.
BESIDE = 1e-4


def of_moduli(problem: OrbitData, z: np.ndarray, tangent: np.ndarray, found: Multipliers) -> Rates:
    """Derivative of each modulus by arclength; NaN where it is far from one.

    z and tangent have the shape (N + 1,).
    """
    known: dict[int, float] = {}

    def rate(k: int) -> float:
        value = complex(found.values[k])
        if not LEAST < abs(value) < MOST:
            return float("nan")
        paired = k > 0 and value.imag != 0.0 and value == np.conj(found.values[k - 1])
        first = k - 1 if paired else k
        if first not in known:
            known[first] = of_modulus(problem, z, tangent, complex(found.values[first]), pair(first))
        return known[first]

    def pair(k: int) -> bool:
        return any(some is not None and bool(some[k]) for some in (found.paired, found.bordering))

    return Rates(len(found.values), rate)


def of_modulus(
    problem: OrbitData, z: np.ndarray, tangent: np.ndarray, value: complex, paired: bool = False
) -> float:
    """Derivative of |mu| along the branch, exact on the steps of a smooth field: mu' = psi* L_s v / psi* v.

    Of one of a pair mu, 1/mu that of |mu + 1/mu| / 2.

    z and tangent have the shape (N + 1,).
    """
    if problem.at_kinks(z) is not problem:
        return _by_difference(problem, z, tangent, value, paired)
    multiplier = value if value.imag else value.real
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, multiplier)
    v, psi = null_vectors(problem, matrix, *cycle_scales(problem))
    moved = variations.cycle_rate(problem, z, v.real, tangent).astype(complex)
    if np.iscomplexobj(v):
        moved += 1j * variations.cycle_rate(problem, z, v.imag, tangent)
    scale = variations.cycle_return(problem, psi, v)
    if scale == 0.0:
        return float("nan")
    rate = complex(psi.conj() @ moved) / scale
    if paired:
        half = 0.5 * (rate * (1.0 - value**-2)).real
        return float(np.sign((value + 1.0 / value).real) * half)
    return float((np.conj(value) * rate).real / abs(value))


def _by_difference(
    problem: OrbitData, z: np.ndarray, tangent: np.ndarray, value: complex, paired: bool
) -> float:
    """As `of_modulus` where the field bends: second derivatives of the motion are not all that moves."""

    def measure(displaced: np.ndarray) -> float:
        there = problem.at_kinks(displaced)
        values = there.multipliers(displaced, there.linearize(displaced).jacobian).values
        own = complex(values[np.argmin(np.abs(values - value))])
        return float(0.5 * abs((own + 1.0 / own).real) if paired else abs(own))

    ahead, behind = (measure(z + h * tangent) for h in (BESIDE, -BESIDE))
    return (ahead - behind) / (2.0 * BESIDE)


def of_observable(problem: OrbitData, name: str, sample: Sample) -> float:
    """Derivative of an observable along the branch.

    An observable is any function of the motion, so it is compared for the motions displaced along the
    tangent to both sides; `max_abs` and the period have exact derivatives.
    """
    if name == quantities.PERIOD:
        return float(problem.duration_gradient(sample.z) @ sample.tangent)
    if name == problem.observable_names[-1]:
        value, rate = complex(sample.eigenvalues[0]), sample.rates[0]
        if not np.isfinite(rate):
            rate = of_modulus(problem, sample.z, sample.tangent, value)
        return problem.rounds * abs(value) ** (problem.rounds - 1) * rate
    ahead, behind = (problem.observable(name, sample.z + h * sample.tangent) for h in (BESIDE, -BESIDE))
    return (ahead - behind) / (2.0 * BESIDE)
