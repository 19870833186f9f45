"""The piece of branch between two solutions: any point of it is computed, on this branch or not at all."""

from __future__ import annotations

import math

import numpy as np
import pytest
from made_up import MadeUp, circle, line

from contwalk.continuation.segment import LostBranch


def arc(begin: float, end: float, **rest):
    return circle(**rest).segment(*[(math.cos(t), math.sin(t)) for t in (begin, end)])


def test_its_points_solve_the_equations_across_the_chord():
    segment = arc(0.2, 0.5)
    for theta in (0.1, 0.37, 0.5, 0.99):
        z = segment.at(theta).z
        assert abs(z @ z - 1.0) <= 1e-15
        assert segment.position(z) == pytest.approx(theta, abs=1e-14)
    assert segment.at(0.0) is segment.a
    assert segment.at(1.0) is segment.b
    assert segment.at(0.37) is segment.at(0.37)  # nothing is computed twice


def test_the_interpolation_meets_ends_and_tangents_and_is_of_fourth_order():
    """Of an arc of length h the cubic Hermite interpolation misses by h^4 / 384; that the tangents are as
    long as the chord and not as the arc, h^2 / 24 too short, adds h / 8 h h^2 / 24 / 2 = h^4 / 384 or so."""
    missed = []
    for width in (0.4, 0.2):
        segment = arc(0.3, 0.3 + width)
        assert segment.guess(0.0) == pytest.approx(segment.a.z, abs=1e-15)
        assert segment.guess(1.0) == pytest.approx(segment.b.z, abs=1e-15)
        missed.append(max(abs(np.linalg.norm(segment.guess(t)) - 1.0) for t in np.linspace(0.05, 0.95, 19)))
        assert missed[-1] <= width**4 / 100.0
        h = 1e-6
        for t in (0.2, 0.7):
            # The interpolation is moved along the chord; across it the direction is its derivative.
            slope = (segment.guess(t + h) - segment.guess(t - h)) / (2.0 * h)
            way = segment.direction(t)
            across = slope[0] * way[1] - slope[1] * way[0]
            assert abs(across) <= 2e-2 * np.linalg.norm(slope) * np.linalg.norm(way)
    assert missed[0] / missed[1] > 12.0  # 16 in the limit


def test_tangents_point_along_the_chord():
    for begin, end in ((0.2, 0.5), (0.5, 0.2)):
        segment = arc(begin, end)
        assert segment.at(0.5).tangent @ segment.chord > 0.0


def test_distance_is_relative_to_the_length():
    segment = arc(0.0, 0.4)
    there = segment.at(0.5).z
    assert segment.distance(there, 0.5) == 0.0
    moved = there + np.array([0.03, 0.04])
    assert segment.distance(moved, 0.5) == pytest.approx(0.05 / segment.length, rel=1e-12)
    # A place where nothing is known yet is corrected, but not examined.
    assert segment.distance(segment.guess(0.25), 0.25) < 1e-3


def test_a_part_ends_where_it_is_told():
    segment = arc(0.0, 0.4)
    part = segment.between(0.0, 0.5)
    assert part.a is segment.a
    assert part.b is segment.at(0.5)
    assert part.length < segment.length


def test_a_point_that_cannot_be_computed_is_lost():
    def gap(z):
        return [math.nan if 0.1 < z[1] < 0.2 else z[0]]

    segment = MadeUp(gap, lambda z: [[1.0, 0.0]]).segment((0.0, 0.0), (0.0, 1.0))
    assert segment.at(0.5).z == pytest.approx([0.0, 0.5])
    with pytest.raises(LostBranch, match="no finite value: the made-up equations"):
        segment.at(0.15)


def test_counts_of_doubtful_eigenvalues_are_those_of_the_nearest_known_point():
    """Between 0.25 and 0.75 nothing is certain: what lies nearer to the unstable end counts as it does."""
    problem = line(lambda z: [z[1] - 0.5], error=0.2)
    segment = problem.segment((0.0, 0.0), (0.0, 1.0))
    assert (segment.a.unstable, segment.b.unstable) == (0, 1)
    assert segment.at(0.6).unstable == 1
    assert segment.at(0.4).unstable == 1  # nearest is 0.6 by now, and nothing here contradicts it
    assert segment.at(0.31).unstable in (0, 1)
    assert segment.at(0.1).unstable == 0  # certain by itself


def test_another_discretisation_is_corrected_to():
    segment = arc(0.0, 0.4)
    larger = MadeUp(lambda z: [z @ z - 1.0201], lambda z: [[2.0 * z[0], 2.0 * z[1]]])
    sample = segment.on(larger, 0.5)
    assert np.linalg.norm(sample.z) == pytest.approx(1.01, abs=1e-15)
    assert segment.position(sample.z) == pytest.approx(0.5, abs=1e-13)
