"""Which of a problem's kinds of special points a test tells."""

from __future__ import annotations

from contwalk.branch import SpecialPoint
from contwalk.problems.problem import PointType, Problem, Sample, Test


def kinds_of_test(problem: Problem, test: Test) -> tuple[PointType, ...]:
    """The kinds of points that a test tells, in the problem's order."""
    return tuple(kind for kind in problem.point_types if kind.test is test)


def kind_of_test(problem: Problem, test: Test) -> PointType:
    """The kind of points that a test tells.

    Raises
    ------
    LookupError
        If the problem has none.
    """
    for kind in problem.point_types:
        if kind.test is test:
            return kind
    raise LookupError(f"{problem.kind} has no kind of point that is told by: {test.value}")


def crossed(problem: Problem, sample: Sample, which: int) -> PointType | None:
    """The kind of point at which stability measure `which` passes zero; None where other tests tell it."""
    kinds = kinds_of_test(problem, Test.STABILITY)
    return next((kind for kind in kinds if kind.tells(problem, sample, which)), None)


def pair(problem: Problem) -> PointType:
    """The kind of point that most eigenvalues pass at together: a complex pair."""
    return max(kinds_of_test(problem, Test.STABILITY), key=lambda kind: max(kind.changes))


def turning_or_pair(problem: Problem) -> PointType:
    """The kind of point at which the parameter turns; along a curve in two parameters, where a turn is none,
    that of a complex pair.
    """
    return next(iter(kinds_of_test(problem, Test.TURN)), None) or pair(problem)


def kind_of(problem: Problem, point: SpecialPoint) -> PointType | None:
    """The kind of a stored point; None if the problem has no such points."""
    return next((kind for kind in problem.point_types if kind.has(point)), None)
