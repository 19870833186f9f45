"""Directions at a crossing of branches of orbits, of made-up equations."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.orbit import branching

Z = np.array([0.3, -0.2, 1.0])


def made_up(jacobian):
    """Equations with this Jacobian and magnitudes of one."""
    return SimpleNamespace(
        linearize=lambda z: SimpleNamespace(jacobian=np.array(jacobian)),
        magnitudes_near=lambda z: np.full(len(z), np.nan),
        equation_scales=np.ones(len(jacobian)),
    )


def test_there_is_a_second_direction_where_the_equations_lose_a_rank():
    """x = 0 twice: y and the parameter are free. Of x = 0 and y = 0 only the parameter is."""
    second = branching.second_direction(made_up([[1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]), Z)
    assert second is not None
    assert second[0] == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(second) == pytest.approx(1.0)
    assert branching.second_direction(made_up([[1.0, 0.0, 0.0], [0.0, 1e-6, 0.0]]), Z) is None


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_branch_that_crosses_leaves_towards_larger_parameters(monkeypatch, way):
    """Whichever way its tangent has been found to face, and whatever its states do."""
    along, across = np.array([1.0, 0.0, 0.0]), way * np.array([-0.6, -0.6, 0.5])
    monkeypatch.setattr(branching, "directions", lambda *given: [along, across])
    point = SimpleNamespace(tangent=along.tolist())
    (seed,) = branching.crossing(made_up([[0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]), Z, point)
    np.testing.assert_array_equal(seed.tangent, way * across)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_at_a_fixed_parameter_it_leaves_towards_what_changes_most(monkeypatch, way):
    along, across = np.array([0.0, 0.0, 1.0]), way * np.array([-0.3, 0.9, 0.0])
    monkeypatch.setattr(branching, "directions", lambda *given: [along, across])
    point = SimpleNamespace(tangent=along.tolist())
    (seed,) = branching.crossing(made_up([[0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]), Z, point)
    np.testing.assert_array_equal(seed.tangent, way * across)
