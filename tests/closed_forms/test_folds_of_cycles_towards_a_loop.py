"""Folds of cycles from a generalized Hopf point towards a homoclinic loop, where orbits are cut on the way.

Wilson and Cowan's pair of populations with the numbers of Hoppensteadt and Izhikevich, Weakly Connected
Neural Networks (1997), section 2.2. It is its own image: (E, I, P, Q) -> (1 - E, 1 - I, -P, -12 - Q).
"""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied

pytestmark = pytest.mark.slow

PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = -x[0] + 1.0 / (1.0 + math.exp(-(10.0 * x[0] - 10.0 * x[1] + p.P)))
    dx[1] = -x[1] + 1.0 / (1.0 + math.exp(-(10.0 * x[0] + 2.0 * x[1] + p.Q)))

SYSTEM = System(
    "populations",
    states=(State("E", "", 1.0, "excitatory"), State("I", "", 1.0, "inhibitory")),
    parameters=(
        Parameter("P", 0.0, "", (-100.0, 100.0), "input"),
        Parameter("Q", 0.0, "", (-100.0, 100.0), "input"),
    ),
    modes=(Mode("field", field),),
)
"""
RUN = """
contwalk: 1
system: ./populations.py
start: {simulate: {state: {E: 0, I: 0}, until: settled}}
parameters: {P: -8, Q: -6}
continue: {parameter: P, range: [-10, 10], max_points: 250}
diagram: {follow: none}
loci: {with: Q, range: [-12, 4], of: [LP], follow: all}
figures: []
"""


def test_folds_do_not_turn_round_where_their_orbits_are_cut(tmp_path):
    """They went back to where they began, told as `shrunk`; or jumped to what is no solution, `rejoined`."""
    _, found, _ = studied(tmp_path, "populations", PLUGIN, RUN)
    folds = [b for b in found if b.info.settings.get("of_problem") == "periodic_orbit"]
    assert len(folds) == 2
    for curve in folds:
        assert curve.outcome.reason in ("max_points", "step_too_small", "homoclinic")
        sizes = [len(curve.unknowns(k)) for k in range(len(curve.points))]
        row = next(k for k, size in enumerate(sizes) if size > sizes[0])  # where it is cut
        period = curve.points["period"]
        assert np.all(np.diff(period[row - 5 : row + 4]) > 0.0)
        assert period[-1] > 12.0
