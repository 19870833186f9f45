"""Curves that are born at a special point right at the end of a range begin, and stay, inside it."""

from __future__ import annotations

import pytest
from loci_of_orbits import studied

# x' = y, y' = b1 + b2 x + x^2 - x y: the Bogdanov-Takens point is at the origin of the parameters.
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def flow(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.b1 + p.b2 * x[0] + x[0] ** 2 - x[0] * x[1]

SYSTEM = System(
    "takens",
    states=(State("x", scale=1.0), State("y", scale=1.0)),
    parameters=(Parameter("b1", 0.04), Parameter("b2", -0.5)),
    modes=(Mode("flow", flow),),
)
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("b2", "low", "high"), [(-0.5, -1.0, 0.0), (0.5, 0.0, 1.0)])
def test_the_curve_of_hopf_points_begins_on_the_side_that_is_asked_for(tmp_path, b2, low, high) -> None:
    run = f"""
system: ./takens.py
start: {{state: {{x: {-0.4 * b2 / 0.5}, y: 0.0}}}}
parameters: {{b2: {b2}}}
continue: {{parameter: b1, range: [-0.5, 0.5]}}
loci: {{with: b2, range: [{low}, {high}], of: [LP], follow: [BT]}}
output: takens.h5
"""
    _, branches, _ = studied(tmp_path, "takens", PLUGIN, run)
    curves = {b.info.settings["of"]: b for b in branches if b.info.problem == "locus"}
    assert sorted(curves) == ["HB", "LP"]
    for curve in curves.values():
        assert low <= curve["b2"].min() <= curve["b2"].max() <= high
        assert all(low <= p.parameters["b2"] <= high for p in curve.special_points if p.label == "EP")
        # Both come to the point; that it lies on their end and not beyond it, the folds tell exactly.
        # Along the Hopf points its test function is 1e-19 there, and rounding decides on the sign.
        assert min(abs(curve["b2"])) == 0.0
    assert "BT" in {p.label for p in curves["LP"].special_points}
