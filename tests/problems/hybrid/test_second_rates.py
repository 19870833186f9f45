"""Second derivatives of guards where they touch zero, against differences."""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_machines import orbit

from contwalk.problems.hybrid.limit_equations import second_rate
from contwalk.problems.hybrid.margins import Limit


@pytest.mark.parametrize("name", ["walker", "time-dependent guard and reset", "different numbers of states"])
@pytest.mark.parametrize("test", ["dip", "rate"])
def test_their_derivatives_are_exact(name: str, test: str) -> None:
    problem, z = orbit(name)
    limit = Limit("GR", "terminal", problem.itinerary.legs[0].name, 0, test)
    share = 0.4
    y = np.append(z, share * z[problem.layout.durations][0]) if test == "dip" else z
    value, rows = second_rate(problem, limit, y, share)
    for k, scale in enumerate(np.maximum(np.abs(y), 1e-2)):
        step = 1e-5 * scale
        beside = [second_rate(problem, limit, y + s * step * np.eye(len(y))[k], share)[0] for s in (1, -1)]
        difference = float((beside[0] - beside[1])[0]) / (2.0 * step)
        size = float(np.max(np.abs(rows * np.maximum(np.abs(y), 1e-2)))) / scale
        assert abs(difference - rows[0, k]) <= 1e-6 * max(size, abs(float(value[0])) / scale)
