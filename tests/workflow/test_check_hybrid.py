"""`contwalk systems check` for plugins with several modes, relabelling, conditions and events."""

from __future__ import annotations

import pytest
from checked_plugins import broken, checked, line_of, troubles

# A hopper: it flies (y, v), lands, and then its leg is compressed (y, v, f with a lag). Legs take turns.
HOPPER = """\
import math
from contwalk.system import (
    Condition, Mode, Observable, Parameter, State, Symmetry, System, Transition
)

Y, V, F, LEFT, RIGHT = range(5)

def fly(t, x, p, dx):
    dx[Y] = x[V]
    dx[V] = -p.g
    dx[LEFT] = 1.0
    dx[RIGHT] = -x[RIGHT]

def press(t, x, p, dx):
    dx[Y] = x[V]
    dx[V] = -p.g + x[F]
    dx[F] = (p.k * (1.0 - x[Y]) - x[F]) / p.lag
    dx[LEFT] = 0.0
    dx[RIGHT] = 0.0

def height(t, x, p):
    return x[Y] - 1.0

def length(t, x, p):
    return x[Y] - 1.0

def touch(t, x, p, x_plus):
    x_plus[Y] = x[Y]
    x_plus[V] = x[V]
    x_plus[F] = 0.0
    x_plus[LEFT] = x[LEFT]
    x_plus[RIGHT] = x[RIGHT]

def lift(t, x, p, x_plus):
    x_plus[Y] = x[Y]
    x_plus[V] = x[V]
    x_plus[LEFT] = x[LEFT]
    x_plus[RIGHT] = 0.0

def swapped(t, x, p, x_image):
    x_image[Y] = x[Y]
    x_image[V] = x[V]
    x_image[F] = x[F]
    x_image[LEFT] = x[RIGHT]
    x_image[RIGHT] = x[LEFT]

def fast(t, x, p):
    return -x[V]

def force(t, x, p):
    return x[F]

def speed(t, x, p):
    return abs(x[V])

SYSTEM = System(
    name="hopper",
    states=(
        State("y", unit="m", about="height"),
        State("v", unit="m/s", about="velocity"),
        State("f", unit="N", about="force of the leg"),
        State("left", unit="s", about="age of the left leg"),
        State("right", unit="s", about="age of the right leg"),
    ),
    parameters=(
        Parameter("g", 9.81, unit="m/s^2", about="gravity"),
        Parameter("k", 200.0, unit="1/s^2", about="stiffness"),
        Parameter("lag", 0.01, unit="s", about="of the leg"),
    ),
    modes=(
        Mode("flight", fly, states=("y", "v", "left", "right")),
        Mode("stance", press),
    ),
    transitions=(
        Transition("touch_down", "flight", "stance", height, reset=touch),
        Transition("lift_off", "stance", "flight", length, "rising", reset=lift, relabel="legs"),
    ),
    symmetries=(Symmetry("legs", "relabel", swapped),),
    conditions=(
        Condition("falls", fast, "touch_down", unit="m/s"),
        Condition("pushes", force, "lift_off", unit="N"),
    ),
    observables=(Observable("landing_speed", speed, unit="m/s", at="touch_down", side="after"),),
    reference="any textbook",
)
"""


def test_a_good_hybrid_plugin_passes(tmp_path):
    findings = checked(tmp_path, HOPPER)
    assert troubles(findings) == []
    said = {finding.what: finding.sentence for finding in findings}
    assert said["field of mode 'flight'"].startswith("writes the 4 components that exist there")
    assert said["field of mode 'stance'"].startswith("writes all 5 components")
    assert "of 'touch_down'" in said["sample motions"]
    assert "of 'lift_off'" in said["sample motions"]
    assert said["symmetry 'legs'"] == "applied twice it gives the state back: it swaps names."
    assert said["condition 'pushes'"] == "gives a finite number before 'lift_off'."
    assert said["observable 'landing_speed'"] == "gives a finite number after 'touch_down'."


