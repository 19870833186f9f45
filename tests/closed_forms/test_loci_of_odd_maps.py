"""Curves of maps: where both multipliers of odd ones are one, branch points persist and no folds begin."""

from __future__ import annotations

import pytest
from loci_of_orbits import assert_at, labels, map_plugin, studied

pytestmark = pytest.mark.slow

CUBIC = ("x[1]", "-p.be * x[0] + p.d * x[1] - x[1] ** 3")
BENT = ("x[1]", "p.al - p.be * x[0] - x[1] ** 2 - 0.1 * x[0] * x[1] + 0.05 * x[1] ** 3")
RUN = """
system: ./{name}.py
accuracy: 1e-10
start: {{simulate: {{state: {{x: {x}, y: {x}}}, until: 0}}}}
continue: {{parameter: {free}, range: {range}}}
loci: {{with: be, range: [-1.5, 1.5], of: all, follow: all}}
diagram: none
engine: {{max_share: 0.03125}}
output: {name}.h5
"""


@pytest.mark.long
def test_branch_points_and_not_folds_begin_where_both_multipliers_are_one(tmp_path) -> None:
    """Multipliers of zero solve m^2 - d m + be = 0: branch points where be = d - 1, tori where be = 1."""
    text = RUN.format(name="cubic", x=0.0, free="d", range=[-3, 3])
    _, branches, _ = studied(tmp_path, "cubic", map_plugin("cubic", CUBIC, {"d": 0.5, "be": 0.2}), text)
    curves = [b for b in branches if b.info.problem == "locus"]
    assert {b.info.settings["of"] for b in curves} == {"PD", "NS", "BP"}
    tori = next(b for b in curves if b.info.settings["of"] == "NS")
    assert labels(tori) == ["BP", "R1", "R2", "R3", "R4"]
    crossings = next(b for b in curves if b.info.settings["of"] == "BP")
    assert (
        abs(crossings["be"] - crossings["d"] + 1.0).max() < 1e-8
    )  # rows are known to a hundred times the accuracy
    # On both curves that pass there, and the doublings be = -1 - d where they cross.
    assert labels(crossings) == ["LPPD", "R1"]
    assert_at(crossings, "R1", [(2.0, 1.0)])
    assert_at(tori, "R1", [(2.0, 1.0)])


@pytest.mark.long
def test_what_begins_at_a_resonance_is_looked_for_with_conditions_made_there(tmp_path) -> None:
    """A curve of doublings that began far away leads to one whose borders do not fit."""
    text = RUN.format(name="bent", x=0.2948, free="al", range=[-1.5, 3.5])
    _, branches, _ = studied(tmp_path, "bent", map_plugin("bent", BENT, {"al": 0.5, "be": 0.3}), text)
    assert not [b for b in branches if b.outcome.status == "failed"]
    assert any("R2" in labels(b) for b in branches if b.info.settings.get("of") == "PD")
