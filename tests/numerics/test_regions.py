"""Regions between curves on a raster."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.numerics.regions import Raster, regions

UNIT = Raster(np.array([0.0, 0.0]), np.array([1.0, 1.0]))


def circle(x: float, y: float, radius: float) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi, 100)
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def label_at(found, raster, x: float, y: float) -> int:
    column, row = ((np.array([x, y]) - raster.low) / (raster.high - raster.low) * raster.cells).astype(int)
    return int(found.labels[row, column])


def test_no_line_leaves_one_region() -> None:
    found = regions(UNIT, [])
    assert len(found.inside) == 1
    assert np.all(found.labels == 0)
    x, y = UNIT.center(*found.inside[0])
    assert min(x, 1.0 - x, y, 1.0 - y) > 0.35  # in the middle, where cells are no squares


def test_a_cross_and_a_circle() -> None:
    lines = [np.array([[0.5, 0.0], [0.5, 1.0]]), np.array([[0.0, 0.5], [1.0, 0.5]]), circle(0.25, 0.25, 0.1)]
    found = regions(UNIT, lines)
    assert len(found.inside) == 5
    places = [(0.25, 0.25), (0.05, 0.05), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    assert len({label_at(found, UNIT, *place) for place in places}) == 5
    assert label_at(found, UNIT, 0.05, 0.05) == label_at(found, UNIT, 0.45, 0.45)  # round the circle
    for number, cell in enumerate(found.inside):
        assert label_at(found, UNIT, *UNIT.center(*cell)) == number
    assert np.all(found.labels >= 0)  # cells of lines belong to what is beside them


@pytest.mark.parametrize("slope", [0.013, 0.4, 1.0, 17.0])
def test_a_slanted_line_divides(slope) -> None:
    found = regions(UNIT, [np.array([[0.5 - 1.0 / slope, -0.5], [0.5 + 1.0 / slope, 1.5]])])
    assert len(found.inside) == 2


def test_a_line_that_ends_inside_divides_nothing() -> None:
    assert len(regions(UNIT, [np.array([[0.2, 0.2], [0.8, 0.8]])]).inside) == 1


def test_a_region_of_a_few_cells_is_left_out_and_counted() -> None:
    found = regions(UNIT, [circle(0.5, 0.5, 0.004)])
    assert (len(found.inside), found.too_small) == (1, 1)


def test_parameters_of_other_magnitudes() -> None:
    raster = Raster(np.array([-1e-8, 1e8]), np.array([1e-8, 3e8]))
    found = regions(raster, [np.array([[-1e-8, 2e8], [1e-8, 2e8]])])
    assert len(found.inside) == 2
    assert sorted(raster.center(*cell)[1] > 2e8 for cell in found.inside) == [False, True]
