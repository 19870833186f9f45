"""A state off another one, where a symmetry is tried."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.problems.hybrid.mirrors import beside


@pytest.mark.parametrize("states", [1, 2, 3, 7])
def test_it_is_off_in_all_directions_by_unlike_parts_of_their_scales(states):
    x, scale = np.arange(1.0, states + 1.0), 10.0 ** np.arange(states)
    parts = (beside(x, scale) - x) / scale
    assert parts.shape == (states,)
    assert np.all(np.abs(parts) > 1e-4)
    assert len(set(np.round(parts, 12))) == states
