"""A curve of grazings of a doubled orbit between two walls, which is found from points on both of its halves.

x'' + 0.1 x' + x = 8 cos w t between walls at +-1, restitution r: five impacts in two periods, ten in four.
"""

from __future__ import annotations

import pytest
from loci_of_orbits import studied
from two_walls import PLUGIN

pytestmark = pytest.mark.slow

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


@pytest.mark.long
def test_a_curve_whose_limit_is_on_the_other_half_is_known(tmp_path):
    """The dip that touches is on the eighth leg where one branch ends, on the third where the other does."""
    _, found, notes = studied(tmp_path, "walls", PLUGIN, RUN)
    ends = [p for b in found if b.info.subharmonic == 4 for p in b.special_points if p.label == "GR"]
    (curve,) = [b for b in found if b.info.problem == "locus"]
    assert len([n for n in notes if n.endswith(f"lies on branch {curve.name}, already known.")]) == 1
    assert len({round(p.parameters["w"], 6) for p in ends}) > 1
