"""A curve of grazings along which an impact of the orbit loses its velocity, and becomes the touch itself.

x'' + 0.1 x' + x = 8 cos w t between walls at +-1, restitution r. Five impacts in two periods, and a touch;
where one of the impacts has no velocity the orbit is that of two impacts and a touch in one period, gone
round twice. The equations of the five impacts hold all along the curve of those as well: both cross there.
"""

from __future__ import annotations

import pytest
from loci_of_orbits import studied
from two_walls import PLUGIN

pytestmark = pytest.mark.slow

FIVE = """
contwalk: 1
system: ./walls.py
accuracy: 1e-8
start: {simulate: {state: {x: 0.0, v: 0.0}, until: settled}}
parameters: {w: 2.5, r: 0.7}
continue: {parameter: w, range: [2.4, 2.7], direction: up, max_points: 300}
loci: {with: r, range: [0.3, 0.75], of: [GR], follow: none}
events: {GR: ignore}
figures: []
"""
TWO = """
contwalk: 1
system: ./walls.py
accuracy: 1e-8
start: {simulate: {state: {x: 0.0, v: 0.0}, until: settled}}
parameters: {w: 2.75, r: 0.373}
continue: {parameter: w, range: [2.65, 2.8], direction: down, max_points: 300}
loci: {with: r, range: [0.365, 0.38], of: [GR], follow: none}
figures: []
"""


def test_it_ends_where_both_curves_cross_and_the_other_one_tells_the_same_point(tmp_path):
    """The curve went on along the orbits of two impacts, with points that are none, to r = 0.3."""
    places = [tmp_path / name for name in ("five", "two")]
    for place in places:
        place.mkdir()
    _, five, _ = studied(places[0], "walls", PLUGIN, FIVE)
    curve = five[-1]
    assert (curve.outcome.status, curve.outcome.reason) == ("stopped", "grazing")
    assert "ignore" not in curve.outcome.message  # as the run file has it
    assert all(point.status == "located" for point in curve.special_points)
    (ending,) = [p for p in curve.special_points if p.label == "GRGR"]
    assert ending.kind == "resonant"
    assert "BP were not looked for" in ending.note

    _, two, _ = studied(places[1], "walls", PLUGIN, TWO)
    doublings = [p for p in two[-1].special_points if p.label == "GRPD"]
    (there,) = [p for p in doublings if p.kind == "resonant"]
    for name in ("w", "r"):
        apart = abs(ending.parameters[name] - there.parameters[name])
        assert apart <= ending.errors[name] + there.errors[name] < 1e-8
