"""A driven block between two stops, with room for what is declared of it."""

PLUGIN = """\
import math
import numpy as np
from contwalk.system import Condition, Mode, Parameter, State, System, Transition

def slide(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1] - 0.1 * x[0]

def right(t, x, p):
    return 1.0 - x[0]

def left(t, x, p):
    return 1.0 + x[0]

def rebound(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.6 * x[1]

SYSTEM = System(
    "block",
    states=(State("x"), State("v")),
    parameters=(Parameter("force", 1.0),),
    modes=(Mode("only", slide),),
    transitions=(
        Transition("right", "only", "only", right, reset=rebound),
        Transition("left", "only", "only", left, reset=rebound),
        MORE
    ),
    conditions=(CONDITIONS),
    period=lambda p: 2.0 * math.pi,
)
"""
