"""Borders of 50 drawn pushes, with SciPy's integrator: a little less is survived, a little more is not."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from test_margins import prepared

from contwalk.storage.trajectory import read_margins

TIME, ASIDE = 15.0, 1e-6


def survives(state, tilt):
    """A ball in the right well of x'' = x - x^3 + tilt that has not passed x = 0 in that time."""

    def left(t, y):
        return y[0]

    left.terminal = True
    moved = solve_ivp(
        lambda t, y: (y[1], y[0] - y[0] ** 3 + tilt),
        (0.0, TIME),
        state,
        "DOP853",
        rtol=1e-9,
        atol=1e-12,
        events=left,
    )
    return moved.status == 0 and state[0] > 0.0


def test_fifty_borders_of_drawn_pushes(contwalk, folder):
    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=TIME)
    drawn = ("--set", "margins.random={count: 25, seed: 3}")
    assert contwalk("margins", "well.yaml", "--no-figures", *drawn).code == 0
    found = read_margins("well_margins.h5")
    assert len(found.rows) == 50
    rest, tilt = np.array(found.instants[0]["state"]), found.header["parameters"]["tilt"]
    for row in found.rows:
        push = row["sign"] * row["border"] * np.array(row["vector"])
        assert survives(rest + (1.0 - ASIDE) * push, tilt)
        assert not survives(rest + (1.0 + ASIDE) * push, tilt)
