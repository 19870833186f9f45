"""Memory of the compiled event integrator: one for each mode, whatever motions there are; none keeps it."""

from __future__ import annotations

import gc
import weakref
from itertools import islice, zip_longest

import numpy as np
import pytest

from contwalk.flow.hybrid import segment_events
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.plugin_check.motion import _longest
from contwalk.system import Mode, Parameter, State, System, Transition

MODES = 5


def _mode(k):
    def swings(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - (p.c + 0.01 * k) * x[1] + 0.3

    def stops(t, x, p):
        return x[1] - 0.01 * k * (x[0] - 0.3)

    def kicked(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = x[1] + 0.2 + 0.01 * k

    return swings, stops, kicked


OF_MODES = [_mode(k) for k in range(MODES)]
RING = System(
    "ring",
    states=(State("q", "m", 1.0, "place"), State("u", "m/s", 1.0, "speed")),
    parameters=(Parameter("c", 0.1, "1", about="damping"),),
    modes=tuple(Mode(f"m{k}", of[0]) for k, of in enumerate(OF_MODES)),
    transitions=tuple(
        Transition(f"e{k}", f"m{k}", f"m{(k + 1) % MODES}", of[1], "falling", of[2])
        for k, of in enumerate(OF_MODES)
    ),
)
STARTS = [np.array([0.1 * k, 0.4 + 0.2 * k]) for k in range(6)]


def motion(machine, x, weights=(1.0, 1.0), tolerance=1e-9):
    return motion_segments(machine, 0.0, x, "m0", np.inf, Control(tolerance, np.array(weights)))


def bits(segments):
    return [(s.mode, s.transition, s.times.tobytes(), s.states.tobytes(), s.evaluations) for s in segments]


@pytest.fixture
def made(monkeypatch):
    """The modes for which memory has been made."""
    modes = []

    class Counted(segment_events.EventIntegrator):
        def __init__(self, machine, weights, modes_of_it, **rest):
            modes.extend(modes_of_it)
            super().__init__(machine, weights, modes_of_it, **rest)

    monkeypatch.setattr(segment_events, "EventIntegrator", Counted)
    return modes


def test_many_motions_share_the_memory_of_each_mode(made):
    machine = hybrid_machine(RING, {"c": 0.1})
    for x in STARTS:
        past_zero(machine, 0.0, -x, "m0", np.ones(2))  # falling, so that it looks ahead
        assert len(list(islice(motion(machine, x), 12))) == 12
    assert sorted(made) == sorted(set(made))


def test_a_motion_does_not_depend_on_those_before_it_in_the_same_memory():
    machine = hybrid_machine(RING, {"c": 0.1})
    for k, x in enumerate(STARTS):
        given = (1.0 + k, 0.1 * (k + 1)), 10.0 ** (-6 - k)
        fresh = bits(islice(motion(hybrid_machine(RING, {"c": 0.1}), x, *given), 12))
        assert bits(islice(motion(machine, x, *given), 12)) == fresh


def test_motions_that_go_on_by_turns_do_not_disturb_each_other():
    alone = [bits(islice(motion(hybrid_machine(RING, {"c": 0.1}), x), 12)) for x in STARTS]
    machine = hybrid_machine(RING, {"c": 0.1})
    together = list(zip_longest(*(islice(motion(machine, x), 12) for x in STARTS)))
    assert [bits(column) for column in zip(*together, strict=True)] == alone


def test_memory_ends_with_its_machine():
    machine = hybrid_machine(RING, {"c": 0.1})
    list(islice(motion(machine, STARTS[0]), 12))
    gone = weakref.ref(machine)
    gc.disable()
    try:
        del machine
        assert gone() is None  # at once: a walk makes a machine at each point
    finally:
        gc.enable()


@pytest.mark.parametrize(
    ("motions", "longest"), [(0, 8), (28, 8), (1250, 8), (1300, 7), (2800, 4), (10**6, 4)]
)
def test_sample_motions_of_machines_with_many_modes_are_shorter(motions, longest):
    assert _longest(motions) == longest
