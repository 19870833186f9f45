"""States that a clock samples and that stand still in between: maps as machines."""

import numpy as np
import pytest
from hybrid_runs import branch_of, machine

from contwalk.system import Transition


def sampled():
    """x becomes b x + 1/2 at each tick: the fixed point is 1 / (2 (1 - b))."""

    def still(t, x, p, dx):
        dx[0] = 0.0

    def tick(t, x, p, x_plus):
        x_plus[0] = p.b * x[0] + 0.5

    clock = Transition("tick", "on", "on", lambda t, x, p: np.sin(2.0 * np.pi * t), "rising", tick)
    return machine(["x"], {"b": 0.5}, {"on": still}, [clock], period=lambda p: 1.0)


@pytest.mark.slow
def test_a_fixed_point_of_a_map_runs_off_where_its_multiplier_is_one() -> None:
    branch = branch_of(sampled(), "b", (0.5, 2.0), [1.0], until="settled", direction="up", max_points=600)
    assert branch.outcome.reason == "unbounded"
    assert "b tends to 1 +-" in branch.outcome.message
    np.testing.assert_allclose(branch["x"] * (1.0 - branch["b"]), 0.5, rtol=1e-6)  # 1 - b cancels