# the old text, the new text, level, what, a part of the sentence, a text on the line
MISTAKES = {
    "field that leaves out a state of its mode": (
        "    dx[V] = -p.g\n    dx[LEFT]", "    dx[LEFT]", "error",
        "field of mode 'flight'", "does not write dx[1] (state v)", "def fly",
    ),
    "reset that leaves out a state of the target": (
        "    x_plus[F] = 0.0\n", "", "error",
        "reset of transition 'touch_down'", "does not write x_plus[2] (state f)", "def touch",
    ),
    "reset that leaves out a state which the relabelling needs": (
        "    x_plus[RIGHT] = 0.0\n", "", "error",
        "reset of transition 'lift_off'", "does not write x_plus[4] (state right)", "def lift",
    ),
    "names that do not come back": (
        "x_image[RIGHT] = x[LEFT]", "x_image[RIGHT] = 2.0 * x[LEFT]", "error",
        "symmetry 'legs'", "Applied twice it does not give the state back: left is", "def swapped",
    ),
    "guard that only comes to zero": (
        "def height(t, x, p):\n    return x[Y] - 1.0", "def height(t, x, p):\n    return (x[Y] - 1.0) ** 3",
        "error",
        "guard of transition 'touch_down'", "does not pass zero, it only comes to it", "def height",
    ),
    "field that reads a state which does not exist": (
        "    dx[RIGHT] = -x[RIGHT]", "    dx[RIGHT] = x[F] - x[RIGHT]", "warning",
        "field of mode 'flight'", "reads x[2] (state f), which does not exist in mode 'flight'", "def fly",
    ),
    "field that writes a state which does not exist": (
        "    dx[RIGHT] = -x[RIGHT]", "    dx[RIGHT] = -x[RIGHT]\n    dx[F] = 1.0", "warning",
        "field of mode 'flight'", "writes dx[2] (state f), which does not exist in mode 'flight'", "def fly",
    ),
    "reset that reads a state which does not exist": (
        "    x_plus[F] = 0.0\n", "    x_plus[F] = 0.5 * x[F]\n", "warning",
        "reset of transition 'touch_down'", "reads x[2] (state f)", "def touch",
    ),
    "guard that reads a state which does not exist": (
        "def height(t, x, p):\n    return x[Y] - 1.0", "def height(t, x, p):\n    return x[Y] - 1.0 + x[F]",
        "warning", "guard of transition 'touch_down'", "reads x[2] (state f)", "def height",
    ),
    "guard that turns back": (
        "def height(t, x, p):\n    return x[Y] - 1.0",
        "def height(t, x, p):\n    return x[Y] ** 2 - 2.0 * x[Y] + 1.0",
        "error", "guard of transition 'touch_down'", "stays zero, or turns back", "def height",
    ),
    "guard that is never zero": (
        "def height(t, x, p):\n    return x[Y] - 1.0",
        "def height(t, x, p):\n    return x[Y] ** 2 - 2.0 * x[Y] + 2.0",
        "warning", "guard of transition 'touch_down'", "it is positive at all 8 states", "def height",
    ),
    "guard that stays zero": (
        "def height(t, x, p):\n    return x[Y] - 1.0",
        "def height(t, x, p):\n    return max(x[Y] - 1.0, 0.0)",
        "error", "guard of transition 'touch_down'", "It is never negative", "def height",
    ),
    "soft transition between modes of other states": (
        "height, reset=touch", "height, reset=touch, role='soft'", "error",
        "transition 'touch_down'", "do not have the same states (f)", "def height",
    ),
    "watched transition with a reset": (
        "    transitions=(\n",
        "    transitions=(\n"
        "        Transition('peak', 'flight', 'flight', fast, reset=touch, role='watched'),\n",
        "warning", "reset of transition 'peak'", "its reset is never used", "def touch",
    ),
    "condition that raises": (
        "return -x[V]", "return -x[7]", "error", "condition 'falls'", "IndexError", "return -x[7]",
    ),
    "condition without a value": (
        "return x[F]", "return x[F] / (0.0 * x[Y])", "error",
        "condition 'pushes'", "not finite at any state before 'lift_off'", "def force",
    ),
    "condition that returns nothing": (
        "    return x[F]", "    x[F]", "error", "condition 'pushes'", "It returns nothing", "def force",
    ),
    "observable of a motion at an event": (
        "return abs(x[V])", "return abs(x[:, V])", "error",
        "observable 'landing_speed'", "IndexError", "return abs(x[:, V])",
    ),
}  # fmt: skip


