"""The states of the walker and where they stand in `x`, and the swap of names of its legs.

q1 and q2 are the angles of the thighs of leg 1 and leg 2 from the normal of the slope, counter-clockwise; q3
is the flexion of the knee of leg 2, q6 that of leg 1. Leg 1 stands, leg 2 swings. The walker walks down the
slope to the right, so that a stance leg turns clockwise: u1 < 0.
"""

from __future__ import annotations

from typing import Any

from contwalk.system import State, Symmetry

Q1, Q2, Q3, Q6, U1, U2, U3 = range(7)

STATES = (
    State("q1", "rad", about="angle of the thigh of the stance leg from the normal of the slope"),
    State("q2", "rad", about="angle of the thigh of the swing leg from the normal of the slope"),
    State("q3", "rad", about="flexion of the knee of the swing leg"),
    State("q6", "rad", about="flexion of the knee of the stance leg, which is locked: zero"),
    State("u1", "rad/s", about="rate of q1"),
    State("u2", "rad/s", about="rate of q2"),
    State("u3", "rad/s", about="rate of q3"),
)
IN_THREE_LINK = ("q1", "q2", "q3", "u1", "u2", "u3")
IN_TWO_LINK = ("q1", "q2", "u1", "u2")


def _swapped(t: Any, x: Any, p: Any, x_image: Any) -> None:
    """Leg 1 is called leg 2. u3 is the rate of whichever knee is free, and q6 has no rate: it is locked."""
    x_image[Q1] = x[Q2]
    x_image[Q2] = x[Q1]
    x_image[Q3] = x[Q6]
    x_image[Q6] = x[Q3]
    x_image[U1] = x[U2]
    x_image[U2] = x[U1]
    x_image[U3] = x[U3]


LEGS = Symmetry("legs", "relabel", _swapped, about="leg 1 is called leg 2, and leg 2 leg 1")
