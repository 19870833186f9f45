"""Margins of a forced orbit along its modes, at several instants, against the closed form."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins

# A damped oscillator that is shaken, and has fallen beyond x = 1.
PLUGIN = """\
import math
from contwalk.system import Mode, Parameter, State, System

def shaken(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 2.0 * p.zeta * x[1] + math.cos(2.0 * t)

SYSTEM = System(
    name="shaken",
    states=(State("x", "m"), State("v", "m/s")),
    parameters=(Parameter("zeta", 0.1),),
    modes=(Mode("free", shaken),),
    period=lambda p: math.pi,
    fallen=lambda t, x, p: x[0] - 1.0,
)
"""
RUN = """\
system: ./shaken.py
start: {simulate: {state: {x: 0.0, v: 0.0}, until: settled}}
continue: {parameter: zeta, range: [0.1, 0.2], max_points: 2, direction: up}
diagram: none
margins:
  of: {from: shaken.h5, point: b1/0}
  instants: [0, 0.3, 0.8]
  survive: {periods: 20}
  accuracy: 1e-5
  scan: 0
  modes: 1
output: shaken.h5
"""
ZETA = 0.1
OMEGA = math.sqrt(1.0 - ZETA**2)
ANSWER = 1.0 / (1.0 - 4.0 + 4j * ZETA)  # to exp(2 i t)


def deviated(push, time):
    """x of what a push becomes."""
    share = (push[1] + ZETA * push[0]) / OMEGA
    return np.exp(-ZETA * time) * (push[0] * np.cos(OMEGA * time) + share * np.sin(OMEGA * time))


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shaken")
    (folder / "shaken.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "shaken.yaml").write_text(RUN, encoding="utf-8")
    with contextlib.chdir(folder):
        assert run(("continue", "shaken.yaml", "--no-figures", "--quiet")) == 0
        assert run(("margins", "shaken.yaml", "--no-figures", "--quiet")) == 0
        return read_margins("shaken_margins.h5")


def test_borders_along_the_modes_at_each_instant(shaken):
    time = np.linspace(0.0, 12.0, 120_001)
    assert {row["state"] for row in shaken.rows} == {"mode1_re", "mode1_im"}
    for row in shaken.rows:
        begin = shaken.instants[row["instant"]]["time"]
        room = 1.0 - (ANSWER * np.exp(2j * (begin + time))).real
        becomes = deviated(row["sign"] * np.array(row["vector"]), time)
        exact = np.min(room[becomes > 1e-9] / becomes[becomes > 1e-9])
        assert row["border"] == pytest.approx(exact, rel=2e-5)


def test_the_parts_of_the_mode_belong_together(shaken):
    """Of a linear machine, re + i s im is (1, rate) for some share s, at every instant."""
    for instant in range(3):
        parts = {r["state"]: r["vector"] for r in shaken.rows if r["instant"] == instant}
        (x_re, v_re), (x_im, v_im) = parts["mode1_re"], parts["mode1_im"]
        share = OMEGA * x_re / (v_im + ZETA * x_im)
        assert v_re == pytest.approx(-ZETA * x_re - OMEGA * share * x_im, abs=1e-7)


PENDULUM = """\
import math
from contwalk.system import Conserved, Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g * math.sin(x[0])

def energy(t, x, p):
    return 0.5 * x[1] ** 2 - p.g * math.cos(x[0])

SYSTEM = System(
    "pendulum",
    states=(State("q"), State("w")),
    parameters=(Parameter("g", 1.0),),
    modes=(Mode("swings", field),),
    conserved=(Conserved("energy", energy),),
)
"""
SWINGS = """\
system: ./pendulum.py
start: {simulate: {state: {q: 1.0, w: 0.0}}}
continue: {parameter: energy, range: [-0.6, -0.3], max_points: 2, direction: up}
margins:
  of: {from: swings.h5, point: b1/0}
  survive: {periods: 2}
  states: [q]
  instants: 1
  scan: 0
  accuracy: 0.1
  basin: {states: {q: [-0.5, 0.5], w: [-0.5, 0.5]}, cells: 1, levels: 0}
output: swings.h5
"""


def test_what_is_conserved_is_told_not_to_be_forgotten(contwalk, folder):
    (folder / "pendulum.py").write_text(PENDULUM, encoding="utf-8")
    (folder / "swings.yaml").write_text(SWINGS, encoding="utf-8")
    assert contwalk("continue", "swings.yaml", "--no-figures").code == 0
    done = contwalk("margins", "swings.yaml", "--no-figures")
    assert done.code == 0
    said = " ".join(done.out.split())
    assert "Pushes change what the machine conserves (energy), and that is never forgotten" in said
    assert "Motions of the basin keep energy as they begin" in said
