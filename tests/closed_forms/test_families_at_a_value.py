"""Families of equilibria that lie at one value of the parameter: nothing leaves there, and that is said."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening import opened


def alike(count):
    """x_i' = x_i (1 - (1 - w) x_i - w / (n - 1) (S - x_i)): at w = (n - 1) / n the plane S = n."""

    def field(t, x, p, dx):
        total = sum(x[i] for i in range(count))
        for i in range(count):
            dx[i] = x[i] * (1.0 - (1.0 - p.w) * x[i] - p.w / (count - 1) * (total - x[i]))

    return field, np.ones(count), (count - 1) / count


def with_memory():
    """The same of three, each of which is held back by what it was: the plane is one of memories, too."""

    def field(t, x, p, dx):
        total = x[0] + x[2] + x[4]
        for i in range(3):
            a, m = x[2 * i], x[2 * i + 1]
            dx[2 * i] = a * (1.0 - (1.0 - p.w) * m - 0.5 * p.w * (total - a))
            dx[2 * i + 1] = a - m

    return field, np.ones(6), 2.0 / 3.0


def linear():
    """Everything stands still at w = 0.3."""

    def field(t, x, p, dx):
        dx[0] = (p.w - 0.3) * (x[0] - 2.0 * x[1])
        dx[1] = (p.w - 0.3) * (x[0] + x[1])
        dx[2] = 1.0 - x[2]

    return field, np.array([0.0, 0.0, 1.0]), 0.3


def bowl():
    """The family z = x^2 + y^2 at w = 0.3."""

    def field(t, x, p, dx):
        dx[0] = (p.w - 0.3) * x[0] * (1.0 + x[1])
        dx[1] = 2.0 * (p.w - 0.3) * x[1]
        dx[2] = x[0] ** 2 + x[1] ** 2 - x[2]

    return field, np.zeros(3), 0.3


def in_other_units(case, units, order):
    """The same in other units and another order."""
    field, state, value = case

    def seen(t, x, p, dx):
        own, rates = [x[k] / units[i] for i, k in enumerate(order)], [0.0] * len(order)
        field(t, own, p, rates)
        for i, k in enumerate(order):
            dx[k] = units[i] * rates[i]

    moved = np.empty(len(order))
    moved[list(order)] = np.array(units) * state
    return seen, moved, value


CASES = {
    "three": (alike(3), 2),
    "three, other units": (in_other_units(alike(3), (1e3, 1e-4, 7.0), (2, 0, 1)), 2),
    "three, a like scale": (in_other_units(alike(3), (37.0, 37.0, 37.0), (0, 2, 1)), 2),
    "four": (alike(4), 3),
    "memory": (with_memory(), 2),
    "linear": (linear(), 2),
    "linear, other units": (in_other_units(linear(), (1e6, 1e-6, 1.0), (1, 2, 0)), 2),
    "bowl": (bowl(), 2),
    "bowl, other units": (in_other_units(bowl(), (1e2, 1e-3, 1e4), (2, 1, 0)), 2),
}


def walked(field, state, name="w", begin=0.05, end=0.9):
    system = small_system(field, [f"x{i}" for i in range(len(state))], {name: begin})
    settings = Settings(range=(begin, end))
    opening = opened(system, {name: begin}, name, state, settings)
    made = Diagram([Start(system, name, {name: begin}, opening, "start")], Plan(settings, depth=2))
    assert list(made.events())
    return made.branches


@pytest.mark.parametrize(("case", "dimension"), CASES.values(), ids=CASES.keys())
def test_nothing_leaves_where_a_family_lies_at_a_value(case, dimension) -> None:
    field, state, value = case
    (branch,) = [b for b in walked(field, state) if b.info.problem == "equilibrium"]
    (point,) = labelled(branch, "BP", "LP")
    assert (point.status, point.coefficients["multiplicity"]) == ("located", dimension)
    assert point.parameters["w"] == pytest.approx(value, abs=1e-14)
    assert f"a family of dimension {dimension} lies at this value of w" in point.note
    assert branch.outcome.reason == "bound"
    assert branch["residual"].max() < 20.0  # solutions, to their own rounding


def test_branches_of_a_continuous_symmetry_are_told_as_a_family() -> None:
    def field(t, x, p, dx):
        for i in range(2):
            dx[i] = (p.w - 0.3 - x[0] ** 2 - x[1] ** 2) * x[i]

    (branch,) = walked(field, np.zeros(2))
    (point,) = labelled(branch, "BP")
    assert "branches leave in families of dimension 1, as of a continuous symmetry" in point.note


def test_a_correction_that_runs_off_is_none() -> None:
    """Of 1e-14 x = w the solution is 1e14 away, where a residual of one would be rounding."""

    def field(t, x, p, dx):
        dx[0] = 1e-14 * x[0] - p.w

    problem = small_problem(field, "x", {"w": 1.0}, "w")
    found = correct(problem, np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.ones(2))
    assert (found.reason, found.sentence) == ("no_convergence", "Newton's method runs off.")
