"""Where the largest real part has a kink, few solutions tell that it has no extremum there."""

import cmath
import math

import pytest

from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.settings import Mark
from contwalk.problems.problem import MAX_RE
from tests.continuation.test_marks_along_steps import LINE, places, segment_of, straight

KINK = 0.17
OBSERVER = Observer(LINE, (MAX_RE,))


def pair_that_meets(lam):
    """-1 - 0.3 lam -+ sqrt(lam - KINK), and one far away."""
    apart = cmath.sqrt(lam - KINK)
    return [-1.0 - 0.3 * lam + apart, -1.0 - 0.3 * lam - apart, -5.0]


def two_pairs(lam):
    """Two pairs of real parts -0.5 -+ (lam - KINK), at frequencies 1 and 3."""
    rise = lam - KINK
    return [-0.5 - rise + 1j, -0.5 - rise - 1j, -0.5 + rise + 3j, -0.5 + rise - 3j]


def smooth(lam):
    """A pair whose real part is least at the place, and one far away."""
    return [-0.5 + (lam - KINK) ** 2 + 1j, -0.5 + (lam - KINK) ** 2 - 1j, -5.0]


def avoided(lam):
    """Two real ones that come near to each other: the larger one is least, smoothly, where they do."""
    apart = math.sqrt((lam - KINK) ** 2 + 1e-6)
    return [-1.0 + apart, -1.0 - apart]


def segment_with(eigenvalues, low=0.0, high=0.3):
    problem = straight(**{MAX_RE: lambda z: max(v.real for v in eigenvalues(z[1]))})
    problem.eigenvalues = lambda z: eigenvalues(z[1])
    # As problems tell it: of the one that leads, where central differences would look across the kink.
    problem.rate = lambda name, sample: sample.rates[sample.leading]
    return segment_of(problem, low, high)


@pytest.mark.parametrize("eigenvalues", [pair_that_meets, two_pairs], ids=["meets", "two pairs"])
@pytest.mark.parametrize("backwards", [False, True], ids=["forwards", "backwards"])
def test_a_kink_takes_few_solutions(eigenvalues, backwards):
    """Narrowed to rounding it takes 40 solutions and more; to a thousandth 11."""
    course = (lambda lam: eigenvalues(0.3 - lam)) if backwards else eigenvalues
    segment = segment_with(course)
    assert marked(segment, (Mark(MAX_RE, (), True),), OBSERVER) == []
    assert len(segment._known) <= 14


@pytest.mark.parametrize("eigenvalues", [smooth, avoided])
def test_a_smooth_extremum_is_no_kink(eigenvalues):
    segment = segment_with(eigenvalues)
    found = marked(segment, (Mark(MAX_RE, (), True),), OBSERVER)
    # Rates are central differences of step 1e-6: rounding 1e-10 of them over a slope of two or more.
    assert len(found) == 1
    assert abs(places(found)[0] - KINK) <= 1e-9
