"""Motions that are on their way still when they count as having survived come to one solution, not many."""

from __future__ import annotations

import pytest

from contwalk.storage.trajectory import read_margins

PLUGIN = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 + p.tilt
    dx[1] = -p.slow * x[1]


SYSTEM = System(
    name="wells",
    states=(State("x"), State("y")),
    parameters=(Parameter("tilt", 0.0), Parameter("slow", 0.4)),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./wells.py
start: {state: {x: 1.0, y: 0.0}}
continue: {parameter: tilt, range: [0.0, 0.1]}
diagram: none
output: wells.h5
margins:
  of: {from: wells.h5, point: b1/0}
  survive: {time: 5}
  basin: {states: {x: [-1.5, 1.5], y: [-5, 5]}, cells: 4, levels: 0}
"""


@pytest.fixture
def basin(contwalk, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wells.py").write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "wells.yaml").write_text(RUN, encoding="utf-8")
    assert contwalk("continue", "wells.yaml").code == 0
    assert contwalk("margins", "wells.yaml").code == 0
    return read_margins("wells_margins.h5").basin


def test_each_well_has_one_name(basin):
    """y has fallen to 0.14 of itself when motions count, to 0.0025 where what is new is looked at."""
    assert len(basin["labels"]) == 25
    for (x, _), label in zip(basin["places"], basin["labels"], strict=True):
        assert label == ("b1/0" if x > 0.0 else "new1" if x < 0.0 else label)
