"""Points that only a function of their own tells: found in pairs too, and looked for where they may be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from made_up import MadeUp, at

from contwalk.continuation.zeros_of_test_functions import zeros_of_test_functions
from contwalk.problems.problem import Located, PointType, Sample
from contwalk.problems.problem import Test as Told


class Zero(PointType):
    """A polynomial of x with these zeros, on the branch lam = x + x^3."""

    label, test = "XX", Told.VALUE

    def __init__(self, zeros: Sequence[float], of_place: bool = True) -> None:
        self.zeros, self.of_place = zeros, of_place

    def value(self, problem: MadeUp, sample: Sample) -> float:
        return float(np.prod(sample.z[0] - np.array(self.zeros)))

    def locate(self, problem: MadeUp, sample: Sample, which: int) -> Located | None:
        x = min(self.zeros, key=lambda zero: abs(zero - sample.z[0]))
        return at(x, x + x**3)


def curve(kind: Zero) -> MadeUp:
    problem = MadeUp(lambda z: [z[1] - z[0] - z[0] ** 3], lambda z: [[-1.0 - 3.0 * z[0] ** 2, 1.0]])
    problem.point_types = (kind,)
    return problem


@pytest.mark.parametrize("of_place", [True, False])
@pytest.mark.parametrize("zeros", [(0.2,), (0.2, 0.23), (0.11, 0.12), (0.05, 0.3), (0.31, 0.39)])
def test_zeros_alone_and_in_pairs(zeros, of_place) -> None:
    problem = curve(Zero(zeros, of_place))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    assert [f.located.z[0] for f in zeros_of_test_functions(segment)] == list(zeros)


def test_no_solution_is_computed_where_a_function_of_places_passes_nothing() -> None:
    problem = curve(Zero((-1.0, 2.0)))
    segment = problem.segment([0.0, 0.0], [0.4, 0.464])
    before = problem.evaluated
    assert zeros_of_test_functions(segment) == []
    assert problem.evaluated == before
