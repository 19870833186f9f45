"""Whether the largest stability measure has a kink between two solutions, where it is another eigenvalue's.

Either another eigenvalue takes the lead, or a leading pair meets on the real axis and comes apart into two
real ones. The rate of the largest measure jumps there, to infinity in the second case.
"""

from __future__ import annotations

import numpy as np

from contwalk.problems.problem import Sample

# Eigenvalues are told from each other where one moves by less than this part of their distance.
APART = 0.01


def has_kink(a: Sample, b: Sample) -> bool:
    """Whether what leads at `b` is for certain something else than at `a`, and all moves evenly in between.

    The rates of what leads have different signs at the two ends, and that comes of the kink alone: then the
    largest measure has no smooth extremum in between. Where this is not certain the answer is no.
    """
    if a.still or b.still or not (len(a.eigenvalues) == len(b.eigenvalues) > 1):
        return False
    if not a.rates[0] * b.rates[0] < 0.0:
        return False
    parts = a.eigenvalues[0].imag != 0.0, b.eigenvalues[0].imag != 0.0
    if parts == (True, False):
        return _comes_apart(a, b, 1.0)
    if parts == (False, True):
        return _comes_apart(b, a, -1.0)
    return _another_leads(a, b)


def _another_leads(a: Sample, b: Sample) -> bool:
    """Whether two eigenvalues that are far from each other change places, each moving on as it did."""
    upper_a, upper_b = _upper(a.eigenvalues), _upper(b.eigenvalues)
    own_b = int(np.argmin(np.abs(upper_b - upper_a[0])))
    own_a = int(np.argmin(np.abs(upper_a - upper_b[0])))
    moved = max(abs(upper_b[own_b] - upper_a[0]), abs(upper_a[own_a] - upper_b[0]))
    if not moved < APART * abs(upper_b[0] - upper_a[0]):
        return False
    return a.rates[0] * b.rates[own_b] > 0.0 and a.rates[own_a] * b.rates[0] > 0.0


def _comes_apart(pair: Sample, real: Sample, way: float) -> bool:
    """Whether the leading pair of one solution is the first two eigenvalues, real ones, of the other.

    Their mean is a smooth function of the place, and so is the square of half their difference, which is
    negative for a pair. Where these move evenly the larger real one moves faster the nearer it is to the
    kink, and stands nowhere. `way` is -1 where the real ones come first.
    """
    if real.eigenvalues[1].imag != 0.0:
        return False
    means = pair.eigenvalues[0].real, float(np.mean(real.eigenvalues[:2].real))
    others = np.concatenate([pair.eigenvalues[2:] - means[0], real.eigenvalues[2:] - means[1]])
    if not abs(means[1] - means[0]) <= APART * float(np.min(np.abs(others), initial=np.inf)):
        return False
    first, second = real.rates[0], real.rates[1]
    return way * first > 0.0 and way * (first - second) > 0.0 and (first + second) * pair.rates[0] > 0.0


def _upper(eigenvalues: np.ndarray) -> np.ndarray:
    """One of each pair, of positive imaginary part."""
    return eigenvalues.real + 1j * np.abs(eigenvalues.imag)
