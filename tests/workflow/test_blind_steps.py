"""Steps that are shorter than the errors of their ends are told: where the branch goes is rounding there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.workflow.blind_steps import blind_steps
from contwalk.workflow.without_value import notes_of


def line(t, x, p, dx):
    dx[0] = p.mu - x[0]


@pytest.fixture(scope="module")
def branch():
    problem = small_problem(line, "x", {"mu": 0.0}, "mu")
    return cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"mu": [0.5, 0.5 + 1e-12]})


def known_to(branch, errors):
    points = branch.points.copy()
    points["error"] = errors
    return replace(branch, points=points)


def test_steps_longer_than_errors_are_no_matter_of_notes(branch):
    assert blind_steps(branch) == ""
    assert blind_steps(known_to(branch, np.nan)) == ""
    assert blind_steps(known_to(branch, np.inf)) == ""
    # Two marks lie nearer to one another than any step.
    assert blind_steps(known_to(branch, 1e-11)) == ""


def test_steps_shorter_than_errors_are_counted_and_placed(branch):
    special = {point.index for point in branch.special_points}
    row = next(i for i in range(3, len(branch)) if not {i - 1, i, i + 1} & special)
    errors = np.zeros(len(branch))
    errors[row] = 1.0
    told = blind_steps(known_to(branch, errors))
    assert told.startswith(f"b1: 2 of {len(branch) - len(special) - 1} steps, with mu from ")
    low, high = branch["mu"][row - 1], branch["mu"][row + 1]
    assert f"from {low:.10g} to {high:.10g}, are shorter" in told
    assert "(1.0e+00 in the metric" in told


def test_a_run_tells_it_as_a_note(branch):
    system = small_problem(line, "x", {"mu": 0.0}, "mu").system
    assert dict(notes_of(branch, system, None)) == {}
    ((key, told),) = notes_of(known_to(branch, 1.0), system, None)
    assert key == "direction b1"
    assert "its way is rounding" in told


def prey(t, x, p, dx):
    """Bazykin's model (Nonlinear Dynamics of Interacting Populations, 1998): prey, predators, saturation."""
    eaten = x[0] * x[1] / (1.0 + p.alpha * x[0])
    dx[0] = x[0] - eaten - 0.01 * x[0] ** 2
    dx[1] = -x[1] + eaten - 0.0075 * x[1] ** 2


def prey_in_logarithms(t, u, p, du):
    x, y = np.exp(u[0]), np.exp(u[1])
    du[0] = 1.0 - y / (1.0 + p.alpha * x) - 0.01 * x
    du[1] = -1.0 + x / (1.0 + p.alpha * x) - 0.0075 * y


@pytest.mark.slow
def test_a_population_that_returns_from_next_to_nothing_is_told_to_be_written_as_its_logarithm():
    problem = small_problem(prey, ("prey", "predators"), {"alpha": 0.01}, "alpha")
    equilibria = cw.continue_branch(problem, [1.1, 1.1], (0.01, 0.5))
    cycles = cw.switch_branch(problem, equilibria, "HB1", (0.01, 0.5), max_points=200)
    told = blind_steps(cycles)
    assert "prey returns from " in told
    assert "log |prey|" in told


@pytest.mark.slow
def test_in_logarithms_it_is_known():
    """Periods by SciPy in logarithms (DOP853, 1e-12, shooting; Radau agrees to 6e-11)."""
    problem = small_problem(prey_in_logarithms, "uv", {"alpha": 0.01}, "alpha")
    equilibria = cw.continue_branch(problem, [0.1, 0.1], (0.01, 0.5))
    marks = {"alpha": [0.021, 0.022, 0.1]}
    cycles = cw.switch_branch(problem, equilibria, "HB1", (0.01, 0.5), marks=marks)
    assert cycles.outcome.reason == "bound"
    assert blind_steps(cycles) == ""
    periods = [cycles.points["period"][p.index] for p in cycles.special_points if p.label == "UZ"]
    assert periods == pytest.approx([25.263319788, 30.055600758, 76.477369269], rel=1e-8)
