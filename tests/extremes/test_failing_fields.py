"""Fields that fail: no equilibrium, not a number, exceptions; each has one outcome and names the plugin's
line.
"""

import inspect
import math

import numpy as np
import pytest
from invariants import check_branch
from small_systems import small_problem

import contwalk as cw
from contwalk.errors import StartError


def no_root(t, x, p, dx):
    dx[0] = x[0] ** 2 + 1.0 + p.a


def root_of_parameter(t, x, p, dx):
    dx[0] = math.sqrt(p.a) - x[0]  # not finite


def pole(t, x, p, dx):
    dx[0] = p.a / x[0]  # not finite


def logarithm(t, x, p, dx):
    dx[0] = math.log(1.0 - p.a) - x[0]  # not finite


def refuses(t, x, p, dx):
    if p.a > 0.5:
        raise ValueError("too large a")  # raises
    dx[0] = p.a - x[0]


def always(t, x, p, dx):
    raise RuntimeError("always")  # raises


def _line(function, comment):
    lines, first = inspect.getsourcelines(function)
    return first + next(i for i, text in enumerate(lines) if comment in text)


def _names_line(text, function, comment):
    assert "test_failing_fields.py" in text
    assert f"line {_line(function, comment)}" in text


def test_a_start_without_an_equilibrium():
    problem = small_problem(no_root, "x", {"a": 0.0}, "a")
    for start in ([1.0], [0.0], [1e6]):
        with pytest.raises(StartError, match="does not converge"):
            cw.continue_branch(problem, start, (-0.5, 1.0))
        with pytest.raises(StartError, match="does not converge"):
            next(cw.points(problem, start, (-0.5, 1.0)))


def test_a_start_that_is_not_finite():
    problem = small_problem(pole, "x", {"a": 1.0}, "a")
    with pytest.raises(StartError, match="not finite") as caught:
        cw.continue_branch(problem, [0.0], (-1.0, 2.0))
    _names_line(str(caught.value), pole, "# not finite")


@pytest.mark.parametrize(("field", "start", "edge"), [(root_of_parameter, 1.0, 0.0), (logarithm, -1.0, 1.0)])
def test_not_finite_on_the_way(field, start, edge):
    state = math.sqrt(start) if field is root_of_parameter else math.log(1.0 - start)
    problem = small_problem(field, "x", {"a": start}, "a")
    branch = cw.continue_branch(problem, [state], (-1.5, 2.0))
    check_branch(branch, problem)
    if field is root_of_parameter:
        assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
        _names_line(branch.outcome.message, field, "# not finite")
    else:  # x falls without bound before the logarithm is not finite
        assert (branch.outcome.status, branch.outcome.reason) == ("complete", "unbounded")
    assert {q.kind for q in branch.special_points} == {"bound", branch.outcome.reason}
    # Everything up to the edge is there.
    assert abs(branch["a"][0 if field is root_of_parameter else -1] - edge) < 0.05


def test_an_exception_on_the_way():
    problem = small_problem(refuses, "x", {"a": 0.0}, "a")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 2.0))
    check_branch(branch, problem)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "plugin_error")
    assert "ValueError: too large a" in branch.outcome.message
    _names_line(branch.outcome.message, refuses, "# raises")
    assert branch["a"][0] == -1.0
    assert 0.45 < branch["a"][-1] <= 0.5


def test_an_exception_from_the_first():
    with pytest.raises(cw.ContwalkError, match="RuntimeError: always") as caught:
        cw.continue_branch(small_problem(always, "x", {"a": 0.0}, "a"), [0.0], (-1.0, 2.0))
    _names_line(str(caught.value), always, "# raises")


def test_an_end_that_is_a_corner_of_the_branch():
    """x' = |x| - lambda has its solutions x = +-lambda end in a corner at zero; there is nothing on the
    other side.
    """

    def field(t, x, p, dx):
        dx[0] = p.lam - abs(x[0])

    problem = small_problem(field, "x", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [1.0], (-1.0, 2.0))
    assert branch.outcome.status == "failed"
    assert branch.outcome.reason in ("step_too_small", "no_convergence")
    assert np.all(branch["lam"] >= 0.0)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_start_state_that_is_no_number(value):
    problem = small_problem(refuses, "x", {"a": 0.0}, "a")
    with pytest.raises(cw.ContwalkError):
        cw.continue_branch(problem, [value], (-1.0, 2.0))


def test_a_start_outside_the_range():
    problem = small_problem(refuses, "x", {"a": 0.25}, "a")
    with pytest.raises(cw.ContwalkError):
        cw.continue_branch(problem, [0.25], (0.3, 0.4))


def test_a_misspelt_free_parameter():
    with pytest.raises(cw.ContwalkError, match="'b'"):
        small_problem(refuses, "x", {"a": 0.0}, "b")


def test_a_mark_of_nothing_known():
    problem = small_problem(refuses, "x", {"a": 0.0}, "a")
    with pytest.raises(cw.ContwalkError, match="speed"):
        cw.continue_branch(problem, [0.0], (-1.0, 0.4), marks={"speed": [1.0]})


def test_an_unknown_setting():
    problem = small_problem(refuses, "x", {"a": 0.0}, "a")
    with pytest.raises((cw.ContwalkError, TypeError), match="stepp"):
        cw.continue_branch(problem, [0.0], (-1.0, 0.4), stepp=0.1)
