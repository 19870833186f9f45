"""How far beside a special point the other curve that passes it is begun."""

from __future__ import annotations

import numpy as np
import pytest
from made_up import MadeUp

from contwalk.problems.locus.orbit_points.switching import _length_beside


@pytest.mark.parametrize(("curvature", "length"), [(1.0, 1e-2), (200.0, 1e-3), (2000.0, 1e-4)])
def test_a_curve_that_turns_within_the_first_length_is_begun_nearer(curvature, length) -> None:
    """x = c lam^2, from the origin along lam: at a length h the tangent misses it by c h^2.

    Doublings of a four times doubled orbit, whose tori's resonances lie within 1e-3 of each other, were told
    as `failed`.
    """
    curve = MadeUp(lambda z: [z[0] - curvature * z[1] ** 2], lambda z: [[1.0, -2.0 * curvature * z[1]]])
    aside = _length_beside(curve, np.zeros(2), np.array([0.0, 1.0]), np.ones(2))
    assert aside.tolist() == [0.0, length]
