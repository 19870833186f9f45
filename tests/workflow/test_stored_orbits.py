"""Orbits of stored points integrated once more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.system import State
from contwalk.workflow.figures import draw_figure
from contwalk.workflow.stored.orbits import MOST_ORBITS, columns_of, orbit_at, orbits_of


@pytest.fixture(scope="module")
def circles():
    """Circles of radius sqrt(mu), of period 2 pi."""
    system = small_system(circle, ("x", "y"), {"mu": 1.0})
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    marks = {"mu": [0.6, 0.7, 0.8, 0.9, 1.1, 1.2]}
    branch = cw.continue_branch(problem, [1.0, 0.0], range=(0.5, 1.5), period=2.0 * np.pi, marks=marks)
    return system, branch


def test_orbits_are_the_circles_of_their_parameters(circles):
    system, branch = circles
    (orbits,) = orbits_of(system, [branch])
    assert len(orbits) == MOST_ORBITS
    for orbit in orbits:
        mu = float(orbit.label.split("mu = ")[1].split(",")[0])
        radius = np.hypot(*orbit.states.T)
        assert np.allclose(radius, np.sqrt(mu), rtol=1e-5)  # the label has six digits
        assert np.allclose(orbit.states[0], orbit.states[-1], atol=1e-5)  # the tolerance of a picture
        assert orbit.stable


def test_marked_values_come_before_ends(circles):
    system, branch = circles
    (orbits,) = orbits_of(system, [branch])
    assert [orbit.point[:2] for orbit in orbits] == ["UZ"] * MOST_ORBITS


def test_a_row_by_its_number(circles):
    system, branch = circles
    orbit = orbit_at(system, branch, 3)
    assert orbit.point == "3"
    assert orbit.label.startswith("3:  mu = ")


def test_a_figure_of_named_points(circles, tmp_path):
    system, branch = circles
    points = [(branch, branch.special("UZ1")), (branch, branch.special("UZ2"))]
    path = tmp_path / "portrait.svg"
    draw_figure("phase_portrait", [branch], system, path, {"x": "y", "y": "x", "points": points})
    text = path.read_text(encoding="utf-8")
    assert 'id="orbit-1"' in text
    assert 'id="orbit-2"' not in text


def test_states_only(circles):
    system, branch = circles
    with pytest.raises(ContwalkError, match="'z' is not a state"):
        columns_of(system, orbit_at(system, branch, 0), ["x", "z"])


def test_without_orbits_there_is_no_portrait(circles):
    system, _ = circles
    rest = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "mu"), [0.0, 0.0], range=(-1, 1))
    with pytest.raises(ContwalkError, match="No branch has periodic orbits"):
        orbits_of(system, [rest])
    with pytest.raises(ContwalkError, match="equilibrium"):
        orbit_at(system, rest, 0)


def test_an_angle_that_turns_is_folded():
    def spinning(t, x, p, dx):
        dx[0] = p.speed + 0.1 * np.sin(x[0])
        dx[1] = np.cos(x[0]) - x[1]

    states = (State("angle", unit="rad", period=2.0 * np.pi), State("y"))
    system = small_system(spinning, states, {"speed": 1.0})
    problem = cw.PeriodicOrbit(system, system.defaults(), "speed")
    branch = cw.continue_branch(problem, [0.0, 0.5], range=(0.8, 1.2), until="settled", max_points=10)
    curve = columns_of(system, orbit_at(system, branch, 2), ["angle", "y"])
    inside = curve[np.isfinite(curve).all(axis=1)]
    assert np.abs(inside[:, 0]).max() <= np.pi * (1.0 + 1e-12)
    assert np.isnan(curve[:, 0]).sum() >= 1  # no line across the picture where it comes round


def test_an_orbit_at_a_bifurcation_is_not_stable(circles):
    # Where a branch is born its multiplier is on the unit circle: rounding decides what its row counts.
    system, branch = circles
    born = Branch(replace(branch.info, parent=("b0", 1.0)), branch.points, [], branch.outcome)
    row = int(np.flatnonzero(born["s"] == 0.0)[0])
    assert not born["unstable"].any()
    assert [orbit_at(system, born, at).stable for at in (row - 1, row, row + 1)] == [True, False, True]
    assert orbit_at(system, branch, row).stable  # of a start that is no bifurcation


def test_where_a_family_shrinks_to_a_point_it_is_not_stable(circles):
    system, _ = circles
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    back = cw.continue_branch(
        problem, [1.0, 0.0], range=(-0.5, 1.5), period=2.0 * np.pi, direction="backward"
    )
    end = next(point for point in back.special_points if point.kind == "shrunk")
    assert not orbit_at(system, back, end).stable
