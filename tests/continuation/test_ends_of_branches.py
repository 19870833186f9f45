"""How a branch ends when nothing goes wrong: bound, stop_at, max_points."""

import math

import numpy as np
import pytest
from invariants import check_branch
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.errors import StartError
from contwalk.system import Mode, Observable, Parameter, State, System


def line(t, x, p, dx):
    dx[0] = p.lam - x[0]


def _problem(value=0.0):
    square = Observable("square", lambda t, x, p: (x[:, 0] ** 2).max())
    return small_problem(line, "x", {"lam": value}, "lam", observables=(square,))


def test_the_range_ends_a_branch_exactly_there():
    branch = cw.continue_branch(_problem(), [0.0], (-0.3, 0.7))
    check_branch(branch, _problem())
    assert (branch["lam"][0], branch["lam"][-1]) == (-0.3, 0.7)
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "bound")
    assert [q.kind for q in labelled(branch, "EP")] == ["bound", "bound"]
    assert [q.error for q in labelled(branch, "EP")] == [0.0, 0.0]


def test_an_end_of_the_range_at_which_nothing_is_defined_ends_a_branch_all_the_same():
    def pulled_in(t, x, p, dx):  # lam = (1 - x) sqrt(x): the plates touch without a voltage, 0 / 0
        dx[0] = (p.lam / (1.0 - x[0])) ** 2 - x[0]

    problem = small_problem(pulled_in, "x", {"lam": 0.1}, "lam")
    branch = cw.continue_branch(problem, [0.01], (0.0, 1.0))
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "bound")
    (fold,) = labelled(branch, "LP")
    # folds are refined in forty digits
    assert fold.parameters["lam"] == pytest.approx(2.0 / 27.0**0.5, rel=1e-15)
    touching = max(labelled(branch, "EP"), key=lambda end: end.state["x"])
    assert "Reached the end of the range, lam = 0, but for " in touching.note
    assert 0.0 < touching.parameters["lam"] < 1e-12  # the shortest step, of which the parameter takes a part


def test_a_branch_without_an_end_is_refused():
    with pytest.raises(StartError, match="No range is given, and 'small' declares no bounds for lam"):
        cw.continue_branch(_problem(), [0.0])


def test_declared_bounds_end_a_branch_without_a_range():
    system = System(
        "bounded",
        states=(State("x"),),
        parameters=(Parameter("lam", 0.5, bounds=(0.25, 0.75)),),
        modes=(Mode("only", lambda t, x, p, dx: dx.__setitem__(0, p.lam - x[0])),),
    )
    branch = cw.continue_branch(cw.Equilibrium(system, {"lam": 0.5}, "lam"), [0.5])
    assert (branch["lam"][0], branch["lam"][-1]) == (0.25, 0.75)
    ends = {"lam": 0.25}, {"lam": 0.75}
    branch = cw.continue_branch(cw.Equilibrium(system, ends[0], "path", ends), [0.25])
    assert (branch["path"][0], branch["path"][-1]) == (0.0, 1.0)


@pytest.mark.parametrize("value", [-0.3, 0.7])
def test_a_start_at_an_end_of_the_range(value):
    branch = cw.continue_branch(_problem(value), [value], (-0.3, 0.7))
    check_branch(branch, _problem(value))
    assert (branch["lam"][0], branch["lam"][-1]) == (-0.3, 0.7)
    assert branch.outcome.reason == "bound"


@pytest.mark.parametrize(
    ("name", "level", "expected"), [("lam", 0.25, 0.25), ("square", 0.16, 0.4), ("lam", [0.5, 0.125], 0.125)]
)
def test_stop_at(name, level, expected):
    values = tuple(level) if isinstance(level, list) else (level,)
    branch = cw.continue_branch(_problem(), [0.0], (-1.0, 1.0), direction="forward", stop_at={name: values})
    check_branch(branch, _problem())
    assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "stop_at")
    assert branch["lam"][-1] == pytest.approx(expected, rel=1e-15)
    assert name in branch.outcome.message
    stop = labelled(branch, "UZ")[-1]
    assert stop.index == len(branch) - 1
    assert labelled(branch, "EP")[-1].kind == "stop_at"


def test_stop_at_in_one_direction_leaves_the_other_complete():
    branch = cw.continue_branch(_problem(), [0.0], (-1.0, 1.0), stop_at={"lam": (0.25,)})
    check_branch(branch, _problem())
    assert (branch["lam"][0], branch["lam"][-1]) == (-1.0, 0.25)
    assert branch.outcome.reason == "stop_at"
    assert [q.kind for q in labelled(branch, "EP")] == ["bound", "stop_at"]


@pytest.mark.parametrize("most", [1, 2, 10, 25])
def test_max_points_counts_each_direction(most):
    branch = cw.continue_branch(_problem(), [0.0], (-1.0, 1.0), max_points=most)
    check_branch(branch, _problem())
    assert len(branch) == 2 * most - 1  # the start belongs to both
    assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "max_points")
    assert str(most) in branch.outcome.message


def test_special_points_count_as_points():
    marks = {"lam": np.linspace(0.01, 0.09, 9).tolist()}
    branch = cw.continue_branch(
        _problem(), [0.0], (-1.0, 1.0), direction="forward", marks=marks, max_points=6
    )
    check_branch(branch, _problem())
    assert len(branch) <= 6


def test_an_open_range_ends_at_max_points():
    branch = cw.continue_branch(_problem(), [0.0], (-math.inf, math.inf), max_points=50)
    check_branch(branch, _problem())
    assert branch.outcome.reason == "max_points"
    assert len(branch) == 99
    assert math.isfinite(branch["lam"][-1])


def test_a_branch_that_never_reaches_its_range_turns_back():
    """lambda = 1 - x^2 never reaches 2: both halves leave by the lower end."""

    def field(t, x, p, dx):
        dx[0] = 1.0 - x[0] ** 2 - p.lam

    problem = small_problem(field, "x", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [1.0], (-1.0, 2.0))
    check_branch(branch, problem)
    assert branch["lam"][0] == branch["lam"][-1] == -1.0
    assert [q.label for q in branch.special_points if q.label != "EP"] == ["LP"]


def steep(t, x, p, dx):
    dx[0] = 1e5 * p.lam - x[0]


def test_stop_at_a_value_that_is_met_but_for_rounding():
    """x = 1e5 lam, and an observable that loses eight digits of it: (x + 1e8) - 1e8."""
    lossy = Observable("lossy", lambda t, x, p: (x[:, 0] + 1e8).max() - 1e8)
    problem = small_problem(steep, "x", {"lam": 0.0}, "lam", observables=(lossy,))
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), direction="forward", stop_at={"lossy": (0.7,)})
    assert branch.outcome.reason == "stop_at"
    assert branch["lam"][-1] == pytest.approx(0.7e-5, abs=2e-13)


def test_a_value_at_which_to_stop_that_is_marked_too_is_one_point():
    found = cw.continue_branch(
        _problem(),
        [0.0],
        (-1.0, 1.0),
        direction="forward",
        stop_at={"lam": (0.5,)},
        marks={"lam": (0.25, 0.5)},
    )
    assert [point.parameters["lam"] for point in labelled(found, "UZ")] == [0.25, 0.5]
