"""A curve of grazings of a doubled orbit between two walls, which is found from points on both of its halves.

x'' + 0.1 x' + x = 8 cos w t between walls at +-1, restitution r: five impacts in two periods, ten in four.
"""

from __future__ import annotations

import pytest
from loci_of_orbits import studied

pytestmark = pytest.mark.slow

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
RUN = """
contwalk: 1
system: ./walls.py
accuracy: 1e-8
start: {simulate: {state: {x: 0.0, v: 0.0}, until: settled}}
parameters: {w: 2.35, r: 0.7}
continue: {parameter: w, range: [2.25, 2.483], direction: both, max_points: 300}
diagram: {follow: [PD], depth: 1}
loci: {with: r, range: [0.62, 0.72], of: [GR], follow: none}
figures: []
"""


def test_a_curve_whose_limit_is_on_the_other_half_is_known(tmp_path):
    """The dip that touches is on the eighth leg where one branch ends, on the third where the other does."""
    _, found, notes = studied(tmp_path, "walls", PLUGIN, RUN)
    ends = [p for b in found if b.info.subharmonic == 4 for p in b.special_points if p.label == "GR"]
    (curve,) = [b for b in found if b.info.problem == "locus"]
    assert len([n for n in notes if n.endswith(f"lies on branch {curve.name}, already known.")]) == 1
    assert len({round(p.parameters["w"], 6) for p in ends}) > 1
