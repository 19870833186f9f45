"""Eigenvalues that are critical in a window between two points of a branch, and flat on both sides of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw

DAMPING = 0.01


def flutter(t, x, p, dx):
    """Two modes with the same damping, and a coupling that brings energy from one to the other."""
    dx[0], dx[1] = x[2], x[3]
    dx[2] = -DAMPING * x[2] - x[0] - p.mu * x[1] - x[0] ** 3
    dx[3] = -DAMPING * x[3] - p.k * x[1] + p.mu * x[0] - x[1] ** 3


def window(mu: float) -> tuple[float, float]:
    """The Hopf points: of s^2 + d s = m, with m of [[-1, -mu], [mu, -k]], where (Im m)^2 = -d^2 Re m."""
    half = math.sqrt(4.0 * (mu - DAMPING) * (mu + DAMPING) + DAMPING**4)
    return 1.0 - DAMPING**2 - half, 1.0 - DAMPING**2 + half


@pytest.mark.parametrize("width", np.geomspace(1e-1, 1e-7, 7))
def test_a_window_of_flutter_is_found_wherever_steps_end(width):
    """Outside of it real parts are flat, -d / 2: that two frequencies run into each other tells.

    In a window of 1e-8 they are positive by 2e-16, which is rounding of the frequencies.
    """
    rng = np.random.default_rng(int(1e9 * width))
    mu = math.sqrt(DAMPING**2 - 0.25 * DAMPING**4 + width**2 / 16.0)
    low, high = rng.uniform(0.1, 0.6), rng.uniform(2.0, 9.0)
    problem = small_problem(flutter, ["a", "b", "va", "vb"], {"mu": mu, "k": low}, "k")
    branch = cw.continue_branch(problem, [0.0] * 4, (low, high))
    found = labelled(branch, "HB", "BP", "LP")
    assert [(point.label, point.unstable_before, point.unstable_after) for point in found] == [
        ("HB", 0, 2),
        ("HB", 2, 0),
    ]
    for point, expected in zip(found, window(mu), strict=True):
        # The window is the root of a difference that cancels: what rounding of mu moves it by.
        allowed = point.error + 1e-16 * mu**2 / width + 1e-15
        assert abs(point.parameters["k"] - expected) <= 10.0 * allowed


@pytest.mark.parametrize("part", np.geomspace(0.9, 1e-6, 5))
def test_modes_that_do_not_flutter_have_no_points(part):
    """The same coupling, too weak by a part of the damping."""
    mu = math.sqrt(DAMPING**2 - 0.25 * DAMPING**4) * (1.0 - part)
    problem = small_problem(flutter, ["a", "b", "va", "vb"], {"mu": mu, "k": 0.3}, "k")
    branch = cw.continue_branch(problem, [0.0] * 4, (0.3, 4.0))
    assert labelled(branch, "HB", "BP", "LP") == []
    assert not branch["unstable"].any()


def test_two_real_eigenvalues_meet_and_are_a_pair_that_is_unstable_for_a_while():
    """x'' = (0.01 - 600 (p - 0.3)^2) x' - x: far from 0.3 both are real."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - (600.0 * (p.p - 0.3) ** 2 - 0.01) * x[1] - x[0] ** 3

    system = small_system(field, ["x", "v"], {"p": -1.0})
    problem = cw.Equilibrium(system, system.defaults(), "p")
    branch = cw.continue_branch(problem, [0.0, 0.0], range=(-1.0, 1.37))
    found = labelled(branch, "HB")
    half = math.sqrt(0.01 / 600.0)
    assert [point.parameters["p"] for point in found] == pytest.approx([0.3 - half, 0.3 + half], abs=1e-12)
