"""A resonance 1:2 in closed form: curves of doublings, tori, and tori of doubled orbits meet there.

The map (x, y) -> (-x + y, -y + e1 x + e2 y + c x^3 + d x^2 y) commutes with half a turn. Doubled orbits are
(x, 0), (-x, 0) with x^2 = -e1 / c. Half of one, turned, has the trace 2 - e2 + d e1 / c and the determinant
1 + 2 e1 - e2 + d e1 / c: tori where e2 = (2 + d / c) e1, 0 < e1 < 2, of the angle 2 acos(1 - e1). The single
orbit doubles where e1 = 0, and has tori where e2 = -e1, e1 < 0. Its cubic coefficient c / e2 has a pole at
the resonance, and no zero.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import FINE, WALKED, assert_at, labels, largest, map_as_machine, map_plugin, studied

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram.reopening import reopened

pytestmark = pytest.mark.slow

C, D = -1.0, 0.3
SLOPE = 2.0 + D / C

IMAGES = ("-x[0] + x[1]", "-x[1] + p.e1 * x[0] + p.e2 * x[1] - x[0] ** 3 + 0.3 * x[0] ** 2 * x[1]")
PLUGIN = map_plugin("resonant", IMAGES, {"e1": 0.3, "e2": 0.4})

RUN = """
contwalk: 1
system: ./resonant.py
accuracy: 1e-9
start: {state: {x: 0.0, y: 0.0}}
parameters: {e1: -0.3, e2: 0.2}
continue: {parameter: e1, range: [-0.4, 0.4]}
engine: {max_share: 0.03125}
diagram: {follow: none}
loci: {with: e2, range: [-0.3, 0.45], of: [NS, PD], follow: all}
figures: []
"""


def resonant():
    return map_as_machine(
        lambda x, p: (
            -x[0] + x[1],
            -x[1] + p.e1 * x[0] + p.e2 * x[1] + C * x[0] ** 3 + D * x[0] ** 2 * x[1],
        ),
        "xy",
        {"e1": 0.1, "e2": 0.3},
    )


@pytest.mark.long
def test_every_curve_of_the_resonance_is_found(tmp_path):
    _, branches, _ = studied(tmp_path, "resonant", PLUGIN, RUN)
    curves = {
        (b.info.settings["of"], len(b.info.signature)): b for b in branches if b.info.problem == "locus"
    }
    assert sorted(curves) == [("NS", 1), ("NS", 2), ("PD", 1)]
    tori, doublings, doubled = curves["NS", 1], curves["PD", 1], curves["NS", 2]
    assert largest(doublings["e1"]) < WALKED
    assert labels(doublings) == ["R2"]  # no zero of the cubic coefficient is made of its pole
    assert largest(tori["e2"] + tori["e1"]) < WALKED
    assert labels(tori) == ["R2"]
    for curve in (tori, doublings):
        assert_at(curve, "R2", [(0.0, 0.0)])
    assert doubled.info.origin.endswith("/R21")
    assert largest(doubled["e2"] - SLOPE * doubled["e1"]) < WALKED
    (end,) = [p for p in doubled.special_points if p.kind == "bound"]
    # an end of the range of one parameter is a place of the curve, and the other has its own error
    assert abs(end.parameters["e1"] - 0.45 / SLOPE) <= end.errors["e1"] == end.error < 1e-8
    assert end.parameters["e2"] == 0.45


@pytest.mark.long
def test_tori_of_doubled_orbits_end_where_these_become_single():
    x = math.sqrt(0.1)
    start = [x, 0.0]
    branch = branch_of(resonant(), "e1", (0.05, 0.4), start, {"e1": 0.1, "e2": 0.3})
    curve = cw.continue_locus(resonant(), branch, "NS1", {"e1": (-0.5, 0.6), "e2": (-1.0, 1.5)}, **FINE)
    assert labels(curve) == ["R3", "R4"]  # none made up where it ends
    assert_at(curve, "R4", [(1.0 - math.sqrt(0.5), SLOPE * (1.0 - math.sqrt(0.5)))])
    assert_at(curve, "R3", [(0.5, 0.5 * SLOPE)])
    assert largest(curve["e2"] - SLOPE * curve["e1"]) < WALKED
    (end,) = [p for p in curve.special_points if p.kind == "rejoined"]
    assert end.error is None  # a place on the way, whose parameters nothing tells the errors of
    assert np.hypot(end.parameters["e1"], end.parameters["e2"]) < 1e-3
    assert "become the one that they were born from" in end.note


def leslie():
    """Two ages with (x, y) -> (F (x + y) exp(-(x + y) / 10), s x): R2 where s = 1/2, F = e^4 / (1 + s)."""
    return map_as_machine(
        lambda x, p: (p.F * (x[0] + x[1]) * np.exp(-0.1 * (x[0] + x[1])), p.s * x[0]),
        "xy",
        {"F": 28.0, "s": 0.47},
    )


@pytest.mark.long
def test_both_curves_of_tori_begin_where_states_are_far_larger_than_their_scale() -> None:
    """The tori of doubled orbits are sixty times as large as a scale of one lets expect.

    Those of the single orbits are held by values, whose derivatives are known along solutions alone: damped
    steps did not get to them from beside the point.
    """
    system = leslie()
    x = 10.0 * math.log(28.0 * 1.47) / 1.47
    branch = branch_of(system, "F", (28.0, 31.0), [x, 0.47 * x])
    ranges = {"F": (28.0, 38.0), "s": (0.465, 0.505)}
    curve = cw.continue_locus(system, branch, "PD1", ranges, **FINE)
    assert_at(curve, "R2", [(math.exp(4.0) / 1.5, 0.5)])
    (point,) = [p for p in curve.special_points if p.label == "R2"]
    problem, _ = reopened(system, curve, point)
    (kind,) = [kind for kind in problem.point_types if kind.has(point)]
    settings = Settings(range=ranges["F"], second_range=ranges["s"])
    seeds = kind.seeds(problem, point)
    assert [seed.label for seed in seeds] == ["NS", "NS"]
    for seed in seeds:
        assert isinstance(begin(seed.problem, seed.z, settings, seed.tangent), ContinuationState)
    # A curve whose orbits have other segments where it begins than at the point has them as well.
    cut = branch_of(system, "F", (28.0, 31.0), [x, 0.47 * x], segments=2)
    elsewhere = cw.continue_locus(system, cut, "PD1", ranges, **FINE, max_points=2)
    other, _ = reopened(system, elsewhere, 0)
    assert other.size == problem.size + 2
    for seed, again in zip(seeds, kind.seeds(other, point), strict=True):
        assert again.problem.of_orbit(again.z) == pytest.approx(seed.problem.of_orbit(seed.z), rel=1e-6)
