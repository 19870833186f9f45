"""A slender block that rocks on a shaken floor: its two guards are one function, which falls in one mode and
rises in the other.

Between impacts the angle obeys x'' = x -+ 1 + a cos(3 t), an impact leaves 0.8 of the rate. The orbit that is
its own image half a period later has closed-form legs, and half of it the determinant 0.64 in the instant and
the rate of an impact; it loses its symmetry where the trace of that half, and of the flip, is -1.64. With
mpmath, to 30 digits: a = 4.99151740832008101471945360884.

Source of the machine: S. J. Hogan, Proc. R. Soc. Lond. A 425, 441-476 (1989).
"""

from __future__ import annotations

import math

from hybrid_runs import diagram, machine

from contwalk.branch import Branch
from contwalk.system import Symmetry, System, Transition

LOST = 4.99151740832008


def right(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] - 1.0 + p.a * math.cos(3.0 * t)


def left(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] + 1.0 + p.a * math.cos(3.0 * t)


def upright(t, x, p):
    return x[0]


def lands(t, x, p, x_plus):
    x_plus[0] = 0.0 * x[0]
    x_plus[1] = 0.8 * x[1]


def flip(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def block(*symmetries: Symmetry) -> System:
    return machine(
        ["angle", "rate"],
        {"a": 4.0},
        {"right": right, "left": left},
        [
            Transition("to_left", "right", "left", upright, "falling", reset=lands),
            Transition("to_right", "left", "right", upright, "rising", reset=lands),
        ],
        period=lambda p: 2.0 * math.pi / 3.0,
        symmetries=symmetries,
    )


def rocking(*symmetries: Symmetry) -> tuple[Branch, ...]:
    return diagram(
        block(*symmetries),
        "a",
        (3.0, 6.5),
        [-0.2, 0.5],
        mode="left",
        until="settled",
        follow=["BP"],
        depth=1,
    )


MODES, EVENTS = {"right": "left", "left": "right"}, {"to_left": "to_right", "to_right": "to_left"}


def test_the_block_closes_up_to_its_flip_and_loses_it() -> None:
    parent, daughter = rocking(Symmetry("flip", "spatial", flip, modes=MODES, events=EVENTS))
    assert parent.info.closure == "flip"
    (lost,) = (point for point in parent.special_points if point.label == "BP")
    assert (lost.kind, lost.criticality) == ("symmetry-breaking", "supercritical")
    assert abs(lost.parameters["a"] - LOST) <= lost.error
    # One half of the branch is the image of the other one, and was not walked.
    assert daughter.info.settings["mirror"] == ("flip",)


def test_without_its_symmetry_the_same_orbits_are_found() -> None:
    parent, daughter = rocking()
    (lost,) = (point for point in parent.special_points if point.label == "BP")
    assert (lost.kind, lost.criticality) == ("pitchfork", "supercritical")
    assert abs(lost.parameters["a"] - LOST) <= lost.error
    assert len(daughter["a"]) > 10
