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
