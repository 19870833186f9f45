"""Orbits over some periods, as they are drawn and played."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contwalk.errors import ContwalkError
from contwalk.system import Mode, Parameter, State, System
from contwalk.workflow.stored.orbit_motions import motion_along
from contwalk.workflow.stored.orbits import Orbit, columns_of, jumps_of, titled

TURN = 2.0 * np.pi


def still(t, x, p, dx):
    dx[0] = dx[1] = 0.0


SYSTEM = System(
    "machine",
    states=(State("angle", "rad", period=TURN), State("y", "m")),
    parameters=(Parameter("a", 1.0),),
    modes=(Mode("moving", still),),
)


def hybrid(closures=1, turns=(0.0, 0.0), **given):
    """Two arcs of one and two seconds: y goes 0 to 1, jumps to 5, goes to 7, and jumps back to 0."""
    return Orbit(
        "b1",
        "3",
        "3:  a = 1,  T = 3 s",
        np.array([[0.0, 0.0], [0.1, 1.0], [0.2, 5.0], [0.3, 6.0], [0.4, 7.0]]),
        True,
        times=np.array([10.0, 11.0, 11.0, 12.0, 13.0]),
        events=("up", "down"),
        breaks=(2,),
        closures=closures,
        turns=np.array(turns),
        **given,
    )


def smooth():
    """A circle that goes round once in four seconds."""
    times = np.linspace(0.0, 4.0, 9)
    return Orbit("b1", "0", "0", np.stack([TURN * times / 4.0, np.sin(times)], axis=1), True, times=times)


def test_a_curve_is_broken_at_events_and_jumps_are_beside_it():
    curve = columns_of(SYSTEM, hybrid(), ["y"])[:, 0]
    np.testing.assert_array_equal(curve, [0.0, 1.0, np.nan, 5.0, 6.0, 7.0])
    np.testing.assert_array_equal(jumps_of(SYSTEM, hybrid(), ["y"])[..., 0], [[1.0, 5.0], [7.0, 0.0]])
    assert jumps_of(SYSTEM, smooth(), ["y", "angle"]).shape == (0, 2, 2)
    with pytest.raises(ContwalkError, match="'z' is not a state"):
        jumps_of(SYSTEM, hybrid(), ["z"])


def test_a_period_is_as_many_closures_as_it_takes():
    motion = motion_along(SYSTEM, hybrid(closures=2), periods=2)
    assert motion.period == 6.0
    np.testing.assert_array_equal(motion.times, np.concatenate([hybrid().times + 3.0 * k for k in range(4)]))
    assert [time for time, _ in motion.events] == [11.0, 13.0, 14.0, 16.0, 17.0, 19.0, 20.0, 22.0]
    assert [name for _, name in motion.events] == ["up", "down"] * 4
    assert motion.marks[0] == (10.0, "down")
    # Both sides of each event have one time, to the last bit, where rounds meet as well.
    twice = motion.times[1:][np.diff(motion.times) == 0.0]
    np.testing.assert_array_equal(twice, [11.0, 13.0, 14.0, 16.0, 17.0, 19.0, 20.0])


def test_gaps_at_events_of_a_series():
    motion = motion_along(SYSTEM, hybrid())
    times, values = motion.broken(motion.states[:, [1]])
    np.testing.assert_array_equal(times, [10.0, 11.0, 11.0, 11.0, 12.0, 13.0])
    np.testing.assert_array_equal(values[:, 0], [0.0, 1.0, np.nan, 5.0, 6.0, 7.0])


def test_angles_go_on_turning():
    motion = motion_along(SYSTEM, smooth(), periods=3)
    assert motion.states[-1, 0] == pytest.approx(3.0 * TURN)
    assert np.diff(motion.times).min() > 0.0  # no instant twice: nothing happens
    assert motion.marks == ()
    turned = motion_along(SYSTEM, hybrid(turns=(TURN, 0.0)), periods=2)
    np.testing.assert_allclose(turned.states[5:, 0] - turned.states[:5, 0], TURN)


def test_a_title_tells_what_is_not_admissible():
    assert titled(hybrid()) == "b1/3:  a = 1,  T = 3 s"
    assert titled(hybrid(admissible=False)) == "b1/3:  a = 1,  T = 3 s,  not admissible"


def test_states_that_do_not_exist_in_a_mode_are_not_drawn():
    # y exists in the first of both arcs only: what the others store of it is no motion.
    there = np.array([[True, True]] * 2 + [[True, False]] * 3)
    orbit = hybrid(there=there)
    np.testing.assert_array_equal(
        columns_of(SYSTEM, orbit, ["y"])[:, 0], [0.0, 1.0, np.nan, np.nan, np.nan, np.nan]
    )
    assert len(jumps_of(SYSTEM, orbit, ["y"])) == 0
    assert len(jumps_of(SYSTEM, orbit, ["angle"])) == 2
    motion = motion_along(SYSTEM, orbit, 2)
    np.testing.assert_array_equal(motion.there, np.concatenate([there, there]))
    assert motion_along(SYSTEM, smooth()).there is None


def test_an_angle_that_goes_round_but_for_its_orbits_error_is_folded():
    """Near a homoclinic orbit it closes to 1e-5 only; 42 turns on, it is drawn about zero."""
    orbit = smooth()
    once = orbit.states.copy()
    once[:, 0] = once[:, 0] * (1.0 - 1e-5) + 42 * TURN
    curve = columns_of(SYSTEM, replace(orbit, states=once), ["angle", "y"])[:, 0]
    assert np.nanmax(np.abs(curve)) <= 0.5 * TURN


def test_an_angle_that_swings_is_drawn_as_it_is():
    orbit = smooth()
    swinging = orbit.states.copy()
    swinging[:, 0] = 0.45 * TURN * np.sin(TURN * np.linspace(0.0, 1.0, len(swinging)))
    curve = columns_of(SYSTEM, replace(orbit, states=swinging), ["angle", "y"])
    np.testing.assert_array_equal(curve[:, 0], swinging[:, 0])
