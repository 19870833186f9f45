"""The largest and the least value of a state over an orbit, against orbits in closed form."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from hybrid_runs import diagram
from orbit_systems import ACCURACY, assert_met, orbits
from small_systems import circle, small_system

import contwalk as cw
from contwalk.system import State, Symmetry

# Rows of a branch are solved for to a hundred times the accuracy of special points.
WALKED = 100.0 * ACCURACY


def test_of_two_peaks_that_are_nearly_alike_the_higher_one_counts():
    """x = cos 2s + mu cos s with s = t - 1 is largest, 1 + |mu|, at s = 0 or pi, and least -1 - mu^2 / 8."""

    def field(t, x, p, dx):
        s = t - 1.0
        there = np.cos(2.0 * s) + p.mu * np.cos(s)
        dx[0] = there - x[0] - 2.0 * np.sin(2.0 * s) - p.mu * np.sin(s)

    system = small_system(field, ["x"], {"mu": 1e-5}, period=lambda p: 2.0 * math.pi)
    start = (math.cos(2.0) + 1e-5 * math.cos(1.0),)
    branch = cw.continue_branch(orbits(system, "mu"), start, (-1e-4, 1e-4), max_step=0.2)
    mu = branch["mu"]
    assert len(mu) > 5
    # Samples a hundredth of a period apart would miss a peak by up to 2e-3.
    np.testing.assert_allclose(branch["max:x"], 1.0 + np.abs(mu), rtol=0, atol=WALKED)
    np.testing.assert_allclose(branch["min:x"], -1.0 - mu**2 / 8.0, rtol=0, atol=WALKED)
    np.testing.assert_array_equal(branch["amp:x"], 0.5 * (branch["max:x"] - branch["min:x"]))


def test_of_an_orbit_that_is_integrated_in_part_the_images_count():
    """A quarter of a circle round (2, 0) is integrated; x and y are extreme in its images as well."""

    def field(t, x, p, dx):
        circle(t, [x[0] - 2.0, x[1]], p, dx)

    def turned(t, x, p, image):
        image[0] = 2.0 + x[1]
        image[1] = 2.0 - x[0]

    symmetries = (Symmetry("quarter", "spatial", turned),)
    system = small_system(field, ["x", "y"], {"mu": 0.5}, symmetries=symmetries)
    branch = cw.continue_branch(
        orbits(system, "mu"), (2.0 + math.sqrt(0.5), 0.0), (0.3, 0.8), period=2.0 * math.pi
    )
    assert branch.info.closure == "quarter"
    radius = np.sqrt(branch["mu"])
    for name, centre in (("x", 2.0), ("y", 0.0)):
        np.testing.assert_allclose(branch[f"max:{name}"], centre + radius, rtol=0, atol=WALKED)
        np.testing.assert_allclose(branch[f"min:{name}"], centre - radius, rtol=0, atol=WALKED)
        np.testing.assert_allclose(branch[f"amp:{name}"], radius, rtol=0, atol=WALKED)


def test_an_angle_that_goes_round_has_no_extremes():
    """q' = w and x' = cos q - x: x has the amplitude 1 / sqrt(1 + w^2)."""

    def field(t, x, p, dx):
        dx[0] = p.w
        dx[1] = np.cos(x[0]) - x[1]

    system = small_system(field, [State("q", period=2.0 * math.pi), "x"], {"w": 1.0})
    branch = cw.continue_branch(orbits(system, "w"), (0.0, 0.5), (0.8, 1.2), period=2.0 * math.pi)
    assert np.isnan(branch["max:q"]).all()
    assert np.isnan(branch["amp:q"]).all()
    np.testing.assert_allclose(branch["max:x"], 1.0 / np.hypot(1.0, branch["w"]), rtol=0, atol=WALKED)


@pytest.mark.parametrize(("name", "level", "mu"), [("max:x", 0.5, 0.25), ("amp:y", 0.6, 0.36)])
def test_extremes_can_be_marked(name, level, mu):
    system = small_system(circle, ["x", "y"], {"mu": 0.5})
    start = (math.sqrt(0.5), 0.0)
    branch = cw.continue_branch(
        orbits(system, "mu"), start, (0.2, 0.8), period=2.0 * math.pi, marks={name: [level]}
    )
    (point,) = [p for p in branch.special_points if p.label == "UZ"]
    assert point.kind == "observable"
    assert_met(point, "mu", mu)
    assert branch[name][point.index] == pytest.approx(level, rel=ACCURACY)


def test_of_a_point_at_rest_they_are_its_state():
    system = small_system(circle, ["x", "y"], {"mu": -0.5})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, (0.0, 0.0), (-1.0, -0.1))
    np.testing.assert_array_equal(branch["max:x"], branch["x"])
    np.testing.assert_array_equal(branch["amp:y"], np.zeros(len(branch)))
    with pytest.raises(KeyError, match="max:z"):
        branch["max:z"]


# -- orbits with events ------------------------------------------------------------------------------------

G, OMEGA, E, A = 9.81, 35.0, 0.5, 0.0095
SPEED = math.pi * G / OMEGA  # of the ball after a bounce; its orbit doubles at A = 0.0118


@cache
def bounces():
    cosine = SPEED * (1.0 - E) / ((1.0 + E) * A * OMEGA)
    passed = (2.0 * math.pi - math.acos(cosine)) / OMEGA
    height = A * math.sqrt(1.0 - cosine**2)
    start = height + SPEED * passed - 0.5 * G * passed**2, SPEED - G * passed
    given = {"e": E, "A": A, "omega": OMEGA, "g": G}
    return diagram(BALL, "A", (0.0086, 0.0124), start, given, follow=["PD"], events={"GR": "ignore"})


def test_both_sides_of_an_event_count():
    """The velocity is largest right after a bounce and least right before it, the height least at it."""
    branch = bounces()[0]
    cosine = SPEED * (1.0 - E) / ((1.0 + E) * branch["A"] * OMEGA)
    sine = np.sqrt(1.0 - np.minimum(cosine, 1.0) ** 2) * np.sign(branch["y"])
    known = 10.0 * WALKED  # the phase of the fold is known to the root only: rows there are left out
    away = np.abs(sine) > 0.05
    np.testing.assert_allclose(branch["max:v"], SPEED, rtol=known)
    np.testing.assert_allclose(branch["min:v"], -SPEED, rtol=known)
    low = branch["A"] * sine
    np.testing.assert_allclose(branch["min:y"][away], low[away], rtol=0, atol=known)
    np.testing.assert_allclose(branch["max:y"][away], (low + SPEED**2 / (2.0 * G))[away], rtol=0, atol=known)


def test_a_doubled_orbit_has_its_state_at_both_events():
    parent, child = bounces()
    assert "v@2" not in parent.info.observables
    assert parent.info.settings["reported"] == "before bounce"
    assert child.info.signature == ("bounce", "bounce")
    first, second = child["v"], child["v@2"]
    # Where it is born both are the parent's; from there on one bounce is harder than the other.
    birth = int(np.argmin(np.abs(child["s"])))
    assert first[birth] == pytest.approx(-SPEED, rel=1e-6)
    assert second[birth] == pytest.approx(-SPEED, rel=1e-6)
    later = np.abs(child["s"]) > 0.1 * np.abs(child["s"]).max()
    assert np.abs(first - second)[later].min() > 1e-3
    # The fastest fall is that before the harder one.
    np.testing.assert_allclose(np.minimum(first, second), child["min:v"], rtol=1e-12)
