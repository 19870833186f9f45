"""One curve, however it is walked: up, down, both ways, from elsewhere, or point by point."""

import numpy as np
import pytest
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw


def cusp(t, x, p, dx):
    dx[0] = p.a + p.b * x[0] - x[0] ** 3
    dx[1] = -x[1] + x[0]


def _problem(a=-2.0):
    return small_problem(cusp, "xy", {"a": a, "b": 1.0}, "a")


def _start(x):
    return x**3 - x, [x, x]


def _folds(branch):
    return [(q.parameters["a"], q.state["x"]) for q in bifurcations(branch)]


@pytest.mark.long
def test_a_branch_followed_up_and_back_gives_the_same_points():
    low, state = _start(-1.6)
    high, top = _start(1.6)
    up = cw.continue_branch(_problem(low), state, (low, high), direction="forward")
    back = cw.continue_branch(_problem(high), top, (low, high), direction="backward")
    for branch, problem in ((up, _problem(low)), (back, _problem(high))):
        check_branch(branch, problem)
        assert branch.outcome.reason == "bound"
    assert np.all(up["s"] >= 0.0)
    assert np.all(back["s"] <= 0.0)
    # Special points are refined beyond floats: the same numbers, whichever way they were met.
    assert _folds(up) == _folds(back)
    assert [(q.unstable_before, q.unstable_after) for q in bifurcations(up)] == [(0, 1), (1, 0)]
    assert [(q.unstable_before, q.unstable_after) for q in bifurcations(back)] == [(0, 1), (1, 0)]
    for branch in (up, back):
        assert (branch["a"][0], branch["a"][-1]) == (low, high)
        assert branch["x"][[0, -1]] == pytest.approx([-1.6, 1.6], rel=1e-14)


@pytest.mark.long
def test_both_directions_are_the_two_single_ones():
    low, high = _start(-1.6)[0], _start(1.6)[0]
    value, state = _start(0.1)
    problem = _problem(value)
    both = cw.continue_branch(problem, state, (low, high))
    forward = cw.continue_branch(problem, state, (low, high), direction="forward")
    backward = cw.continue_branch(problem, state, (low, high), direction="backward")
    for branch in (both, forward, backward):
        check_branch(branch, problem)
    joined = np.concatenate([backward["x"], forward["x"][1:]])
    assert np.array_equal(both["x"], joined)
    assert _folds(both) == _folds(backward) + _folds(forward)
    assert len(_folds(both)) == 2


def test_forward_from_an_unstable_start_means_growing_parameter():
    value, state = _start(0.1)
    branch = cw.continue_branch(_problem(value), state, (-2.0, 2.0), direction="forward")
    check_branch(branch, _problem(value))
    assert branch["a"][1] > branch["a"][0]


def test_the_iterator_gives_the_points_of_the_branch():
    value, state = _start(0.1)
    problem = _problem(value)
    for forward, direction in ((True, "forward"), (False, "backward")):
        branch = cw.continue_branch(problem, state, (-2.0, 2.0), direction=direction)
        found = list(cw.points(problem, state, (-2.0, 2.0), forward=forward))
        values = [q.state.sample.parameter for q in found]
        assert values == branch["a"][:: 1 if forward else -1].tolist()
        records = [q.special.label for q in found if q.special is not None]
        assert records == [q.label for q in bifurcations(branch)][:: 1 if forward else -1]


def test_the_iterator_can_be_left_early():
    value, state = _start(-1.6)
    steps = cw.points(_problem(value), state, (-3.0, 3.0))
    first = [next(steps) for _ in range(3)]
    steps.close()
    assert first[0].state.s == 0.0
    assert first[1].state.s < first[2].state.s


@pytest.mark.long
def test_the_engine_settings_do_not_move_special_points():
    value, state = _start(-1.6)
    problem = _problem(value)
    usual = cw.continue_branch(problem, state, (-3.0, 3.0))
    for settings in (
        {"max_step": 0.02},
        {"max_angle": 5.0},
        {"step": 1e-4},
        {"max_step": 0.5, "max_angle": 60.0},
    ):
        other = cw.continue_branch(problem, state, (-3.0, 3.0), **settings)
        assert _folds(other) == _folds(usual)


@pytest.mark.parametrize("direction", ["sideways", "", "up"])
def test_an_unknown_direction_is_refused(direction):
    value, state = _start(-1.6)
    with pytest.raises(cw.ContwalkError, match="Allowed: both, forward, backward"):
        cw.continue_branch(_problem(value), state, (-3.0, 3.0), direction=direction)


@pytest.mark.parametrize("state", [[1.0], [1.0, 2.0, 3.0], {"x": 1.0}])
def test_a_state_of_the_wrong_size_is_refused(state):
    with pytest.raises(cw.ContwalkError, match="state"):
        cw.continue_branch(_problem(), state, (-3.0, 3.0))
