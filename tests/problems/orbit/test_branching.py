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
        line=SimpleNamespace(usual=lambda system: 1.0),
        system=None,
    )


def test_there_is_a_second_direction_where_the_equations_lose_a_rank():
    """x = y = x + y = 0: z and the parameter are free. Of x = y = 1e-6 z = 0 only the parameter is."""
    lost = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]]
    second = branching.second_direction(made_up(lost), np.zeros(4))
    assert second is not None
    assert second[:2] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert np.linalg.norm(second) == pytest.approx(1.0)
    whole = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1e-6, 0.0]]
    assert branching.second_direction(made_up(whole), np.zeros(4)) is None


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_branch_that_crosses_leaves_towards_larger_parameters(monkeypatch, way):
    """Whichever way its tangent has been found to face, and whatever its states do."""
    along, across = np.array([1.0, 0.0, 0.0]), way * np.array([-0.6, -0.6, 0.5])
    monkeypatch.setattr(branching, "directions", lambda *given: [along, across])
    point = SimpleNamespace(tangent=along.tolist(), coefficients={})
    (seed,) = branching.crossing(made_up([[0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]), Z, point)
    np.testing.assert_array_equal(seed.tangent, way * across)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_at_a_fixed_parameter_it_leaves_towards_what_changes_most(monkeypatch, way):
    along, across = np.array([0.0, 0.0, 1.0]), way * np.array([-0.3, 0.9, 0.0])
    monkeypatch.setattr(branching, "directions", lambda *given: [along, across])
    point = SimpleNamespace(tangent=along.tolist(), coefficients={})
    (seed,) = branching.crossing(made_up([[0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]), Z, point)
    np.testing.assert_array_equal(seed.tangent, way * across)
