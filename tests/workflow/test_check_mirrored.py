"""A declared symmetry of a machine with events takes transitions to transitions; else that is told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from checked_plugins import broken, checked, line_of, troubles
from hybrid_runs import machine

from contwalk.continuation.settings import Settings
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Symmetry, Transition

# A shaken mass between two stops.
STOPS = """\
import math
from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1]

def right(t, x, p):
    return p.gap - x[0]

def left(t, x, p):
    return p.gap + x[0]

def hit(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.5 * x[1]

def softer(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.4 * x[1]

def turned(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]

SYSTEM = System(
    name="stops",
    states=(State("x", unit="m", about="place"), State("v", unit="m/s", about="velocity")),
    parameters=(
        Parameter("gap", 1.0, unit="m", about="to a stop"),
        Parameter("force", 1.0, unit="m/s^2", about="shakes"),
    ),
    modes=(Mode("free", free),),
    transitions=(
        Transition("right", "free", "free", right, reset=hit),
        Transition("left", "free", "free", left, reset=hit),
    ),
    symmetries=(Symmetry("mirror", "spatial", turned, events={"right": "left", "left": "right"}),),
    period=lambda p: 2.0 * math.pi,
    reference="any textbook",
)
"""


def test_a_symmetry_that_takes_transitions_to_transitions_passes(tmp_path):
    findings = checked(tmp_path, STOPS)
    assert troubles(findings) == []
    assert "takes all 2 transitions to transitions." in [f.sentence for f in findings]


# The old text, the new text, parts of the sentence.
WRONG = {
    "no images": (
        ', events={"right": "left", "left": "right"}', "",
        ("does not take transition 'right' to itself", "declare events={'right': 'left', ...}"),
    ),
    "a stop that is softer": (
        "left, reset=hit)", "left, reset=softer)",
        ("does not take transition 'right' to 'left': guard or reset", "Correct the map"),
    ),
    "a stop that is farther": (
        "return p.gap + x[0]", "return 1.1 * p.gap + x[0]",
        ("does not take transition 'left' to 'right': guard or reset", "Correct the map"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
def test_a_transition_that_is_not_taken_to_its_image_is_told(tmp_path, wrong):
    old, new, parts = WRONG[wrong]
    source = broken(STOPS, old, new)
    found = [f for f in troubles(checked(tmp_path, source)) if f.what == "symmetry 'mirror'"]
    assert {f.level for f in found} == {"warning"}
    assert all(any(part in f.sentence for f in found) for part in parts), found
    assert {f.line for f in found} == {line_of(source, "def turned")}


# Two shaken masses that do not know of each other, each with its own stop.
TWINS = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def free(t, x, p, dx):
    for k in (0, 2):
        dx[k] = x[k + 1]
        dx[k + 1] = p.force * math.cos(t) - 0.2 * x[k + 1] - x[k]

def hits(k):
    def hit(t, x, p, after):
        for i in range(4):
            after[i] = -0.8 * x[i] if i == k + 1 else x[i]
    return hit

SYSTEM = System(
    name="twins",
    states=tuple(State(name, unit="1", about="of a mass") for name in ("a", "va", "b", "vb")),
    parameters=(Parameter("force", 1.0, unit="1", about="shakes"),),
    modes=(Mode("free", free),),
    transitions=(
        Transition("ka", "free", "free", lambda t, x, p: 1.0 - x[0], reset=hits(0)),
        Transition("kb", "free", "free", lambda t, x, p: 1.0 - x[2], reset=hits(2)),
    ),
    period=lambda p: 2.0 * math.pi,
    reference="any textbook",
)
"""


def test_two_machines_in_one_are_sound(tmp_path):
    """States that are sampled on one guard may be past the other: no motion gets there."""
    assert troubles(checked(tmp_path, TWINS)) == []


# -- what a run says -----------------------------------------------------------------------------------------


def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1] - p.spring * x[0]


def hit(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.5 * x[1]


def turned(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]


def started(events: dict[str, str], spring: float = 0.0, softer: float = 0.0):
    def other(t, x, p, after):
        after[0] = x[0]
        after[1] = -(0.5 - softer) * x[1]

    system = machine(
        ["x", "v"],
        {"force": 0.6, "gap": 1.0, "spring": spring},
        {"free": free},
        [
            Transition("right", "free", "free", lambda t, x, p: p.gap - x[0], reset=hit),
            Transition("left", "free", "free", lambda t, x, p: p.gap + x[0], reset=other),
        ],
        period=lambda p: 2.0 * math.pi,
        symmetries=(Symmetry("mirror", "spatial", turned, events=events),),
    )
    values, settings = {"force": 0.6, "gap": 1.0, "spring": spring}, Settings(range=(0.5, 2.0))
    return opened_orbit(system, values, "gap", np.array([0.0, 0.3]), settings, until="settled")


BOTH = {"right": "left", "left": "right"}


def test_a_symmetry_that_is_used_needs_no_word():
    opening = started(BOTH)
    assert opening.problem.itinerary.image == "mirror"
    assert opening.message == ""


@pytest.mark.parametrize(
    ("events", "spring", "softer", "why"),
    [
        ({}, 0.0, 0.0, "transition 'left' is not taken to its image"),
        (BOTH, 0.0, 0.1, "transition 'left' is not taken to its image"),
        (BOTH, 9.0, 0.0, "an orbit without events is followed over its whole period"),
    ],
)
def test_a_symmetry_that_is_not_used_is_told_with_the_reason(events, spring, softer, why):
    opening = started(events, spring, softer)
    assert opening.problem.itinerary.image == ""
    assert opening.message.startswith("Symmetry 'mirror' is not used: ")
    assert why in opening.message.replace("'right'", "'left'")  # whichever comes first
