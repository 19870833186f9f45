"""An arm that is thrown back by a pad, with a load that lags: -0.8 at the pad where the force is 1.39."""

ARM = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.3 * x[1] - x[0]
    dx[2] = 0.5 * (x[0] - x[2])

def pad(t, x, p):
    return 0.6 - x[0]

def throw(t, x, p, after):
    speed = x[1]
    after[0] = x[0]
    after[1] = -0.5 * speed
    after[2] = x[2]

SYSTEM = System(
    "arm",
    states=(State("q"), State("w"), State("load")),
    parameters=(Parameter("force", 1.3),),
    modes=(Mode("free", swing),),
    transitions=(Transition("pad", "free", "free", pad, reset=throw),),
    period=lambda p: 2.0 * math.pi,
)
"""
