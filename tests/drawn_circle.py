"""A plugin with a `draw` whose cycles are circles of period 2 pi, born at a Hopf point, and its study."""

from __future__ import annotations

PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System


def field(t, x, p, dx):
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def draw(axes, t, x, p):
    axes.plot([0.0, x[0]], [0.0, x[1]], gid="arm")


SYSTEM = System(
    name="circle",
    states=(State("x", "m"), State("y", "m")),
    parameters=(Parameter("mu", -0.2, "N"),),
    modes=(Mode("turning", field),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    draw=draw,
)
"""
STUDY = """\
contwalk: 1
system: ./circle.py
start: {equilibrium: rest}
continue: {parameter: mu, range: [-0.2, 0.3]}
diagram: {follow: [HB], depth: 1}
output: circle.h5
"""
