"""Signals: quantities along a motion, for figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import small_system

from contwalk.errors import ContwalkError, PluginError, SystemDefinitionError
from contwalk.system import Signal
from contwalk.workflow.quantities import values_along


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * x[0]


def energy(t, x, p):
    return 0.5 * (x[:, 1] ** 2 + p.k * x[:, 0] ** 2)


TIMES = np.linspace(0.0, 1.0, 5)
STATES = np.column_stack([np.cos(2.0 * TIMES), -2.0 * np.sin(2.0 * TIMES)])


def with_signal(signal: Signal):
    return replace(small_system(field, "xv", {"k": 4.0}), signals=(signal,))


def test_a_signal_stands_beside_states():
    system = with_signal(Signal("energy", energy, "J"))
    found = values_along(system, ["x", "energy"], TIMES, STATES, {"k": 4.0})
    np.testing.assert_array_equal(found[:, 0], STATES[:, 0])
    np.testing.assert_allclose(found[:, 1], 2.0, rtol=1e-14)


def test_what_is_neither_is_named():
    with pytest.raises(ContwalkError, match="'enrgy' is neither a state nor a signal") as caught:
        values_along(with_signal(Signal("energy", energy)), ["enrgy"], TIMES, STATES, {"k": 4.0})
    assert "energy" in str(caught.value)


def test_one_number_for_each_instant():
    system = with_signal(Signal("mean", lambda t, x, p: x[:, 0].mean()))
    with pytest.raises(PluginError, match="Signal 'mean' returns an array of shape"):
        values_along(system, ["mean"], TIMES, STATES, {"k": 4.0})


def test_a_name_stands_for_one_thing():
    with pytest.raises(SystemDefinitionError, match="'x' is a state and a signal"):
        with_signal(Signal("x", energy))
