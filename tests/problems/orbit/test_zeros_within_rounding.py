"""A point's test function that jumps through zero along a branch: the search between its signs ends there."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.problems.orbit import augmented


class Line:
    """A branch that is a straight line, whose last unknown is the place on it."""

    def linearize(self, y):
        return self

    def tangent(self, across, weights):
        return across


class Scaled:
    scale = np.ones(2)


@pytest.mark.parametrize("jump", [1e-3, -0.03, 0.0])
def test_a_jump_is_found_to_rounding_and_ends_the_search(jump, monkeypatch) -> None:
    def evaluated(problem, system, y):
        steep = 1e16 * (1.0 if y[-1] > jump else -1.0)
        return np.array([0.0, steep]), np.array([[1.0, 0.0], [0.0, 2.0 * steep]]), None

    monkeypatch.setattr(augmented, "newton_on", lambda problem, start, weights, across: start)
    monkeypatch.setattr(augmented, "_evaluated", evaluated)
    found = augmented._along_branch(Line(), Scaled(), np.array([0.0, 0.017]), np.array([0.0, 1.0]))
    assert found[-1] == pytest.approx(jump, abs=1e-15)  # places are told by sums of moves, rounded each
