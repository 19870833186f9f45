"""Multipliers that jump over the unit circle where a reset bends: told by the kind of their unstable side."""

import numpy as np
import pytest
from hybrid_runs import branch_of, machine

from contwalk.system import Transition


@pytest.mark.slow
def test_a_multiplier_that_jumps_past_minus_one_is_a_doubling_that_is_not_located() -> None:
    """x becomes mu + x / 2 for x < 0, else mu - 3 x / 2, at each tick: multipliers 1/2 and -3/2."""

    def still(t, x, p, dx):
        dx[0] = 0.0

    def tick(t, x, p, x_plus):
        x_plus[0] = p.mu + np.where(x[0] < 0.0, 0.5 * x[0], -1.5 * x[0])

    clock = Transition("tick", "on", "on", lambda t, x, p: np.sin(2.0 * np.pi * t), "rising", tick)
    system = machine(["x"], {"mu": -0.1}, {"on": still}, [clock], period=lambda p: 1.0)
    branch = branch_of(system, "mu", (-0.1, 0.1), [-0.2], until="settled", direction="up")
    assert branch.outcome.reason == "bound"
    (point,) = (p for p in branch.special_points if p.label != "EP")
    assert (point.label, point.status) == ("PD", "unlocated")
    assert abs(point.parameters["mu"]) < 1e-9  # as bracketed
    assert "0.5 and -1.5 beside it" in point.note
    assert (point.unstable_before, point.unstable_after) == (0, 1)
