"""Small hybrid machines whose motions are known in closed form."""

from __future__ import annotations

import math

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

# -- a ball on a table that moves up and down ----------------------------------------------------------------


def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g


def height(t, x, p):
    return x[0] - p.floor - p.a * math.sin(p.omega * t)


def bounce(t, x, p, x_plus):
    table = p.a * p.omega * math.cos(p.omega * t)
    x_plus[0] = x[0]
    x_plus[1] = table - p.e * (x[1] - table)


BALL = System(
    "ball",
    states=(State("y", "m"), State("v", "m/s")),
    parameters=(
        Parameter("g", 10.0),
        Parameter("e", 0.5),
        Parameter("floor", 0.0),
        Parameter("a", 0.0),
        Parameter("omega", 1.0),
    ),
    modes=(Mode("flight", fall),),
    transitions=(Transition("impact", "flight", "flight", height, reset=bounce),),
)

# -- an oscillator with a stop -------------------------------------------------------------------------------


def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.w * p.w * x[0]


STOP = System(
    "stop",
    states=(State("x", "m"), State("v", "m/s")),
    parameters=(Parameter("w", 1.0), Parameter("e", 1.0), Parameter("gap", 0.5)),
    modes=(Mode("free", swing),),
    transitions=(
        Transition(
            "stop",
            "free",
            "free",
            lambda t, x, p: p.gap - x[0],
            reset=lambda t, x, p, x_plus: x_plus.__setitem__(slice(None), [x[0], -p.e * x[1]]),
        ),
        Transition("middle", "free", "free", lambda t, x, p: x[0], direction="both", role="watched"),
    ),
)

# -- two counters, each set back on its own ------------------------------------------------------------------


def count_down(t, x, p, dx):
    dx[0] = -1.0
    dx[1] = -1.0
    dx[2] = 0.0


def set_back(which, value):
    def reset(t, x, p, x_plus):
        for i in range(3):
            x_plus[i] = x[i]
        x_plus[which] = value
        # the order in which both are set back remains in the last state
        x_plus[2] = 2.0 * x[2] + which

    return reset


COUNTERS = System(
    "counters",
    states=(State("first"), State("second"), State("order")),
    parameters=(),
    modes=(Mode("counting", count_down),),
    transitions=(
        Transition("a", "counting", "counting", lambda t, x, p: x[0], reset=set_back(0, 1.0)),
        Transition("b", "counting", "counting", lambda t, x, p: x[1], reset=set_back(1, 2.0)),
    ),
)

# -- a damper that resists in one direction only -------------------------------------------------------------


def extend(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0]


def compress(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 2.0 * p.d * x[1]


DAMPER = System(
    "damper",
    states=(State("x"), State("v")),
    parameters=(Parameter("d", 0.1),),
    modes=(Mode("extending", extend), Mode("compressing", compress)),
    transitions=(
        Transition("turns_in", "extending", "compressing", lambda t, x, p: x[1], role="soft"),
        Transition("turns_out", "compressing", "extending", lambda t, x, p: x[1], "rising", role="soft"),
    ),
)

# -- modes with different states -----------------------------------------------------------------------------


def leak(t, x, p, dx):
    dx[1] = -x[1]


def fly(t, x, p, dx):
    dx[0] = x[2]
    dx[2] = -2.0


def launch(t, x, p, x_plus):
    x_plus[0] = 0.0
    x_plus[2] = 4.0 * x[1]


def fill(t, x, p, x_plus):
    x_plus[1] = p.filling


# A tank leaks from `filling` to a half, then a ball flies for 2 s from a speed of 4 z = 2.
CHANGING = System(
    "changing",
    states=(State("y"), State("z"), State("v")),
    parameters=(Parameter("filling", 1.0),),
    modes=(Mode("leaking", leak, states=("z",)), Mode("flying", fly, states=("v", "y"))),
    transitions=(
        Transition("empty", "leaking", "flying", lambda t, x, p: x[1] - 0.5, reset=launch),
        Transition("landed", "flying", "leaking", lambda t, x, p: x[0], reset=fill),
    ),
)

# -- names that are swapped ----------------------------------------------------------------------------------


def grow(t, x, p, dx):
    dx[0] = 1.0
    dx[1] = -x[1]


def swapped(t, x, p, x_image):
    x_image[0] = x[1]
    x_image[1] = x[0]


# The first grows up to 1 and is then called the second, which meanwhile has decayed.
SWAP = System(
    "swap",
    states=(State("first"), State("second")),
    parameters=(),
    modes=(Mode("on", grow),),
    transitions=(Transition("full", "on", "on", lambda t, x, p: 1.0 - x[0], relabel="swap"),),
    symmetries=(Symmetry("swap", "relabel", swapped),),
)

# -- kicks by the clock --------------------------------------------------------------------------------------


def still(t, x, p, dx):
    dx[0] = 0.0


def kick(t, x, p, x_plus):
    x_plus[0] = x[0] + 1.0


KICKS = System(
    "kicks",
    states=(State("n"),),
    parameters=(Parameter("half", 1.0),),
    modes=(Mode("resting", still),),
    transitions=(
        Transition(
            "kick",
            "resting",
            "resting",
            lambda t, x, p: math.cos(math.pi * t / p.half),
            direction="both",
            reset=kick,
        ),
    ),
)
