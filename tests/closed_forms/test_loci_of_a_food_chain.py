"""Curves of a food chain beside a point at which its top predator can begin to live on a cycle.

Rosenzweig and MacArthur's chain with the numbers of Kuznetsov and Rinaldi, Math. Biosci. 134 (1996) 1.
Without the top predator prey is x = d1 / (a1 - b1 d1) = 2/19 and oscillates beyond K = 2 x + 1/b1 = 31/57;
the top predator lives from y = d2 / (a2 - b2 d2) = 1/8 on, which y is there at r = 0.589: both curves of Hopf
points cross there.
"""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied

pytestmark = pytest.mark.slow

PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    first = 5.0 * x[0] * x[1] / (1.0 + 3.0 * x[0])
    second = 0.1 * x[1] * x[2] / (1.0 + 2.0 * x[1])
    dx[0] = p.r * x[0] * (1.0 - x[0] / p.K) - first
    dx[1] = first - second - 0.4 * x[1]
    dx[2] = second - 0.01 * x[2]

SYSTEM = System(
    "chain",
    states=(State("x", "", 1.0, "prey"), State("y", "", 1.0, "predator"), State("z", "", 10.0, "top")),
    parameters=(
        Parameter("K", 0.5, "", (0.01, 10.0), "capacity"),
        Parameter("r", 1.0, "", (0.01, 10.0), "growth"),
    ),
    modes=(Mode("field", field),),
)
"""
RUN = """
contwalk: 1
system: ./chain.py
accuracy: 1e-8
start: {state: {x: 0.35, y: 0.125, z: 9.0}}
continue: {parameter: K, range: [0.05, 2.0], direction: both, max_points: 300}
diagram: {follow: none}
loci: {with: r, range: [0.1, 3.0], of: [HB], follow: all}
figures: []
"""
CAPACITY, GROWTH = 31.0 / 57.0, 0.589


@pytest.fixture(scope="module")
def curves(tmp_path_factory):
    """The curves of the study."""
    _, found, notes = studied(tmp_path_factory.mktemp("chain"), "chain", PLUGIN, RUN)
    return [b for b in found if b.info.problem == "locus"], notes


def test_the_curves_of_hopf_points_cross_where_they_do(curves):
    """What rounding leaves of the top predator's equation, 4e-33, hid the crossing curve: it was `known`."""
    of = [b for b in curves[0] if b.info.settings["of"] == "HB"]
    assert len(of) == 2
    told = [p for b in of for p in b.special_points if p.label == "ZH"]
    assert told
    for point in told:
        assert abs(point.parameters["K"] - CAPACITY) <= point.errors["K"] + 1e-15
        assert abs(point.parameters["r"] - GROWTH) <= point.errors["r"] + 1e-15
    np.testing.assert_allclose(of[1].points["free"][:, 0], CAPACITY, rtol=1e-12)


def test_folds_from_one_bautin_point_lead_to_the_other_and_are_followed_once(curves):
    """Beside the second one, which is 6e-4 from the crossing, cycles of 1e-4 fold."""
    branches, notes = curves
    (hopf,) = [b for b in branches if len([p for p in b.special_points if p.label == "GH"])]
    begin, end = [p for p in hopf.special_points if p.label == "GH"]
    (folds,) = [b for b in branches if b.info.settings["of"] == "LP"]
    assert folds.outcome.reason == "shrunk"
    for point, row in ((begin, folds.points[0]), (end, folds.points[-1])):
        assert abs(row["free"][0] - point.parameters["K"]) < 1e-3
    # It counts as shrunk from cycles of 1e-3 in the metric on, and these lie off the point by their square.
    assert abs(folds.points[-1]["free"][0] - end.parameters["K"]) < 1e-6
    assert f"{hopf.name}/{end.name} lies on branch {folds.name}, already known." in notes


def test_the_end_is_told_by_both_parameters(curves):
    """It was told as near a place of the line between two orbits: `path = 1.04`."""
    (folds,) = [b for b in curves[0] if b.info.settings["of"] == "LP"]
    assert "K = 0.5432768" in folds.outcome.message
    assert "r = 0.5893097" in folds.outcome.message
