"""Signals of the walkers: where their mass is, and what the ground bears of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM as PLANAR

from contwalk.system.declarations import ParameterValues
from contwalk.workflow.quantities import values_along
from contwalk.workflow.run_file.simulate import read_simulation
from contwalk.workflow.simulating import moved

RUNS = Path(__file__).parents[2] / "runs"


def test_the_planar_walker_with_straight_legs_together():
    """Each leg is a thigh m2 at l2y below the hip, and a shank m1 at l1y below the knee, l2 below the hip."""
    p = ParameterValues(**PLANAR.defaults())
    states = np.zeros((1, len(PLANAR.states)))
    hip, centre = values_along(PLANAR, ["hip_height", "com_height"], np.zeros(1), states, vars(p))[0]
    assert hip == pytest.approx(p.l1 + p.l2 + p.rf, rel=1e-15)
    below = (p.m2 * p.l2y + p.m1 * (p.l2 + p.l1y)) / (p.m1 + p.m2)
    assert centre == pytest.approx(hip - below, rel=1e-14)


def test_the_planar_walker_has_the_height_of_its_centre_as_observables():
    names = [observable.name for observable in PLANAR.observables]
    assert {"com_height_max", "com_height_min"} <= set(names)
    assert "hip_height_max" not in names


def test_newton_s_law_of_the_walker_in_space(tmp_path):
    """Mass times the acceleration of its centre is what the toes bear less its weight, between two events."""
    given = ["simulate={until: 0.05, points: 101, tolerance: 1e-12}"]
    run = read_simulation(RUNS / "walker3d_overlap.yaml", given, str(tmp_path / "x.h5"))
    motion = moved(run)
    assert not motion.events
    loads = ["load11", "load12", "load21", "load22"]
    found = values_along(run.system, ["com_height", *loads], motion.times, motion.values, motion.parameters)
    p = ParameterValues(**motion.parameters)
    mass = p.m_torso + 2.0 * (p.m_thigh + p.m_shank)
    height, h = found[:, 0], motion.times[1] - motion.times[0]
    # Differences of the sixth order; rounding of the heights is 1e-16 / h^2 = 4e-10.
    shares = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / (180.0 * h * h)
    acceleration = np.convolve(height, shares, "valid")
    borne = found[3:-3, 1:].sum(axis=1)
    weight = mass * p.g * np.cos(p.alpha)
    np.testing.assert_allclose(mass * acceleration, borne - weight, atol=1e-5 * weight)
    assert np.ptp(borne) > 0.01 * weight  # of a motion on which there is something to see
