"""Where a state of an orbit first passes a value: on a circle that is gone round in two seconds."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.problems.orbit.reporting import crossing
from contwalk.problems.passing import Place
from contwalk.system import State

PERIOD, TURN = 2.0, 2.0 * math.pi


def round_once(share):
    turn = TURN * np.asarray(share)
    return np.column_stack([np.cos(turn), np.sin(turn)])


def motion(shares, *stretches):
    """As much of the closures of a period as is asked for: where the motion is on each."""
    lasts = PERIOD / len(stretches)
    return [
        SimpleNamespace(
            at=lambda shares, at=at: (shares, at(shares)),
            motion=(lasts * (number + shares), at(shares)),
            later=number * lasts,
            view=SimpleNamespace(start=0.0, duration=lasts),
        )
        for number, at in enumerate(stretches)
    ]


def passing(index, value, direction, period=0.0, at=round_once, samples=14):
    shares = np.linspace(0.0, 1.0, samples)
    place = Place(index, value, direction, period)
    return crossing(motion(shares, at), place, stepped=False, comes_back=True)


@pytest.mark.parametrize("value", [0.0, 0.5, -0.8])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_it_is_where_the_motion_is_and_goes_that_way(value, direction):
    # On the way up the first state is that of the right half.
    expected = [direction * math.sqrt(1.0 - value**2), value]
    assert passing(1, value, direction) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("size", [1e-16, 1e-9])
@pytest.mark.parametrize("late", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("gap", [-1.1, 1.1])
def test_an_orbit_that_begins_where_it_passes_passes_there(size, late, gap):
    """Wherever rounding, or what it closes up to, puts its beginning and its end: not at the other place
    where the curve (cos t, sin 2 t) rises through zero.
    """

    def eight(share):
        turn = TURN * np.asarray(share)
        return np.column_stack([np.cos(turn), np.sin(2.0 * turn) + size * (late + gap * share)])

    x, y = passing(1, 0.0, 1.0, at=eight)
    # The instant is off by less than `size`, and the cosine by less than that.
    assert (x, y) == (pytest.approx(1.0, abs=size + 1e-15), pytest.approx(0.0, abs=1e-15))


def test_a_jump_from_the_end_to_the_beginning_is_no_passing():
    """A state that only grows never comes back down to where it was."""
    assert np.all(np.isnan(passing(1, 3.0, -1.0, at=lambda s: np.column_stack([s, 6.0 * s]))))


def test_what_is_not_passed_has_no_state():
    assert np.all(np.isnan(passing(1, 1.5, 1.0)))


@pytest.mark.parametrize("value", [0.3, 0.3 + TURN, 0.3 - 7.0 * TURN])
@pytest.mark.parametrize("begin", [0.0, 2.0, 0.3, -20.0])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_an_angle_passes_the_value_in_each_turn(value, begin, direction):
    """Wherever it begins, and told as the value that was asked for; the other state tells where it is."""

    def turning(share):
        angle = begin + direction * TURN * np.asarray(share)
        return np.column_stack([angle, np.sin(angle)])

    found = passing(0, value, direction, TURN, at=turning)
    # The angle has lost what is rounded at the size of some turns.
    assert found == pytest.approx([value, math.sin(0.3)], abs=1e-13)
    assert np.all(np.isnan(passing(0, value, -direction, TURN, at=turning)))


@pytest.mark.parametrize("value", [0.5, -0.8])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_images_of_what_is_integrated_are_as_exact(value, direction):
    """The second half of the circle is the first one's image in its centre."""

    def half(share):
        return round_once(0.5 * np.asarray(share))

    whole = motion(np.linspace(0.0, 1.0, 9), half, lambda share: -half(share))
    found = crossing(whole, Place(1, value, direction, 0.0), stepped=False, comes_back=True)
    assert found == pytest.approx([direction * math.sqrt(1.0 - value**2), value], abs=1e-14)


def test_a_branch_of_orbits_that_begin_there_is_told_there():
    """The section through the start is y = 0: rounding puts each orbit's ends on either side of it."""
    system = small_system(circle, "xy", {"mu": 0.5})
    there = cw.Discretization(report_at=(1, 0.0, 1.0))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=there)
    branch = cw.continue_branch(problem, [math.sqrt(0.5), 0.0], (0.4, 0.8), period=TURN)
    # On steps of 1e-6.
    np.testing.assert_allclose(branch["x"], np.sqrt(branch["mu"]), rtol=1e-5)
    np.testing.assert_allclose(branch["y"], 0.0, rtol=0.0, atol=1e-13)


def test_a_turning_angle_is_told_where_the_run_asks():
    """dphi/dt = w + cos(phi) / 2, from phi = 0.3 on, which is behind zero and in front of the next one."""

    def field(t, x, p, dx):
        dx[0] = p.w + 0.5 * np.cos(x[0])
        dx[1] = -x[1] + p.w * np.sin(x[0])

    system = small_system(field, (State("phi", period=TURN), State("y")), {"w": 2.0})
    there = cw.Discretization(report_at=(0, 0.0, 1.0))
    problem = cw.PeriodicOrbit(system, system.defaults(), "w", discretization=there)
    period = TURN / math.sqrt(4.0 - 0.25)
    branch = cw.continue_branch(problem, [0.3, 0.0], (1.9, 2.1), period=period, max_points=6)
    np.testing.assert_allclose(branch["phi"], 0.0, rtol=0.0, atol=1e-13)
    assert np.ptp(branch["y"]) < 0.2 * np.abs(branch["y"]).max()
