"""How many steps a leg of a neighbouring orbit may take, by those of an orbit that is known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.orbit.meshing import LEAST_MOST, MOST_STEPS, most_steps


def mesh(steps, tolerance):
    return SimpleNamespace(steps=[np.zeros(3), np.zeros(steps)], tolerance=tolerance)


def test_it_grows_with_the_longest_leg_and_with_the_accuracy_by_the_order_of_the_method():
    """Errors of the eighth order: an accuracy of 1e-8 of the one before needs ten times as many steps."""
    few, count = most_steps(mesh(100, 1e-4), 1e-4), most_steps(mesh(200, 1e-4), 1e-4)
    assert LEAST_MOST < few < MOST_STEPS
    assert count == pytest.approx(2.0 * few, abs=2.0)
    assert most_steps(mesh(100, 1e-4), 1e-12) == pytest.approx(10.0 * few, abs=10.0)
    assert most_steps(mesh(100, 1e-4), 1e-2) == few


def test_it_is_neither_too_few_nor_without_end():
    assert most_steps(mesh(3, 1e-4), 1e-4) == LEAST_MOST
    assert most_steps(mesh(10**9, 1e-4), 1e-4) == most_steps(None, 1e-4) == MOST_STEPS
