"""The planar walker's basin: what the run file colours, on a coarse lattice, against motions by SciPy."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from contwalk_systems.planar_walker import SYSTEM
from hybrid_motion import SIGNS, after, parameters, vector
from scipy.integrate import solve_ivp

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins

FILE = Path(__file__).resolve().parents[2] / "runs/planar_walker_basin.yaml"
STRIDES = 3


def guard_of(transition, begin, p):
    """As SciPy asks for it: the knee is straight when it is let go, and counts again when it has bent."""

    def value(time, y):
        return 1.0 if time == begin and transition.name == "knee_strike" else transition.guard(time, y, p)

    return value


def stands(x, p, duration):
    """Whether a walker that sets out right after a heel strike has not fallen after so many seconds."""
    mode, t = "three_link", 0.0
    while t < duration:
        field, leaving = SYSTEM.mode(mode).field, [s for s in SYSTEM.leaving(mode) if s.role != "watched"]
        events = [lambda time, y: SYSTEM.fallen(time, y, p)]
        events += [guard_of(s, t, p) for s in leaving]
        for event, direction in zip(events, [1.0, *(SIGNS[s.direction] for s in leaving)], strict=True):
            event.terminal, event.direction = True, direction
        solved = solve_ivp(
            lambda time, y, f=field: vector(f, time, y, p),
            (t, duration),
            x,
            method="DOP853",
            rtol=1e-8,
            atol=1e-10,
            events=events,
            max_step=0.1,
        )
        t, x = float(solved.t[-1]), solved.y[:, -1]
        if solved.status == 0:
            return True
        if len(solved.t_events[0]):
            return False
        which = next(s for s, times in zip(leaving, solved.t_events[1:], strict=True) if len(times))
        x, mode = after(SYSTEM, which, t, x, p), which.target
    return True


def test_the_coarse_plane_by_scipy(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("planar_walker_basin.yaml").write_text(FILE.read_text(encoding="utf-8"), encoding="utf-8")
    assert run(("continue", "planar_walker_basin.yaml", "--no-figures", "--quiet")) == 0
    plane = "{states: {u1: [-1.8, -1.2], u2: [-2.0, 0.5]}, cells: 2, levels: 0}"
    given = (
        f"margins.basin={plane}",
        f"margins.survive={{periods: {STRIDES}, sequence: ignored, returns: 1}}",
    )
    sets = [word for change in given for word in ("--set", change)]
    assert run(("margins", "planar_walker_basin.yaml", "--no-figures", "--quiet", *sets)) == 0
    stored = read_margins("planar_walker_basin_margins.h5")
    with open("planar_walker_basin_basin.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    p, base = parameters(SYSTEM, **stored.header["parameters"]), np.array(stored.instants[0]["state"])
    assert stored.instants[0]["mode"] == "three_link"
    expected = []
    for row in rows:
        pushed = base.copy()
        for name in ("u1", "u2"):
            pushed[SYSTEM.state_names.index(name)] = float(row[name])
        expected.append(stands(pushed, p, STRIDES * 1.4458191))
    assert [row["reaches"] != "fallen" for row in rows] == expected
    assert 0 < sum(expected) < len(rows) == 9
