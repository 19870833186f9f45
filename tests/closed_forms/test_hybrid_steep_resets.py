"""Maps with a root, as of a grazing, written as the reset of a clock: their slope has no bound at x = 0."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import diagram, machine

from contwalk.system import System, Transition


def held(reset) -> System:
    def hold(t, x, p, dx):
        dx[0] = 0.0

    def tick(t, x, p):
        return np.sin(2.0 * math.pi * t)

    return machine(
        ["x"],
        {"r": -0.2},
        {"hold": hold},
        [Transition("tick", "hold", "hold", tick, "rising", reset=reset)],
        period=lambda p: 1.0,
    )


def root_above(t, x, p, after):
    after[0] = p.r + 0.4 * x[0] if x[0] <= 0.0 else p.r - np.sqrt(x[0])


def root_of_size(t, x, p, after):
    after[0] = p.r - 0.5 * np.sqrt(np.abs(x[0]))


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("reset", "start", "r"), [(root_above, -0.3, -0.2), (root_above, 0.6, 1.4), (root_of_size, 0.5, 1.0)]
)
def test_a_branch_ends_where_the_slope_of_a_reset_has_no_bound(reset, start, r) -> None:
    (branch,) = diagram(
        held(reset), "r", (-0.3, 1.5), [start], {"r": r}, mode="hold", until="settled", depth=1
    )
    assert branch.outcome.reason == "plugin_error"
    assert "slopes of the reset of transition 'tick' grow beyond all bounds" in branch.outcome.message
    assert "test_hybrid_steep_resets.py" in branch.outcome.message
    assert float(np.min(np.abs(branch["r"]))) < 1e-3
    assert len(branch["r"]) < 200
