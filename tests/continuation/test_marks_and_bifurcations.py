"""Marks and bifurcations of one step: a mark at a bifurcation's place is put there, elsewhere it stays."""

from __future__ import annotations

import pytest
from made_up import KINDS, LINE, at, line

from contwalk.continuation import special_points
from contwalk.continuation.locating import Found
from contwalk.continuation.marks import Observer
from contwalk.continuation.settings import Settings


def found(theta, label):
    return Found(theta, KINDS[label], at(0.0, theta), None)


@pytest.mark.parametrize(("apart", "moved"), [(1e-11, True), (-1e-11, True), (1e-6, False)])
def test_a_mark_at_a_bifurcation_is_at_its_place(monkeypatch, apart, moved):
    """The parameter turns at folds and branch points, so marks are looked for between them."""
    turns = []

    def marked(segment, sought, observer, places):
        turns.extend(places)
        return [found(0.6 + apart, "UZ"), found(0.9, "UZ")]

    monkeypatch.setattr(special_points, "bifurcations", lambda segment: [found(0.3, "HB"), found(0.6, "LP")])
    monkeypatch.setattr(special_points, "marked", marked)
    segment = line(lambda z: [-1.0]).segment((0.0, 0.0), (0.0, 1.0))
    told = special_points.everything(segment, Settings(range=(-1.0, 1.0)), Observer(LINE, ()), born=False)
    assert turns == [0.6]
    assert [f.label for f in told] == ["HB", "LP", "UZ", "UZ"]
    assert [f.theta for f in told] == [0.3, 0.6, 0.6 if moved else 0.6 + apart, 0.9]
