"""Signals: quantities along a motion, for figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.errors import ContwalkError, PluginError, SystemDefinitionError
from contwalk.system import Signal
from contwalk.system.observables import SignalExtreme
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


SUM = Signal("sum", lambda t, x, p: x[:, 0] + x[:, 1], "m", "of both", extremes=True)


def circle(t, x, p, dx):
    """z' = (mu + i - |z|^2) z: a cycle of radius sqrt(mu)."""
    r = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = r * x[0] - x[1]
    dx[1] = x[0] + r * x[1]


def test_extremes_of_a_signal_are_observables():
    system = replace(small_system(circle, "xy", {"mu": 0.5}), signals=(SUM,))
    assert [(o.name, o.unit) for o in system.observables] == [("sum_max", "m"), ("sum_min", "m")]
    assert replace(system).observables == system.observables
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [0.7, 0.0], (0.3, 1.0), period=6.28)
    exact = np.sqrt(2.0 * branch["mu"])
    # Instants are h = 2 pi / 512 apart at most: a parabola through three is h^3 / (9 sqrt(3)) off or less.
    off = (2.0 * np.pi / 512) ** 3 / (9.0 * 3.0**0.5)
    np.testing.assert_allclose(branch["sum_max"], exact, rtol=off)
    np.testing.assert_allclose(branch["sum_min"], -exact, rtol=off)


def test_extremes_of_equilibria_are_values():
    system = replace(small_system(circle, "xy", {"mu": -0.5}), signals=(SUM,))
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    assert not branch["sum_max"].any()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([0.0, 3.0, 4.0, 3.0], 4.0),
        ([1.0, 3.0, 3.0, 1.0], 3.25),  # the parabola through 1, 3, 3
        ([5.0, 1.0, 1.0, 1.0], 5.0),  # at an end
        ([np.nan, 2.0, 3.0, np.nan], 3.0),
        ([np.nan] * 4, np.nan),
    ],
)
def test_the_largest_of_some_values(values, expected):
    of = SignalExtreme(Signal("s", lambda t, x, p: np.array(values)), 1.0)
    assert of(np.arange(4.0), np.zeros((4, 1)), None) == pytest.approx(expected, nan_ok=True)
    least = SignalExtreme(Signal("s", lambda t, x, p: -np.array(values)), -1.0)
    assert least(np.arange(4.0), np.zeros((4, 1)), None) == pytest.approx(-expected, nan_ok=True)


def test_no_parabola_reaches_across_an_event():
    of = SignalExtreme(Signal("s", lambda t, x, p: np.array([0.0, 1.0, 0.9, 0.0])), 1.0)
    assert of(np.array([0.0, 1.0, 1.0, 2.0]), np.zeros((4, 1)), None) == 1.0
