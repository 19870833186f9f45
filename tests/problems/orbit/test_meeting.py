"""How near a state is to an orbit of which samples are known."""

import math

import numpy as np
import pytest

from contwalk.problems.orbit.distance_to_orbit import distance

NO_ANGLES = np.zeros(2)


def circle(samples: int, turns: float = 1.0) -> np.ndarray:
    phase = np.linspace(0.0, 2.0 * math.pi * turns, samples)
    return np.column_stack([np.cos(phase), np.sin(phase)])


@pytest.mark.parametrize("phase", [0.0, 0.7, 1.234, 6.27])
@pytest.mark.parametrize("off", [0.0, 1e-4, -1e-3])
def test_a_state_beside_a_circle(phase, off):
    """Chords of 100 samples miss it by up to 5e-4, parabolas by the cube of their spacing, 2e-5."""
    x = (1.0 + off) * np.array([math.cos(phase), math.sin(phase)])
    assert distance(circle(100), x, NO_ANGLES, np.ones(2)) == pytest.approx(abs(off), abs=2e-5)


def test_units_and_angles_count():
    """An angle that goes round with a state of another unit: x = 1e3 sin(a), from a in 0..2 pi."""
    a = np.linspace(0.0, 2.0 * math.pi, 200)
    curve = np.column_stack([a, 1e3 * np.sin(a)])
    x = np.array([1.1 - 6.0 * math.pi, 1e3 * math.sin(1.1)])
    apart = distance(curve, x, np.array([2.0 * math.pi, 0.0]), np.array([1.0, 1e3]))
    assert apart < 2e-6
    assert distance(curve, x, np.array([0.0, 0.0]), np.array([1.0, 1e3])) > 1.0


def test_an_orbit_that_rests_is_a_point():
    curve = np.zeros((5, 2))
    assert distance(curve, np.array([3.0, 4.0]), NO_ANGLES, np.ones(2)) == pytest.approx(5.0, rel=1e-15)


@pytest.mark.parametrize("shift", [0.0, 0.2, 0.5, 0.9])
def test_an_orbit_that_comes_by_twice_is_as_near_as_the_nearer_time(shift):
    """Two rounds 1e-3 apart; samples of the outer one, on which the state is, are farther than the others."""
    inner, phase = circle(100), 2.0 * math.pi * (np.arange(100) + shift) / 99.0
    outer = 1.001 * np.column_stack([np.cos(phase), np.sin(phase)])
    x = 1.001 * np.array([math.cos(angle := 2.0 * math.pi * 30 / 99.0), math.sin(angle)])
    assert distance(np.vstack([inner, outer]), x, NO_ANGLES, np.ones(2)) < 2e-5
    assert distance(np.vstack([inner, outer]), x / 1.0005, NO_ANGLES, np.ones(2)) > 4e-4
