"""How long steps are, what makes one shorter, and what is said where none succeeds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from made_up import LINE, MadeUp, at, circle, line, parabola, pitchfork

from contwalk.branch import Outcome
from contwalk.continuation import control
from contwalk.continuation.attempt import predict
from contwalk.continuation.marks import Observer
from contwalk.continuation.returns import place_of_closure
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.continuation.step import take_step

RANGE = Settings(range=(-2.0, 2.0), step=0.1, max_step=0.5, max_share=1.0)
OBSERVER = Observer(LINE, ())


def on_circle(problem, angle):
    z = (math.cos(angle), math.sin(angle))
    return problem.sample(z, (-z[1], z[0]))


def here(problem, z, toward, step=0.1):
    return ContinuationState(problem.sample(z, toward), 0.0, step)


# -- measures of a step --------------------------------------------------------------------------------------


def test_the_turn_of_an_arc_is_its_angle():
    a, b = on_circle(circle(), 0.3), on_circle(circle(), 0.3 + math.radians(17.0))
    assert control.turn(a, b.tangent) == pytest.approx(17.0, rel=1e-12)
    assert control.turn(a, -b.tangent) == pytest.approx(163.0, rel=1e-12)


def test_the_turn_is_measured_in_the_metric():
    """Stretched tenfold in x, a tangent of 45 degrees turns to atan(1/10)."""
    a = replace(on_circle(circle(), 0.0), weights=np.array([10.0, 1.0]))
    degrees = math.degrees(math.atan2(0.1, 1.0))
    assert control.turn(a, np.array([1.0, 1.0])) == pytest.approx(degrees, rel=1e-12)


def test_the_bend_of_an_arc_is_an_eighth_of_the_square_of_its_turn():
    """On a circle the chord is parallel to the mean of the tangents, which is cos(turn / 2) long."""
    a = on_circle(circle(), 0.3)
    for turn in (0.05, 0.2):
        b = on_circle(circle(), 0.3 + turn)
        assert control.bend(a, b.z, b.tangent) == pytest.approx(1.0 - math.cos(turn / 2.0), rel=1e-9)
        assert control.bend(a, b.z, b.tangent) == pytest.approx(turn**2 / 8.0, rel=1e-2)


def test_an_arc_from_a_branch_point_is_a_parabola_or_goes_elsewhere():
    fold = parabola()
    begin = here(fold, (0.0, 0.0), (1.0, 0.0)).sample
    h = 0.8
    assert control.turn(begin, np.array([1.0, 2.0 * h])) > 50.0
    assert control.is_parabola(begin, np.array([h, h**2]), np.array([1.0, 2.0 * h]))
    # The slope of another branch, and a branch behind.
    assert not control.is_parabola(begin, np.array([h, h**2]), np.array([1.0, 1.5 * h]))
    assert not control.is_parabola(begin, np.array([-h, h**2]), np.array([1.0, -2.0 * h]))


def test_a_step_onto_a_parallel_line_bends():
    """The tangents are the same; the chord is at 45 degrees to both."""
    a = line(lambda z: [-1.0]).sample((0.0, 0.0), (0.0, 1.0))
    assert control.bend(a, np.array([0.1, 0.1]), a.tangent) == pytest.approx(2.0 * math.sin(math.pi / 8.0))


def test_the_next_step_aims_at_half_the_largest_angle():
    settings = replace(RANGE, max_angle=20.0, min_step=1e-6, max_step=10.0)
    assert control.next_step(1.0, 10.0, 2, settings) == pytest.approx(1.0)
    assert control.next_step(1.0, 20.0, 2, settings) == pytest.approx(0.5)
    assert control.next_step(1.0, 8.0, 1, settings) == pytest.approx(1.25)
    # Factors are held between 0.3 and 1.6, and steps between the smallest and the largest.
    assert control.next_step(1.0, 1000.0, 2, settings) == pytest.approx(0.3)
    assert control.next_step(1.0, 0.0, 0, settings) == pytest.approx(1.6)
    assert control.next_step(9.0, 0.0, 0, settings) == 10.0
    assert control.next_step(2e-6, 1000.0, 2, settings) == 1e-6


def test_much_effort_makes_the_next_step_shorter_however_straight_the_branch():
    steps = [control.next_step(0.1, 0.0, iterations, RANGE) for iterations in range(7)]
    assert steps == sorted(steps, reverse=True)
    assert steps[3] > 0.1 > steps[4]


def test_after_failures_steps_shrink_and_faster_where_they_are_small():
    assert control.shrunk(1.0) == pytest.approx(0.4)
    assert control.shrunk(1e-7) == pytest.approx(1e-8)


def test_the_longest_step_moves_the_parameter_by_its_share_of_the_range():
    settings = Settings(range=(-1.0, 3.0), max_share=1.0 / 64.0)
    sample = on_circle(circle(), 0.5)
    longest = control.longest(sample, settings)
    assert longest * abs(sample.tangent[-1]) == pytest.approx(4.0 / 64.0, rel=1e-14)
    flat = replace(sample, tangent=np.array([1.0, 0.0]))
    assert control.longest(flat, settings) == math.inf


@pytest.mark.parametrize("share", [1.0 / 8.0, 1.0 / 64.0])
def test_no_step_of_a_walk_moves_the_parameter_by_more_than_its_share(share):
    """`max_share` of the range: steps of a straight branch are exactly that, but for the last one."""
    from small_systems import small_problem

    import contwalk as cw

    def field(t, x, p, dx):
        dx[0] = p.mu - x[0]

    problem = small_problem(field, "x", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0], (0.0, 4.0), max_share=share, max_step=10.0, step=1.0)
    moved = np.diff(branch["mu"])
    # The remainder of a thousandth of a step is not left over.
    assert moved.max() <= 4.0 * share * 1.001
    assert moved[3:-1] == pytest.approx(4.0 * share, rel=1e-9)


# -- prediction ----------------------------------------------------------------------------------------------


def test_a_guess_lies_on_the_tangent_and_an_end_of_the_range_is_met_exactly():
    start = here(circle(), (1.0, 0.0), (0.0, 1.0))
    there = predict(start, 0.1, RANGE)
    assert there.guess == pytest.approx([1.0, 0.1])
    assert not there.to_bound
    settings = replace(RANGE, range=(-2.0, 0.07))
    there = predict(start, 0.1, settings)
    assert there.to_bound
    assert there.guess[-1] == 0.07
    assert there.length == pytest.approx(0.07)
    # Facing the other way, the other end counts.
    back = here(circle(), (1.0, 0.0), (0.0, -1.0))
    assert not predict(back, 0.1, settings).to_bound


def test_a_remainder_of_a_thousandth_of_a_step_is_not_left_over():
    start = here(circle(), (1.0, 0.0), (0.0, 1.0))
    assert predict(start, 0.1, replace(RANGE, range=(-2.0, 0.10005))).to_bound
    assert not predict(start, 0.1, replace(RANGE, range=(-2.0, 0.102))).to_bound


# -- steps ---------------------------------------------------------------------------------------------------


def test_a_step_solves_the_equations_and_turns_no_more_than_allowed():
    step = take_step(
        circle(), here(circle(), (1.0, 0.0), (0.0, 1.0), step=0.5), replace(RANGE, max_angle=5.0), OBSERVER
    )
    z = step.there.z
    assert abs(z @ z - 1.0) <= 1e-15
    assert math.degrees(math.atan2(z[1], z[0])) <= 5.0
    assert 0.0 < step.next_length <= 0.5


def test_the_end_of_the_range_is_exact():
    settings = replace(RANGE, range=(-2.0, 0.07))
    step = take_step(circle(), here(circle(), (1.0, 0.0), (0.0, 1.0)), settings, OBSERVER)
    assert step.there.parameter == 0.07
    assert step.there.z[0] == pytest.approx(math.sqrt(1.0 - 0.07**2), abs=1e-15)


def test_a_branch_that_turns_before_the_end_of_its_range_is_followed_round():
    """lam = 1 - x^2 with the range up to 1.001: it turns at 1 and never gets to its end."""
    turning = MadeUp(
        lambda z: [1.0 - z[0] ** 2 - z[1]], lambda z: [[-2.0 * z[0], -1.0]], special={"LP": [at(0.0, 1.0)]}
    )
    place, found = here(turning, (-0.1, 0.99), (1.0, 0.0)), []
    for _ in range(5):
        step = take_step(turning, place, replace(RANGE, range=(-2.0, 1.001)), OBSERVER)
        found += [f.label for f in step.found]
        place = ContinuationState(step.there, 0.0, step.next_length)
    assert found == ["LP"]
    assert place.sample.z[0] > 0.1


def test_a_step_does_not_land_on_the_branch_beside():
    """Three lines x = g, g + 0.1 and g + 0.2, where g falls from 0 to -0.17 round lam = 0.

    A long step along the first one ends beside the third, which points the same way and has the same
    orientation; nothing but its chord tells.
    """

    def g(lam):
        return -0.085 * (1.0 + math.tanh(100.0 * lam))

    def f(z):
        return [math.prod(z[0] - g(z[1]) - k for k in (0.0, 0.1, 0.2)) * 100.0]

    def df(z):
        factors = [z[0] - g(z[1]) - k for k in (0.0, 0.1, 0.2)]
        slope = 100.0 * sum(math.prod(factors[:i] + factors[i + 1 :]) for i in range(3))
        return [[slope, slope * 8.5 / math.cosh(100.0 * z[1]) ** 2]]

    problem = MadeUp(f, df, lambda z: [-1.0])
    place = here(problem, (0.0, -0.1), (0.0, 1.0), step=0.2)
    settings = replace(RANGE, range=(-0.1, 0.1))
    for _ in range(400):
        step = take_step(problem, place, settings, OBSERVER)
        assert step.there.z[0] == pytest.approx(g(step.there.parameter), abs=1e-12)
        if step.there.parameter == 0.1:
            return
        place = ContinuationState(step.there, 0.0, step.next_length)
    raise AssertionError("the end of the range was not reached")


def test_where_the_field_ends_the_step_says_so_with_its_last_good_point():
    def f(z):
        return [math.nan if z[1] > 0.05 else z[0] - z[1]]

    problem = MadeUp(f, lambda z: [[1.0, -1.0]])
    start = here(problem, (0.0, 0.0), (1.0, 1.0))
    found = take_step(problem, start, replace(RANGE, min_step=1e-5), OBSERVER)
    while not isinstance(found, Outcome):
        found = take_step(
            problem,
            ContinuationState(found.there, 0.0, found.next_length),
            replace(RANGE, min_step=1e-5),
            OBSERVER,
        )
    assert (found.status, found.reason) == ("failed", "not_finite")
    assert "lam = 0.0" in found.message
    place = float(found.message.split("lam = ")[1].split(" ")[0].rstrip(";,."))
    assert 0.05 - 1e-5 <= place <= 0.05


def test_a_corner_stops_the_walk_with_a_reason():
    """lam = |x| has no tangent at zero: no step past it turns little enough."""
    problem = MadeUp(lambda z: [abs(z[0]) - z[1]], lambda z: [[math.copysign(1.0, z[0]), -1.0]])
    found = here(problem, (0.3, 0.3), (-1.0, -1.0))
    settings = replace(RANGE, min_step=1e-4)
    for _ in range(60):
        step = take_step(problem, found, settings, OBSERVER)
        if isinstance(step, Outcome):
            assert (step.status, step.reason) == ("failed", "step_too_small")
            assert step.message.endswith(".")
            return
        found = ContinuationState(step.there, 0.0, step.next_length)
    raise AssertionError("the corner was passed")


def test_what_cannot_be_located_is_kept_at_the_smallest_step_only():
    """A pair crosses, and there is no Hopf point: first steps shrink, then the point is told as unlocated."""
    problem = line(lambda z: [z[1] - 0.05 + 1j, z[1] - 0.05 - 1j])
    place, settings = here(problem, (0.0, 0.0), (0.0, 1.0)), replace(RANGE, min_step=1e-3)
    kinds, lengths = [], []
    for _ in range(200):
        step = take_step(problem, place, settings, OBSERVER)
        kinds += [(f.label, f.kind, f.before, f.after) for f in step.found]
        lengths.append(step.segment.length)
        if step.there.parameter > 0.06:
            break
        place = ContinuationState(step.there, 0.0, step.next_length)
    assert kinds == [("HB", "unlocated", 0, 2)]
    assert min(lengths) == pytest.approx(1e-3, rel=1e-6)


def test_a_walk_closes_where_it_comes_back_the_same_way_round():
    problem = circle(special={"LP": [at(0.0, 1.0), at(0.0, -1.0)]}, eigenvalues=lambda z: [z[0]])
    origin = here(problem, (1.0, 0.0), (0.0, 1.0), step=0.2)
    place, closed = origin, []
    for _ in range(60):
        step = take_step(problem, place, RANGE, OBSERVER)
        closed.append(place_of_closure(step.segment, step.found, origin.sample) is not None)
        place = ContinuationState(step.there, 0.0, step.next_length)
        if closed[-1] and len(closed) > 3:
            break
    angle = math.atan2(place.sample.z[1], place.sample.z[0])
    assert closed[-1]
    assert 0.0 <= angle <= 0.5
    assert not any(closed[:-1])
    # The same place the other way round is no closure: a branch that runs into itself crosses.
    against = here(problem, (1.0, 0.0), (0.0, -1.0))
    assert place_of_closure(step.segment, step.found, against.sample) is None


def test_a_fold_and_a_branch_point_of_a_walk_come_in_their_order():
    problem = pitchfork()
    step = take_step(problem, here(problem, (0.0, -0.04), (0.0, 1.0), step=0.1), RANGE, OBSERVER)
    assert [(f.label, f.before, f.after) for f in step.found] == [("BP", 0, 1)]
    fold = parabola()
    step = take_step(fold, here(fold, (-0.04, 0.0016), (1.0, 0.0), step=0.1), RANGE, OBSERVER)
    assert [(f.label, f.before, f.after) for f in step.found] == [("LP", 1, 0)]
