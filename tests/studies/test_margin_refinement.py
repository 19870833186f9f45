"""Planes of labels that are refined at their borders, of made-up labels."""

from __future__ import annotations

import math

from contwalk.studies.margins.refinement import refined


def disc(vertices):
    return ["in" if math.hypot(i - 33.3, j - 30.1) < 17.7 else "out" for i, j in vertices]


def stripes(vertices):
    """So narrow that first vertices see the same beside each other; they end at the top."""
    return ["odd" if j < 61 and i % 14 > 5 else "even" for i, j in vertices]


def test_all_squares_with_different_corners_are_of_the_smallest_size():
    labels, cells = refined(disc, 8, 3)
    mixed = [cell for cell in cells if len({labels[v] for v in cell.corners}) > 1]
    assert {cell.size for cell in mixed} == {1}
    assert sum(cell.size**2 for cell in cells) == 64**2
    assert len(labels) < 65**2 / 3
    inner = sum(cell.size**2 for cell in cells if all(labels[v] == "in" for v in cell.corners))
    assert abs(inner + 0.5 * len(mixed) - math.pi * 17.7**2) < len(mixed) / 4


def test_no_square_stays_whole_that_a_neighbour_shows_a_border_on():
    labels, cells = refined(stripes, 4, 4)
    for cell in cells:
        assert cell.size == 1 or len({labels[v] for v in cell.sides() if v in labels}) == 1


def test_each_vertex_is_asked_for_once_in_the_same_order():
    asked = []

    def label(vertices):
        asked.extend(vertices)
        return disc(vertices)

    labels, _ = refined(label, 8, 2)
    assert asked == list(labels)
    assert len(asked) == len(set(asked))
