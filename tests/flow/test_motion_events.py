"""Motions event by event: the events are those of the reference integrator to the last bit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contwalk.flow.hybrid.motion_events import TIME_UP, TOO_MANY, MotionEvents, Standpoint
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, parts
from contwalk.system import Mode, Parameter, State, System, Transition


def swings(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 0.1 * x[1]


def falls(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0


def bounced(t, x, p, after):
    after[0], after[1] = 0.0, -p.r * x[1]


def kicked(t, x, p, after):
    after[0], after[1] = x[0], x[1] + 0.4


def system(modes, transitions):
    states, parameters = (State("x"), State("v")), (Parameter("r", 0.7),)
    modes = tuple(Mode(name, field) for name, field in modes.items())
    return System("made_up", states, parameters, modes, transitions=tuple(transitions))


def both(given, x, mode, t1, last=None, method="dop853", ends=()):
    """Events of a motion, and of the reference; and the motion at its end."""
    machine = hybrid_machine(given, {"r": 0.7})
    control = Control(1e-9, np.ones(2), method, watched=False)
    motion = MotionEvents(machine, control, ends)
    found = list(motion.events(Standpoint(0.0, mode, np.array(x), last), t1))
    reference = [*parts(machine, 0.0, np.array(x), mode, t1, control, last)]
    return found, reference, motion


def told(reference):
    return [(part.transition, float(part.times[-1])) for part in reference if part.transition]


GROUND = Transition("lands", "air", "air", lambda t, x, p: x[0], "falling", bounced)
TWO_WAYS = [
    Transition("over", "below", "above", lambda t, x, p: x[0] - 0.2, "rising", kicked),
    Transition("under", "above", "below", lambda t, x, p: x[0] + 0.1, "falling"),
]
# Two clocks that strike together, the second one in both modes.
CLOCKS = [
    Transition("fast", "m", "n", lambda t, x, p: math.sin(2.0 * math.pi * t), "rising", kicked),
    Transition("slow", "n", "m", lambda t, x, p: math.sin(math.pi * t), "rising", kicked),
    Transition("slow", "m", "n", lambda t, x, p: math.sin(math.pi * t), "rising", kicked),
    Transition("back", "n", "m", lambda t, x, p: x[1], "falling"),
]
# Where the first one lands the second one acts at entry, and then the third.
AT_ONCE = [
    Transition("first", "a", "b", lambda t, x, p: x[0], "falling", kicked),
    Transition("second", "b", "c", lambda t, x, p: x[0] - 0.5, "falling", level=True),
    Transition("third", "c", "a", lambda t, x, p: x[1] + 0.2, "falling", bounced, level=True),
]
MACHINES = {
    "two modes": (system({"below": swings, "above": swings}, TWO_WAYS), [0.0, 1.0], "below", 60.0),
    "clocks": (system({"m": swings, "n": swings}, CLOCKS), [0.3, 0.1], "m", 30.5),
    "at once": (system({"a": swings, "b": swings, "c": swings}, AT_ONCE), [1.0, 0.0], "a", 40.0),
    "no event": (system({"m": swings}, []), [1.0, 0.0], "m", 9.0),
}


@pytest.mark.parametrize("method", ["dop853", "radau5"])
@pytest.mark.parametrize("name", MACHINES)
def test_events_and_the_end_are_those_of_the_reference(name, method):
    found, reference, motion = both(*MACHINES[name], method=method)
    assert found == told(reference)
    assert len(found) > 4 or name == "no event"
    assert motion.status == TIME_UP
    end = reference[-1] if reference[-1].after is None else None
    assert end is not None
    assert motion.at.state.tobytes() == end.states[-1].tobytes()


def test_events_that_accumulate_end_the_motion_as_they_do_there():
    ball = system({"air": falls}, [GROUND])
    found, reference, motion = both(ball, [1.0, 0.0], "air", 30.0)
    assert reference[-1].status == motion.status == "chatter"
    limit = math.sqrt(2.0) * (1.0 + 2.0 * 0.7 / 0.3)
    assert found[-1][1] == pytest.approx(limit, rel=1e-9)
    assert found == told(reference)[: len(found)]


def test_a_transition_that_ends_the_motion_is_the_last_and_has_no_reset():
    given, x, mode, t1 = MACHINES["two modes"]
    found, reference, motion = both(given, x, mode, t1, ends={"under"})
    assert motion.status == "under"
    assert found == told(reference)[:2]
    assert motion.at.state[0] == pytest.approx(-0.1, abs=1e-12)


def test_what_ends_a_motion_at_entry_ends_it_where_it_begins():
    deep = Transition("deep", "air", "air", lambda t, x, p: -x[0], "rising", level=True)
    found, _, motion = both(system({"air": falls}, [deep]), [-1.0, 0.0], "air", 5.0, ends={"deep"})
    assert found == [("deep", 0.0)]
    assert motion.status == "deep"


def test_a_motion_of_too_many_steps_is_given_up():
    given, x, mode, _ = MACHINES["no event"]
    motion = MotionEvents(hybrid_machine(given, {"r": 0.7}), Control(1e-9, np.ones(2)), most_steps=20)
    assert list(motion.events(Standpoint(0.0, mode, np.array(x)), 1e7)) == []
    assert motion.status == TOO_MANY
