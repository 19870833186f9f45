"""Borders on a ray, of made-up survival."""

from __future__ import annotations

import pytest

from contwalk.studies.margins.borders import borders_on


def test_a_border_is_known_to_the_accuracy_wherever_it_lies():
    for border in (1e-9, 3e-4, 0.05, 0.7, 900.0):
        found = borders_on(lambda size, b=border: size < b, 0.05, 1e3, 1e-6, 0)
        assert found.borders == pytest.approx([border], rel=1e-6)
        assert not found.several


def test_nothing_lost_as_far_as_was_looked_is_no_border():
    found = borders_on(lambda size: True, 0.05, 7.0, 1e-2, 4)
    assert found.borders == ()
    assert found.farthest == 7.0


def test_nothing_kept_is_a_border_at_nothing():
    found = borders_on(lambda size: size == 0.0, 0.05, 7.0, 1e-2, 0)
    assert found.borders[0] < 1e-12


def test_a_scan_finds_an_island_below_the_first_border_and_one_beyond_it():
    def survives(size: float) -> bool:
        return size < 1.0 or 1.4 < size < 2.5

    beyond = borders_on(survives, 0.05, 100.0, 1e-6, 8)  # of the sizes that are doubled, 1.6 is on the island
    assert beyond.borders == pytest.approx([1.0, 1.4, 2.5], rel=1e-6)
    # None of 0.65, 1.3 is, but the scan reaches to twice the border.
    beside = borders_on(survives, 0.65, 100.0, 1e-6, 8)
    assert beside.borders == pytest.approx([1.0, 1.4], rel=1e-6)

    def holed(size: float) -> bool:
        return size < 1.0 and not 0.55 < size < 0.65

    within = borders_on(holed, 0.05, 100.0, 1e-6, 9)
    assert within.borders == pytest.approx([0.55, 0.65, 1.0], rel=1e-6)
    assert within.several
    assert borders_on(holed, 0.05, 100.0, 1e-6, 0).borders == pytest.approx([1.0], rel=1e-6)


def test_each_size_is_tried_once():
    tried = []

    def survives(size: float) -> bool:
        tried.append(size)
        return size < 0.3

    found = borders_on(survives, 0.05, 100.0, 1e-4, 5)
    assert len(tried) == len(set(tried)) == found.simulations
