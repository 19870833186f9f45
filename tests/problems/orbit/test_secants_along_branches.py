"""Secants along a branch of a test function that jumps: both of its signs come to be at one place."""

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.orbit import augmented

JUMP = 0.9877


def test_a_jump_of_the_test_function_ends_the_secants(monkeypatch):
    """A point was told as not found again, by "float division by zero"."""
    tangent = np.array([1.0, 0.0])

    def evaluated(problem, system, y):
        return np.array([1.0 if y[0] > JUMP else -1.0]), np.array([[1.0, 0.0]]), None

    problem = SimpleNamespace(linearize=lambda y: SimpleNamespace(tangent=lambda across, weights: tangent))
    monkeypatch.setattr(augmented, "newton_on", lambda problem, y, weights, across: y)
    monkeypatch.setattr(augmented, "_evaluated", evaluated)
    found = augmented._along_branch(problem, SimpleNamespace(scale=np.ones(2)), np.array([1.0, 0.0]), tangent)
    # Beside it, to the spacing of numbers.
    assert found[0] == pytest.approx(JUMP, abs=4e-16)
