"""Walking on two springs (Geyer, Seyfarth & Blickhan 2006): curves whose solutions are known to few digits.

The branch points were computed by SciPy's DOP853 (own return map of symmetric gaits, det(J - 1) = 0).
"""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied
from scipy.interpolate import CubicSpline

PLUGIN = """
import math

from contwalk.system import Conserved, Mode, Parameter, State, System, Transition

X, Y, VX, VY, D = range(5)


def push(x, y, p):
    return p.k / 80.0 * (1.0 / math.hypot(x, y) - 1.0)


def single(t, x, p, dx):
    s = push(x[X], x[Y], p)
    dx[X], dx[Y], dx[VX], dx[VY] = x[VX], x[VY], s * x[X], s * x[Y] - 9.81


def double(t, x, p, dx):
    s, f = push(x[X], x[Y], p), push(x[X] - x[D], x[Y], p)
    dx[X], dx[Y], dx[D] = x[VX], x[VY], 0.0
    dx[VX], dx[VY] = s * x[X] + f * (x[X] - x[D]), (s + f) * x[Y] - 9.81


def foot_height(t, x, p):
    return x[Y] - math.sin(math.radians(p.alpha))


def rear_length(t, x, p):
    return 1.0 - math.hypot(x[X], x[Y])


def set_down(t, x, p, after):
    after[X], after[Y], after[VX], after[VY] = x[X], x[Y], x[VX], x[VY]
    after[D] = x[X] + math.cos(math.radians(p.alpha))


def lift_rear(t, x, p, after):
    after[X], after[Y], after[VX], after[VY] = x[X] - x[D], x[Y], x[VX], x[VY]


def in_single(t, x, p):
    moving = 40.0 * (x[VX] ** 2 + x[VY] ** 2) + 80.0 * 9.81 * x[Y]
    return moving + 0.5 * p.k * (1.0 - math.hypot(x[X], x[Y])) ** 2


def in_double(t, x, p):
    return in_single(t, x, p) + 0.5 * p.k * (1.0 - math.hypot(x[X] - x[D], x[Y])) ** 2


SYSTEM = System(
    "walker",
    states=tuple(State(name) for name in ("x", "y", "vx", "vy", "d")),
    parameters=(Parameter("k", 14000.0, bounds=(1.0, None)), Parameter("alpha", 69.0, bounds=(1.0, 90.0))),
    modes=(Mode("single", single, states=("x", "y", "vx", "vy")), Mode("double", double)),
    transitions=(
        Transition("touchdown", "single", "double", foot_height, reset=set_down),
        Transition("takeoff", "double", "single", rear_length, reset=lift_rear),
    ),
    conserved=(Conserved("energy", {"single": in_single, "double": in_double}),),
)
"""
RUN = """
system: ./walker.py
start: {simulate: {state: {x: 0.0, y: 0.976754873, vx: 1.11423095, vy: 0.0}, mode: single, until: 0}}
continue: {parameter: alpha, range: [67.0, 78.0]}
diagram: {follow: none, depth: 1}
engine: {max_step: 0.4, max_share: 0.1}
loci: {with: k, range: [12000, 21300], of: [BP, NS], follow: none}
output: walker.h5
"""


@pytest.mark.slow
def test_errors_of_steps_are_no_unfolding_and_a_leg_without_duration_is_an_end(tmp_path) -> None:
    _, (_, *curves), _ = studied(tmp_path, "walker", PLUGIN, RUN)
    of = {curve.info.settings["of"]: curve for curve in curves}
    crossings, tori = of["BP"], of["NS"]
    known = {13600.0: 70.31953, 13500.0: 70.24896, 13000.0: 69.88434, 12000.0: 69.09033}
    at = CubicSpline(crossings["k"], crossings["alpha"])(list(known))
    np.testing.assert_allclose(at, list(known.values()), atol=2e-4)  # points are known to 1e-4
    assert crossings.outcome.status != "failed"
    # Single support lasts no time at alpha = 77.39857, k = 20964.21, where the height arrives without a rate.
    assert (tori.outcome.status, tori.outcome.reason) == ("stopped", "order_change")
    assert "between them mode single lasts no time. So it is to what the orbits" in tori.outcome.message
    assert not [point.label for point in tori.special_points if point.label == "R3"]
    assert np.all(np.diff(tori.points["s"]) > 1e-7)