@pytest.mark.drawn(9)
@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_its_line(tmp_path, mistake):
    old, new, level, what, sentence, on_line = MISTAKES[mistake]
    source = broken(HOPPER, old, new)
    found = [f for f in checked(tmp_path, source) if f.level == level and f.what == what]
    assert any(sentence in f.sentence for f in found), [f.sentence for f in found]
    finding = next(f for f in found if sentence in f.sentence)
    assert finding.line == line_of(source, on_line)


BALL = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -10.0 + p.pull

def height(t, x, p):
    return x[0]

def lands(t, x, p, x_plus):
    x_plus[0] = 0.0
    x_plus[1] = -p.e * x[1]

SYSTEM = System(
    name="ball",
    states=(State("y", unit="m", about="height"), State("v", unit="m/s", about="velocity")),
    parameters=(
        Parameter("e", 0.0, unit="1", about="restitution"),
        Parameter("pull", 0.0, unit="m/s^2", about="upwards"),
    ),
    modes=(Mode("flight", fall),),
    transitions=(Transition("impact", "flight", "flight", height, reset=lands),),
    reference="any textbook",
)
"""


def test_a_ball_that_stays_on_the_floor_is_told(tmp_path):
    found = {f.what: f for f in troubles(checked(tmp_path, BALL))}
    assert found["reset of transition 'impact'"].level == "error"
    assert "at every state" in found["reset of transition 'impact'"].sentence
    assert found["sample motions"].level == "error"  # every one of them ends so
    assert "The plugin must declare a mode" in found["sample motions"].sentence
    assert found["sample motions"].line == line_of(BALL, "def lands")


def test_an_event_that_changes_nothing_is_told(tmp_path):
    """In its own mode and without a reset the ball goes on falling, below its floor."""
    source = broken(BALL, "height, reset=lands", "height")
    found = {f.what: f for f in troubles(checked(tmp_path, source))}
    assert found["transition 'impact'"].level == "error"
    assert found["transition 'impact'"].line == line_of(source, "def height")


def test_a_mode_that_begins_with_zeros_is_told(tmp_path):
    """A ball that lies in a box with states of its own, and no reset that says what they are."""
    source = broken(
        BALL,
        'modes=(Mode("flight", fall),)',
        """modes=(
        Mode("flight", fall, states=("y", "v")), Mode("lying", lie, states=("rolled",)),
    )""",
    )
    source = broken(source, '"flight", height, reset=lands', '"lying", height')
    source = broken(source, "def height", "def lie(t, x, p, dx):\n    dx[2] = p.e - x[2]\n\ndef height")
    source = broken(
        source, 'about="velocity"))', 'about="velocity"), State("rolled", unit="m", about="way"))'
    )
    found = {f.what: f for f in troubles(checked(tmp_path, source))}
    assert "have no state in common" in found["transition 'impact'"].sentence
    assert found["transition 'impact'"].level == "warning"


def test_a_ball_without_restitution_that_is_pulled_off_is_fine(tmp_path):
    # Its rate is zero after the impact; its second derivative says that it leaves.
    source = broken(BALL, 'Parameter("pull", 0.0', 'Parameter("pull", 12.0')
    assert troubles(checked(tmp_path, source)) == []


def test_a_ball_whose_impacts_accumulate_is_no_mistake(tmp_path):
    source = broken(BALL, 'Parameter("e", 0.0', 'Parameter("e", 0.001')
    findings = checked(tmp_path, source)
    assert troubles(findings) == []
    assert any("Transitions of some accumulate" in f.sentence for f in findings)
