"""The states of the walker and where they stand in `x`.

Axes of the slope N: 1 to the side, 2 away from the slope, 3 downhill. The frame V turns with the walker but
for its pitch: N is turned by q6 about axis 3, then by q5 about the new axis 2. Torso and legs turn about
axis 1 of V, the hip line. The velocities u1..u6 have components along the axes of V, which do not depend on
the pitch q4.
"""

from __future__ import annotations

from contwalk.system import State

Q1, Q2, Q3, Q4, Q5, Q6, Q7, Q8, Q9, Q10 = range(10)
P1 = 10
U1, U2, U3, U4, U5, U6, U7, U8, U9, U10 = range(18, 28)

LEGS = (1, 2)
TOES = (1, 2)
THIGH_ANGLE = {1: Q7, 2: Q9}
KNEE = {1: Q8, 2: Q10}
THIGH_RATE = {1: U7, 2: U9}
KNEE_RATE = {1: U8, 2: U10}


def anchor(leg: int, toe: int) -> tuple[int, int]:
    """Where the anchor of a toe stands in `x`: its components to the side and downhill."""
    first = P1 + 4 * (leg - 1) + 2 * (toe - 1)
    return first, first + 1


def anchor_names(leg: int, toe: int) -> tuple[str, str]:
    """Names of the states that are the anchor of a toe."""
    return tuple(STATES[place].name for place in anchor(leg, toe))


STATES = (
    State("q1", "m", 0.1, about="position of the hip's centre T, to the side"),
    State("q2", "m", 0.1, about="height of T above the slope"),
    State("q3", "m", 0.3, about="position of T, downhill"),
    State("q4", "rad", 0.3, about="pitch of the torso about the hip line"),
    State("q5", "rad", 0.1, about="second angle of the hip line, about the turned axis 2: heading"),
    State("q6", "rad", 0.1, about="first angle of the hip line, about axis 3: sway"),
    State("q7", "rad", 0.3, about="angle of thigh 1 about the hip line"),
    State("q8", "rad", 0.5, about="angle of knee 1; negative in hyperextension"),
    State("q9", "rad", 0.3, about="angle of thigh 2 about the hip line"),
    State("q10", "rad", 0.5, about="angle of knee 2; negative in hyperextension"),
    *(
        State(
            f"p{4 * (leg - 1) + 2 * (toe - 1) + number}",
            "m",
            0.1,
            about=f"where toe {leg}{toe} touched down: {way}",
        )
        for leg in LEGS
        for toe in TOES
        for number, way in ((1, "from T, to the side"), (2, "from T, downhill"))
    ),
    State("u1", "m/s", 0.3, about="velocity of T along the hip line"),
    State("u2", "m/s", 0.3, about="velocity of T along axis 2 of V: upwards"),
    State("u3", "m/s", 0.3, about="velocity of T along axis 3 of V: forwards"),
    State("u4", "rad/s", 1.0, about="angular velocity of the torso about the hip line"),
    State("u5", "rad/s", 1.0, about="angular velocity about axis 2 of V"),
    State("u6", "rad/s", 1.0, about="angular velocity about axis 3 of V"),
    State("u7", "rad/s", 3.0, about="rate of q7"),
    State("u8", "rad/s", 3.0, about="rate of q8"),
    State("u9", "rad/s", 3.0, about="rate of q9"),
    State("u10", "rad/s", 3.0, about="rate of q10"),
)
