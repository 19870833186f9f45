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


def of_multipliers(problem: OrbitData, z: np.ndarray, tangent: np.ndarray, found: Multipliers) -> Rates:
    """Derivatives of multipliers and of their measures by arclength; NaN where a modulus is far from one.

    z and tangent have the shape (N + 1,).
    """
    known: dict[int, complex] = {}

    def of_value(k: int) -> complex:
        value = complex(found.values[k])
        if not LEAST < abs(value) < MOST:
            return complex("nan")
        paired = k > 0 and value.imag != 0.0 and value == np.conj(found.values[k - 1])
        first = k - 1 if paired else k
        if first not in known:
            known[first] = of_multiplier(problem, z, tangent, complex(found.values[first]))
        return known[first].conjugate() if paired else known[first]

    def of_values(which: np.ndarray) -> np.ndarray:
        return np.array([of_value(int(k)) for k in which], dtype=complex)

    def of_measure(k: int) -> float:
        pair = any(some is not None and bool(some[k]) for some in (found.paired, found.bordering))
        return measured(complex(found.values[k]), of_value(k), pair)

    return Rates(len(found.values), of_measure, of_values=of_values)


@np.errstate(invalid="ignore")  # an infinite multiplier has none
def measured(value: complex, rate: complex, paired: bool = False) -> float:
    """Derivative of the modulus of a multiplier mu with a rate; of one of a pair that of |mu + 1/mu| / 2."""
    if paired:
        half = 0.5 * (rate * (1.0 - value**-2)).real
        return float(np.sign((value + 1.0 / value).real) * half)
    return float((np.conj(value) * rate).real / abs(value))


def of_multiplier(problem: OrbitData, z: np.ndarray, tangent: np.ndarray, value: complex) -> complex:
    """Derivative of mu along the branch, exact on the steps of a smooth field: mu' = psi* L_s v / psi* v.

    z and tangent have the shape (N + 1,).
    """
    if problem.at_kinks(z) is not problem:
        return _by_difference(problem, z, tangent, value)
    multiplier = value if value.imag else value.real
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, multiplier)
    v, psi = null_vectors(problem, matrix, *cycle_scales(problem))
    moved = variations.cycle_rate(problem, z, v.real, tangent).astype(complex)
    if np.iscomplexobj(v):
        moved += 1j * variations.cycle_rate(problem, z, v.imag, tangent)
    scale = variations.cycle_return(problem, psi, v)
    return complex("nan") if scale == 0.0 else complex(psi.conj() @ moved) / complex(scale)


def _by_difference(problem: OrbitData, z: np.ndarray, tangent: np.ndarray, value: complex) -> complex:
    """As `of_multiplier` where the field bends: second derivatives of the motion are not all that moves."""

    def own(displaced: np.ndarray) -> complex:
        there = problem.at_kinks(displaced)
        values = there.multipliers(displaced, there.linearize(displaced).jacobian).values
        return complex(values[np.argmin(np.abs(values - value))])

    ahead, behind = (own(z + h * tangent) for h in (BESIDE, -BESIDE))
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
            rate = measured(value, of_multiplier(problem, sample.z, sample.tangent, value))
        return problem.rounds * abs(value) ** (problem.rounds - 1) * rate
    ahead, behind = (problem.observable(name, sample.z + h * sample.tangent) for h in (BESIDE, -BESIDE))
    return (ahead - behind) / (2.0 * BESIDE)
