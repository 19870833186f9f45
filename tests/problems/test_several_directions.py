"""Branches that leave a point at which several eigenvalues vanish together, and closed forms."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.problems.equilibrium.several_directions import leaving
from contwalk.studies.opening import opened
from contwalk.system import Symmetry


def cubic(states):
    """x_i' = m x_i - x_i |x|^2 - b x_i^3: with b = 0 any direction is one, else those with equal moduli."""

    def field(t, x, p, dx):
        square = sum(x[i] ** 2 for i in range(states))
        for i in range(states):
            dx[i] = p.m * x[i] - x[i] * square - p.b * x[i] ** 3

    return field


def found(field, states, parameters, state, multiplicity=2):
    problem = small_problem(field, states, parameters, "m")
    z, parent = np.append(state, parameters["m"]), np.zeros(len(states) + 1)
    parent[-1] = 1.0
    return leaving(problem, z, 0.0, parent, multiplicity)


@pytest.mark.parametrize("states", [2, 3, 4])
def test_all_directions_of_a_cube_are_found(states):
    """(3^k - 1) / 2 of them: every pattern of 0, 1 and -1, up to its sign."""
    names = "xyzw"[:states]
    directions = found(cubic(states), names, {"m": 0.0, "b": 0.5}, np.zeros(states), states).branches
    patterns = set()
    for each in directions:
        x = each.tangent[:-1] / np.abs(each.tangent[:-1]).max()
        assert each.tangent[-1] == 0.0
        # Newton's method ends at rounding.
        assert x == pytest.approx(np.round(x), abs=1e-12)
        patterns.add(tuple(np.round(x).astype(int)))
        # m = (|x|^2 + b x^2) along them: the largest of the unknowns' reaches is that of their amplitude.
        amplitude = np.sqrt(0.1 / (np.abs(x).sum() + 0.5))
        assert each.reach(0.1)[0] == pytest.approx(amplitude * np.linalg.norm(x), rel=1e-9)
    assert len(patterns) == len(directions) == (3**states - 1) // 2


def test_directions_in_a_circle_are_not_told_apart():
    circle = found(cubic(2), "xy", {"m": 0.0, "b": 0.0}, np.zeros(2))
    assert (circle.branches, circle.family, circle.standing) == ([], 1, False)


def competing(t, x, p, dx):
    """Two that may come in at m = 0.3, in skew coordinates of very different units, on a curved parent."""
    u, v = 1e-6 * x[0] + 0.3e6 * x[1] - p.m, 1e6 * x[1] - 0.2e-6 * x[0] - 0.5 * p.m**2
    a, b = u * (p.m - 0.3 - u - 0.5 * v), v * (p.m - 0.3 - 2.0 * v + 0.7 * u)
    dx[0] = 1e6 * (a - 0.3 * b) / 1.06
    dx[1] = 1e-6 * (b + 0.2 * a) / 1.06


def walked(field, states, value, state, parameters=None, depth=1, **more):
    system = small_system(field, states, {"m": value, **(parameters or {})}, **more)
    settings = Settings(range=(min(value, 0.0), 1.0))
    values = {"m": value, **(parameters or {})}
    opening = opened(system, values, "m", np.array(state), settings)
    made = Diagram([Start(system, "m", values, opening, "start")], Plan(settings, depth=depth))
    assert list(made.events())
    return made.branches


@pytest.mark.long
def test_three_branches_leave_where_two_transcritical_points_are_one():
    """The point was not located (a hundred points of 1e-10 around it), and nothing left it."""
    parent, *others = walked(competing, "xy", 0.0, [0.0, 0.0])
    (point,) = labelled(parent, "BP", "LP", "HB")
    assert (point.status, point.unstable_before, point.unstable_after) == ("located", 0, 2)
    assert abs(point.parameters["m"] - 0.3) <= point.error
    assert "3 other branches leave" in point.note
    ends = []
    for branch in others:
        assert branch.outcome.reason == "bound"
        x = branch.points["state"][np.argmax(branch["m"])]
        ends.append((1e-6 * x[0] + 0.3e6 * x[1] - 1.0, 1e6 * x[1] - 0.2e-6 * x[0] - 0.5))
    # At m = 1: one alone, u = 0.7 or v = 0.35, or both: u + v / 2 = 0.7 and 2 v - 0.7 u = 0.7.
    both = np.linalg.solve([[1.0, 0.5], [-0.7, 2.0]], [0.7, 0.7])
    # Solutions are known to the rounding of states of 1e6 and 1e-6, in sums of size 1.
    known = [[0.0, 0.35], both, [0.7, 0.0]]
    assert np.array(sorted(ends)) == pytest.approx(np.array(known), abs=1e-13)


def test_of_branches_that_are_images_one_is_walked():
    def quarter(t, x, p, y):
        y[0], y[1] = -x[1], x[0]

    parameters = {"b": 0.5}
    turned = (Symmetry("quarter", "spatial", quarter),)
    _, *others = walked(cubic(2), "xy", -0.5, [0.0, 0.0], parameters, symmetries=turned)
    ends = [np.sort(np.abs(branch.points["state"][np.argmax(branch["m"])])) for branch in others]
    # m = 1 = x^2 (n + b) of n equal moduli.
    known = [[0.0, 1.0 / np.sqrt(1.5)], [1.0 / np.sqrt(2.5)] * 2]
    assert np.array(sorted(map(tuple, ends))) == pytest.approx(np.array(known), abs=1e-14)


def test_a_branch_goes_on_through_three_zeros_at_once():
    """An odd number changes the orientation, and has no regular border: it ended as `step_too_small`."""
    parent, *others = walked(cubic(3), "xyz", -0.5, [0.0, 0.0, 0.0], {"b": 0.5}, depth=0)
    (point,) = labelled(parent, "BP", "LP", "HB")
    assert (point.status, point.unstable_before, point.unstable_after) == ("located", 0, 3)
    assert parent.outcome.reason == "bound"
    assert others == []
