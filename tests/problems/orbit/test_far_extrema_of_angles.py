"""Along a curve of tori, extrema of the angle far from half a turn are no R2 points, and not looked for."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.locus.orbit_points.resonances import R2OnTori

MESH = SimpleNamespace(amplified=1.0, tolerance=1e-6)


def told(cosine: float, rate: float) -> float:
    """The test function where a curve of two unknowns has this cosine, which changes so fast along it."""
    problem = SimpleNamespace(plane=SimpleNamespace(size=0), mesh=MESH, further=lambda z: z)
    sample = SimpleNamespace(z=np.array([cosine]), tangent=np.array([rate]))
    return R2OnTori().value(problem, sample)


@pytest.mark.parametrize("cosine", [-0.6, 0.0, 0.8])
def test_an_extremum_far_away_is_no_change_of_sign(cosine: float) -> None:
    """Beside it the place at which the cosine would be minus one is farther away than any step goes."""
    assert np.isnan(told(cosine, 1e-3))
    assert np.isnan(told(cosine, -1e-3))


def test_both_sides_of_half_a_turn_and_of_a_touch_have_other_signs() -> None:
    """Passing, the distance changes its sign; where the angle comes there and goes back, its rate does."""
    assert told(-0.999, -0.5) * told(-1.001, -0.5) < 0.0
    assert told(-0.999, -0.05) * told(-0.999, 0.05) < 0.0
