"""A slender block that rocks on a shaking table (Hogan 1989): x'' = x -+ 1 - beta cos w t, x' -> r x' at 0.

Nobody has declared the symmetry. On one edge alone the block sways as -+1 + beta / (1 + w^2) cos w t, which
touches the table at beta = 1 + w^2.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import System, Transition

W, R = 4.0, 0.8
# Where the orbit that is its own image half a period later loses that: both legs in closed form, and the
# multiplier -1 of their map, in 30 digits.
PITCHFORK = 8.71748866210611
TOUCHES = 1.0 + W * W


def block() -> System:
    def edge(side):
        def field(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = x[0] - side - p.beta * math.cos(W * t)

        return field

    def angle(t, x, p):
        return x[0]

    def strikes(t, x, p, after):
        after[0] = x[0]
        after[1] = R * x[1]

    return machine(
        ["x", "v"],
        {"beta": 12.0},
        {"right": edge(1.0), "left": edge(-1.0)},
        [
            Transition("from_right", "right", "left", angle, reset=strikes),
            Transition("from_left", "left", "right", angle, direction="rising", reset=strikes),
        ],
        period=lambda p: 2.0 * math.pi / W,
    )


@pytest.fixture(scope="module")
def found() -> list[Branch]:
    return diagram(
        block(), "beta", (8.0, 18.0), [0.3, 0.1], {"beta": 12.0}, until="settled", events={"GR": "switch"},
        depth=1,
    )  # fmt: skip


@pytest.mark.long
def test_the_asymmetric_orbits_come_from_the_symmetric_one(found) -> None:
    (pitchfork,) = [p for p in found[0].special_points if p.label == "BP"]
    assert (pitchfork.kind, pitchfork.criticality) == ("pitchfork", "supercritical")
    assert_met(pitchfork, "beta", PITCHFORK)


def test_both_ends_lead_to_the_block_on_one_edge(found) -> None:
    """Each end's orbit rests in one mode for no time, and its only contact may be at the instant at which the
    force's period begins, but for rounding."""
    ends = [p for p in found[0].special_points if p.label == "GR"]
    assert len(ends) == 2
    for point in ends:
        assert_met(point, "beta", TOUCHES)
    quiet = [branch for branch in found[1:] if not branch.info.signature]
    assert len(quiet) == 2
    sides = []
    for branch in quiet:
        rows = branch.points[~branch["special"]]
        # The larger multiplier of a saddle; rows are known to the tolerance of the walk.
        np.testing.assert_allclose(np.abs(rows["spectrum"][0][0]), math.exp(2.0 * math.pi / W), rtol=1e-6)
        sides.append(float(np.sign(rows["unknowns"][-1][0])))
    assert sorted(sides) == [-1.0, 1.0]
