"""A plugin: x'' + 0.1 x' + x = 8 cos w t between walls at +-1, restitution r."""

PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = 8.0 * math.cos(p.w * t) - x[0] - 0.1 * x[1]

def bounce(t, x, p, after):
    after[0] = x[0]
    after[1] = -p.r * x[1]

SYSTEM = System(
    "walls",
    states=(State("x", "", 1.0, "place"), State("v", "", 1.0, "velocity")),
    parameters=(
        Parameter("w", 2.5, "", (0.1, 20.0), "frequency"),
        Parameter("r", 0.7, "", (0.0, 1.0), "restitution"),
    ),
    modes=(Mode("free", free),),
    transitions=(
        Transition("right", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),
        Transition("left", "free", "free", lambda t, x, p: x[0] + 1.0, reset=bounce),
    ),
    period=lambda p: 2.0 * math.pi / p.w,
)
"""
