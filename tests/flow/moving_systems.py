"""Small systems with motions in closed form, for the tests of the flow."""

from __future__ import annotations

import math

from contwalk.system import Mode, Observable, Parameter, State, System


def spring(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.w * p.w * x[0] - 2.0 * p.d * x[1]


OSCILLATOR = System(
    "oscillator",
    states=(State("x", "m"), State("v", "m/s")),
    parameters=(Parameter("w", 1.0, "1/s"), Parameter("d", 0.0, "1/s"), Parameter("level", 0.5, "m")),
    modes=(Mode("swinging", spring),),
)


def decay(t, x, p, dx):
    dx[0] = -p.rate * x[0]
    dx[1] = p.speed


DECAY = System(
    "decay",
    states=(State("x", scale=1.0), State("angle", "rad", scale=1.0, period=2.0 * math.pi)),
    parameters=(Parameter("rate", 1.0), Parameter("speed", 0.0)),
    modes=(Mode("falling", decay),),
    observables=(Observable("height", lambda t, x, p: x[:, 0].max()),),
)


def blowing_up(t, x, p, dx):
    dx[0] = x[0] * x[0]


EXPLOSION = System("explosion", states=(State("x"),), parameters=(), modes=(Mode("up", blowing_up),))
