"""The motion along a stored orbit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import ContwalkError

# A circle of radius sqrt(a), once around in 2 pi.
CIRCLE = "x' = a*x - y - x*(x^2 + y^2); y' = x + a*y - y*(x^2 + y^2); a = 0.1"
# A leaky integrator that fires at 1 and begins anew at 0.
NEURON = "x' = drive - x; drive = 1.5; event spike: x - 1 rises, x = 0; x(0) = 0.2"


@pytest.fixture(scope="module")
def diagram():
    return cw.diagram(cw.system_from_text(CIRCLE), "a", (-0.1, 0.5), start={"x": 0.0, "y": 0.0})


def test_it_is_the_orbit_of_the_point(diagram, tmp_path):
    found = cw.motion(diagram, "b2/EP1", periods=2)
    a = diagram["b2/EP1"].parameters["a"]
    assert found.period == pytest.approx(2 * math.pi, rel=1e-8)
    assert found.times[-1] - found.times[0] == pytest.approx(4 * math.pi, rel=1e-8)
    assert np.hypot(*found.states.T) == pytest.approx(np.full(len(found.times), math.sqrt(a)), rel=1e-6)
    stored = cw.open_database(diagram.save(tmp_path / "circle.h5"))
    row = cw.motion(stored, "b2/5")
    assert np.hypot(*row.states.T) == pytest.approx(
        np.full(len(row.times), math.sqrt(stored["b2"][5]["a"])), rel=1e-6
    )


@pytest.mark.parametrize(
    ("point", "said"),
    [
        ("b9/HB1", "'b9/HB1' is no point"),
        ("b2", "'b2' is no point"),
        ("b2/XX1", "no special point 'XX1'"),
        ("b2/999999", "has no row 999999"),
        ("b1/HB1", "periodic orbits"),
    ],
)
def test_what_is_no_orbit_is_refused(diagram, point, said):
    with pytest.raises(ContwalkError, match=said):
        cw.motion(diagram, point)


def test_periods_are_a_whole_number(diagram):
    with pytest.raises(ContwalkError, match="whole number from 1 up"):
        cw.motion(diagram, "b2/5", periods=0)


def test_events_are_on_it():
    start = {"simulate": {"state": {"x": 0.2}}}
    found = cw.diagram(cw.system_from_text(NEURON), "drive", (1.4, 1.6), start=start, diagram="none")
    motion = cw.motion(found, "b1/EP1", periods=3)
    assert motion.period == pytest.approx(math.log(1.4 / 0.4), rel=1e-7)
    assert [name for _, name in motion.events][:2] == ["spike", "spike"]
    jumps = motion.jumps
    assert motion.states[jumps - 1, 0] == pytest.approx(np.ones(len(jumps)), rel=1e-6)
    assert motion.states[jumps, 0] == pytest.approx(np.zeros(len(jumps)), abs=1e-6)
