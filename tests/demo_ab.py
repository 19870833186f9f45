"""The reaction A -> B in a stirred tank: AUTO-07p (Doedel et al.), demo ab."""

from __future__ import annotations

AB = """
import math
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    e = math.exp(x[1])
    dx[0] = -x[0] + p.p1 * (1 - x[0]) * e
    dx[1] = -x[1] + p.p1 * p.p2 * (1 - x[0]) * e - 3.0 * x[1]


SYSTEM = System(
    "ab",
    states=(State("u1"), State("u2")),
    parameters=(Parameter("p1", 0.0), Parameter("p2", 24.0)),
    modes=(Mode("smooth", field),),
)
"""
