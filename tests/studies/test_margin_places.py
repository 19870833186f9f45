"""Where a pushed machine sets out: what a push does to guards, and what is only the error of a state."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.studies.margins.consistency import placed
from contwalk.system import Mode, State, System, Transition


def falls(t, x, p, dx):
    dx[0], dx[1] = x[1], -1.0


def presses(t, x, p, dx):
    dx[0], dx[1] = x[1], -1.0 - 50.0 * x[0] - x[1]


def height(t, x, p):
    return x[0]


# A foot over a springy floor: it touches down and lifts off where its height is zero.
FOOT = System(
    "foot",
    states=(State("h"), State("v")),
    parameters=(),
    modes=(Mode("air", falls), Mode("ground", presses)),
    transitions=(
        Transition("lands", "air", "ground", height, "falling", level=True),
        Transition("lifts", "ground", "air", height, "rising", level=True),
    ),
)


@pytest.mark.parametrize("error", [-1e-12, 0.0, 1e-12])
@pytest.mark.parametrize("mode", ["air", "ground"])
def test_the_error_of_a_state_right_after_an_event_is_no_push(mode, error):
    machine, x = hybrid_machine(FOOT, {}), np.array([error, 0.3])
    for push in ([0.0, 0.0], [0.0, 0.7], [0.0, -0.7]):
        place = placed(machine, 0.0, mode, x, x + np.array(push))
        assert (place.mode, place.beyond) == (mode, "")


def test_what_a_push_has_put_into_the_ground_stands_on_it_and_what_it_has_lifted_is_in_the_air():
    machine, x = hybrid_machine(FOOT, {}), np.array([1e-12, 0.3])
    assert placed(machine, 0.0, "air", x, x - np.array([1e-3, 0.0])).mode == "ground"
    assert placed(machine, 0.0, "ground", x, x + np.array([1e-3, 0.0])).mode == "air"
    assert placed(machine, 0.0, "ground", x, x - np.array([1e-3, 0.0])).mode == "ground"


def bounces(t, x, p, after):
    after[0], after[1] = 0.0, 1.0 - 0.5 * x[1]


def swings(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0]


def kicks(t, x, p, after):
    after[0], after[1] = x[0], (x[1] * x[1] + 0.5) ** 0.5


STATES = State("h"), State("v")
BALL = System(
    "ball",
    states=STATES,
    parameters=(),
    modes=(Mode("flies", falls),),
    transitions=(Transition("bounces", "flies", "flies", height, "falling", bounces),),
)
CLOCK = System(
    "clock",
    states=STATES,
    parameters=(),
    modes=(Mode("goes", swings),),
    transitions=(Transition("kicks", "goes", "goes", height, "rising", kicks),),
)


@pytest.mark.parametrize("error", [-1e-13, 0.0, 1e-13])
def test_a_ball_on_the_floor_that_is_pushed_down_bounces(error):
    machine, x = hybrid_machine(BALL, {}), np.array([error, 2.0])
    place = placed(machine, 0.0, "flies", x, x - np.array([0.0, 5.0]), last="bounces")
    assert place.state.tolist() == [0.0, 2.5]
    assert (place.last, place.beyond) == ("bounces", "")
    softer = placed(machine, 0.0, "flies", x, x - np.array([0.0, 1.5]), last="bounces")
    assert softer.state.tolist() == [error, 0.5]
    assert placed(machine, 0.0, "flies", x, x - np.array([1e-3, 0.0]), last="bounces").beyond == "bounces"


@pytest.mark.parametrize("speed", [-2.0, 0.0, 2.0])
def test_a_machine_that_goes_on_past_its_event_may_be_pushed_past_it(speed):
    machine = hybrid_machine(CLOCK, {})
    for begin in (-1e-9, -0.5):
        x = np.array([begin, speed])
        assert placed(machine, 0.0, "goes", x, x + np.array([1.0, 0.0])).beyond == ""


@pytest.mark.parametrize("speed", [-2.0, 0.0, 2.0])
def test_a_ball_is_never_below_its_floor(speed):
    machine, x = hybrid_machine(BALL, {}), np.array([0.5, speed])
    assert placed(machine, 0.0, "flies", x, x - np.array([1.0, 0.0])).beyond == "bounces"
