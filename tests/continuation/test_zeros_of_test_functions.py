"""Points that only a function of their own tells: found in pairs too, and looked for where they may be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from made_up import MadeUp, at

from contwalk.continuation.locating import Disagreement
from contwalk.continuation.zeros_of_test_functions import zeros_of_test_functions
from contwalk.problems.problem import Located, PointType, Sample
from contwalk.problems.problem import Test as Told


class Zero(PointType):
    """A polynomial of x with these zeros, on the branch lam = x + x^3."""

    label, test = "XX", Told.VALUE

    def __init__(self, zeros: Sequence[float], of_place: bool = True, dear: bool = False) -> None:
        self.zeros, self.of_place, self.dear, self.asked = zeros, of_place, dear, 0

    def value(self, problem: MadeUp, sample: Sample) -> float:
        self.asked += 1
        return float(np.prod(sample.z[0] - np.array(self.zeros)))

    def locate(self, problem: MadeUp, sample: Sample, which: int) -> Located | None:
        x = min(self.zeros, key=lambda zero: abs(zero - sample.z[0]))
        return at(x, x + x**3)


def curve(kind: Zero) -> MadeUp:
    problem = MadeUp(lambda z: [z[1] - z[0] - z[0] ** 3], lambda z: [[-1.0 - 3.0 * z[0] ** 2, 1.0]])
    problem.point_types = (kind,)
    return problem


@pytest.mark.parametrize(("of_place", "dear"), [(True, False), (False, False), (True, True)])
@pytest.mark.parametrize("zeros", [(0.2,), (0.2, 0.23), (0.11, 0.12), (0.05, 0.3), (0.31, 0.39)])
def test_zeros_alone_and_in_pairs(zeros, of_place, dear) -> None:
    problem = curve(Zero(zeros, of_place, dear))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    assert [f.located.z[0] for f in zeros_of_test_functions(segment)] == list(zeros)


def test_no_solution_is_computed_where_a_function_of_places_passes_nothing() -> None:
    problem = curve(Zero((-1.0, 2.0)))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    before = problem.evaluated
    assert zeros_of_test_functions(segment) == []
    assert problem.evaluated == before


@pytest.mark.parametrize(("dear", "asked"), [(False, 5), (True, 3)])
def test_a_function_that_is_dear_and_far_from_zero_is_asked_at_fewer_places(dear, asked) -> None:
    kind = Zero((-1.0, 2.0), dear=dear)
    assert zeros_of_test_functions(curve(kind).segment([0.0, 0.0], [0.4, 0.464])) == []
    assert kind.asked == asked


class Pole(Zero):
    """The inverse of x - p, which has no value right at p: it changes its sign there, and is nowhere zero."""

    def value(self, problem: MadeUp, sample: Sample) -> float:
        apart = sample.z[0] - self.zeros[0]
        return 1.0 / apart if abs(apart) > 1e-6 else float("nan")


@pytest.mark.parametrize("share", [0.625, 0.5625, 0.6])
def test_a_pole_that_is_met_in_the_middle_of_a_bracket_is_no_zero(share) -> None:
    problem = curve(Zero(()))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    problem.point_types = (Pole((float(segment.at(share).z[0]),)),)
    assert zeros_of_test_functions(segment) == []


class Elsewhere(Zero):
    """A zero that Newton's method misses: it ends where the function is larger than at both ends."""

    def locate(self, problem: MadeUp, sample: Sample, which: int) -> Located | None:
        return at(0.2, 0.2 + 0.2**3)

    def value(self, problem: MadeUp, sample: Sample) -> float:
        return 50.0 if sample.z[0] == 0.2 else sample.z[0] - self.zeros[0]


def test_what_is_larger_than_beside_it_is_no_zero() -> None:
    problem = curve(Elsewhere((0.21,)))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    with pytest.raises(Disagreement):
        zeros_of_test_functions(segment)
