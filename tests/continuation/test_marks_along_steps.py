"""Marked values and extrema on a segment: each once, where it is, and what is none is not told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from made_up import LINE, MadeUp, at, line

from contwalk.continuation.marks import (
    Observer,
    _extremum_error,
    _parameter_at,
    marked,
)
from contwalk.continuation.settings import Mark
from contwalk.diagram.start_marks import marks_at, place_error
from contwalk.problems.parameter_line import ParameterLine

PARAMETER = Observer(LINE, ())


def straight(**observe):
    """x = 0 along lam, with observables of lam."""
    return line(lambda z: [-1.0], observe=observe)


def segment_of(problem, a, b):
    return problem.segment((0.0, a), (0.0, b))


def places(found):
    return [float(f.located.z[-1]) for f in found]


def test_a_value_of_the_parameter_is_met_exactly():
    found = marked(segment_of(straight(), 0.0, 0.3), (Mark("lam", (0.1,)),), PARAMETER)
    assert places(found) == [0.1]
    assert [(f.label, f.kind) for f in found] == [("UZ", "parameter")]
    assert found[0].theta == pytest.approx(1.0 / 3.0)


def test_values_come_in_the_order_of_the_branch():
    marks = (Mark("lam", (0.05, 0.25, 0.1)),)
    assert places(marked(segment_of(straight(), 0.0, 0.3), marks, PARAMETER)) == [0.05, 0.1, 0.25]
    assert places(marked(segment_of(straight(), 0.3, 0.0), marks, PARAMETER)) == [0.25, 0.1, 0.05]


def test_a_birth_is_no_extremum():
    """What is seen along a branch that is born is alike on both sides of its birth, but for rounding."""
    problem = straight(size=lambda z: (z[1] - 1e-5) ** 2)
    observer, marks = Observer(LINE, ("size",)), (Mark("size", (), extremum=True),)
    segment = segment_of(problem, 0.0, 0.3)
    assert [f.kind for f in marked(segment, marks, observer)] == ["extremum"]
    assert marked(segment, marks, observer, turns=[0.0]) == []


def test_a_value_at_a_joint_of_two_segments_is_met_once():
    marks = (Mark("lam", (0.1,)),)
    before = marked(segment_of(straight(), 0.0, 0.1), marks, PARAMETER)
    after = marked(segment_of(straight(), 0.1, 0.2), marks, PARAMETER)
    assert places(before) == [0.1]
    assert after == []
    assert marked(segment_of(straight(), 0.11, 0.2), marks, PARAMETER) == []


def test_a_value_of_an_observable_is_where_its_equation_is_solved():
    problem = straight(height=lambda z: math.exp(z[1]))
    problem.special["height"] = [at(0.0, math.log(1.2))]
    observer = Observer(LINE, ("height",))
    found = marked(segment_of(problem, 0.0, 0.3), (Mark("height", (1.2,)),), observer)
    assert places(found) == [math.log(1.2)]
    assert found[0].kind == "observable"


@pytest.mark.parametrize("wrong", [(0.0, 0.9), (0.01, math.log(1.2))], ids=["elsewhere", "not on the branch"])
def test_a_solution_that_is_not_there_is_not_told(wrong):
    problem = straight(height=lambda z: math.exp(z[1]))
    problem.special["height"] = [at(*wrong)]
    observer = Observer(LINE, ("height",))
    assert marked(segment_of(problem, 0.0, 0.3), (Mark("height", (1.2,)),), observer) == []


def test_what_a_problem_does_not_have_is_no_mark():
    assert marked(segment_of(straight(), 0.0, 0.3), (Mark("max_abs", (1.0,), True),), PARAMETER) == []


def test_a_smooth_extremum_is_found_with_an_error_that_covers():
    problem = straight(height=lambda z: math.cos(3.0 * (z[1] - 0.17)))
    observer = Observer(LINE, ("height",))
    found = marked(segment_of(problem, 0.0, 0.3), (Mark("height", (), True),), observer)
    assert [f.kind for f in found] == ["extremum"]
    # The rate is a difference with a step of 1e-5: rounding 1e-11 of it, over its slope of nine.
    assert abs(places(found)[0] - 0.17) <= found[0].located.error
    assert found[0].located.error <= 1e-10


def test_a_kink_is_no_extremum():
    problem = straight(height=lambda z: -abs(z[1] - 0.17))
    problem.slopes["height"] = lambda z: math.copysign(1.0, 0.17 - z[1])
    observer = Observer(LINE, ("height",))
    assert marked(segment_of(problem, 0.0, 0.3), (Mark("height", (), True),), observer) == []


def test_where_the_branch_turns_nothing_is_extreme():
    problem = straight(height=lambda z: (z[1] - 0.15) ** 2)
    observer = Observer(LINE, ("height",))
    segment = segment_of(problem, 0.0, 0.3)
    assert len(marked(segment, (Mark("height", (), True),), observer)) == 1
    assert marked(segment, (Mark("height", (), True),), observer, turns=[0.5]) == []


def test_on_a_path_a_parameter_is_a_line():
    """c = 2 + 3 path: c = 2.3 is path = 0.1, to the rounding of the division."""
    observer = Observer(ParameterLine("path", {"c": 2.0}, ({"c": 2.0}, {"c": 5.0})), ())
    found = marked(segment_of(straight(), 0.0, 0.3), (Mark("c", (2.3,)),), observer)
    assert places(found) == pytest.approx([0.1], abs=1e-16)
    assert found[0].kind == "parameter"


def test_marks_that_a_start_has_itself():
    problem = straight(height=lambda z: math.exp(z[1]))
    observer = Observer(LINE, ("height",))
    sample = problem.sample((0.0, 0.1), (0.0, 1.0))
    marks = (Mark("lam", (0.1, 0.2)), Mark("height", (float(np.exp(0.1)), 7.0)))
    assert marks_at(problem, sample, marks, observer) == [
        ("parameter", ("lam", 0.1)),
        ("observable", ("height", float(np.exp(0.1)))),
    ]
    beside = problem.sample((0.0, 0.1 * (1.0 + 1e-14)), (0.0, 1.0))
    assert marks_at(problem, beside, (Mark("lam", (0.1,)),), observer) == []


def test_the_error_of_a_mark_at_the_start_covers_where_the_value_is_the_same_to_rounding():
    """cos(3 lam) is one wherever 9 lam^2 / 2 is less than half a unit of it: up to 5e-9."""
    problem = straight(wave=lambda z: math.cos(3.0 * z[1]), height=lambda z: math.exp(z[1]))
    touched = problem.sample((0.0, 0.0), (0.0, 1.0))
    same = math.sqrt(np.finfo(float).eps / 9.0)
    assert math.cos(3.0 * 0.7 * same) == 1.0
    assert same < place_error(problem, touched, ("wave", 1.0)) < 50.0 * same
    crossed = problem.sample((0.0, 0.1), (0.0, 1.0))
    assert 1e-16 < place_error(problem, crossed, ("height", float(np.exp(0.1)))) < 1e-12
    assert place_error(problem, crossed, ("lam", 0.1)) == np.spacing(0.1)
    still = straight(same=lambda z: 2.0)
    assert place_error(still, crossed, ("same", 2.0)) == np.spacing(0.1)


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_the_error_of_an_extremum_at_an_end_of_a_step_is_told_by_what_is_beside_it(end):
    """The slope of sin at a zero of cos, at the very end: a cubic beside it has it to 1e-9 of a chord."""
    top = 0.5 * math.pi
    segment = segment_of(straight(), *((top, top + 0.1) if end == 0.0 else (top - 0.1, top)))
    error, sloping = _extremum_error(segment, end, lambda sample: math.cos(sample.parameter))
    assert sloping
    assert error < 1e-12


def test_the_solution_at_a_value_of_the_parameter_is_looked_for_along_the_branch():
    """y = 2 + 50 x^2 with x = lam, and the same pi higher, 2 pi higher and so on: the nearest is meant."""

    def f(z):
        return [z[0] - z[2], math.sin(z[1] - 2.0 - 50.0 * z[0] ** 2)]

    def df(z):
        slope = math.cos(z[1] - 2.0 - 50.0 * z[0] ** 2)
        return [[1.0, 0.0, -1.0], [-100.0 * z[0] * slope, slope, 0.0]]

    segment = MadeUp(f, df).segment((0.1, 2.5, 0.1), (0.3, 6.5, 0.3))
    located = _parameter_at(segment, 0.2, segment.a)
    assert located is not None
    assert located.z.tolist() == pytest.approx([0.2, 4.0, 0.2], rel=1e-15)


def test_a_quantity_that_stands_still_has_no_extremum():
    """Rates of rounding change their sign: the modulus of a pair where the flow contracts evenly."""
    problem = straight(pair=lambda z: 1.0 + 1e-13 * (z[1] - 0.1) ** 2)
    observer, marks = Observer(LINE, ("pair",)), (Mark("pair", (), extremum=True),)
    assert marked(segment_of(problem, 0.0, 0.3), marks, observer) == []


def test_an_extremum_exactly_at_a_joint_or_at_the_start_is_told_once():
    problem = straight(size=lambda z: z[1] ** 2, cube=lambda z: z[1] ** 3)
    observer = Observer(LINE, ("size", "cube"))
    marks = (Mark("size", (), extremum=True), Mark("cube", (), extremum=True))
    assert places(marked(segment_of(problem, -0.1, 0.0), marks, observer)) == [0.0]
    assert marked(segment_of(problem, 0.0, 0.2), marks, observer) == []
    start = segment_of(problem, 0.0, 0.2).a
    assert marks_at(problem, start, marks, observer) == [("extremum", ("size", None))]


def test_the_error_of_an_extremum_has_what_is_left_of_the_rate():
    problem = straight(size=lambda z: math.cos(z[1]))
    observer, marks = Observer(LINE, ("size",)), (Mark("size", (), extremum=True),)
    for a, b in ((-0.1, 0.15), (-0.3, 0.17), (-0.07, 0.2)):
        (found,) = marked(segment_of(problem, a, b), marks, observer)
        assert abs(places([found])[0]) <= found.located.error
