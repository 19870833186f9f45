"""Orbits of machines that conserve their energy, along it and at a given value of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from conserved_machines import BALL, HENON_HEILES, PENDULUM
from hybrid_runs import diagram
from orbit_systems import ACCURACY, orbits
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import contwalk as cw

# Along a branch local errors are 100 times the accuracy of special points (Discretization.walking).
WALKED = 100.0 * ACCURACY


def bifurcations(branch):
    return [point for point in branch.special_points if point.label not in ("EP", "UZ")]


def period_of_pendulum(energy: float, length: float, g: float = 9.81) -> float:
    """4 sqrt(l / g) K(sin(amplitude / 2)), with the parameter m = k^2 of SciPy."""
    return 4.0 * math.sqrt(length / g) * float(ellipk(energy / (2.0 * g * length)))


def test_the_pendulum_at_all_amplitudes():
    """From 0.8 degrees to 172: half the energy of the upright position is 9.81."""
    branch = cw.continue_branch(orbits(PENDULUM, "energy"), [1.0, 0.0], (1e-3, 19.53), period=2.1496)
    assert branch.outcome.reason == "bound"
    assert not bifurcations(branch)
    assert sorted([branch["energy"][0], branch["energy"][-1]]) == [1e-3, 19.53]
    for energy, period, (q, w) in zip(branch["energy"], branch["period"], branch["state"], strict=True):
        assert energy_at(q, w, 1.0) == pytest.approx(energy, rel=3.0 * WALKED)
        # Near the upright position the period changes by as much as energies there differ.
        steep = 1.0 / (1.0 - energy / (2.0 * 9.81))
        assert period == pytest.approx(period_of_pendulum(energy, 1.0), rel=3.0 * WALKED * steep)


def energy_at(q: float, w: float, length: float) -> float:
    return 0.5 * length**2 * w**2 + 9.81 * length * (1.0 - math.cos(q))


@pytest.mark.long
def test_the_pendulum_at_the_start_s_own_energy_as_its_length_changes():
    branch = cw.continue_branch(orbits(PENDULUM, "l"), [1.0, 0.0], (0.5, 2.0), period=2.1496)
    own = energy_at(1.0, 0.0, 1.0)
    assert branch.info.parameters["energy"] == pytest.approx(own, rel=1e-15)
    for length, period in zip(branch["l"], branch["period"], strict=True):
        assert period == pytest.approx(period_of_pendulum(own, length), rel=10.0 * WALKED)
    # Both multipliers of the plane are trivial: none is left to be unstable.
    assert not branch["unstable"].any()


def test_a_given_energy_is_met():
    """The start has another one: Newton's method goes to the orbit that was asked for."""
    problem = cw.PeriodicOrbit(PENDULUM, PENDULUM.defaults() | {"energy": 6.0}, "l")
    branch = cw.continue_branch(problem, [1.0, 0.0], (0.8, 1.2), period=2.1496)
    for length, period, (q, w) in zip(branch["l"], branch["period"], branch["state"], strict=True):
        assert energy_at(q, w, length) == pytest.approx(6.0, rel=3.0 * WALKED)
        assert period == pytest.approx(period_of_pendulum(6.0, length), rel=10.0 * WALKED)


@pytest.mark.long
def test_the_ball_without_losses():
    """Two flights of sqrt(2 h / g) each, whatever the height h."""
    (branch,) = diagram(BALL, "energy", (0.5, 40.0), [1.0, 0.0], until="settled")
    assert branch.outcome.reason == "bound"
    assert not bifurcations(branch)
    for energy, period in zip(branch["energy"], branch["period"], strict=True):
        assert period == pytest.approx(2.0 * math.sqrt(2.0 * energy) / 9.81, rel=WALKED)


def half_trace(energy: float) -> float:
    """(mu + 1 / mu) / 2 of the orbit on the y-axis, by SciPy.

    Deviations in x obey x'' = -(1 + 2 y) x, a Hill equation: the trace of its map over one period of y.
    """

    def rates(t, s):
        y, v, a, da, b, db = s
        k = -(1.0 + 2.0 * y)
        return [v, -y + y * y, da, k * a, db, k * b]

    def passes(t, s):
        return s[0]

    passes.direction = 1.0
    start = [0.0, math.sqrt(2.0 * energy), 1.0, 0.0, 0.0, 1.0]
    found = solve_ivp(
        rates, (0.0, 60.0), start, "DOP853", events=[passes], rtol=1e-12, atol=1e-14, max_step=0.5
    )
    times, states = found.t_events[0], found.y_events[0]
    later = int(np.argmax(times > 1e-3))
    return 0.5 * (states[later][2] + states[later][5])


@pytest.fixture(scope="module")
def nodding():
    problem = orbits(HENON_HEILES, "energy")
    return cw.continue_branch(problem, [0.0, 0.1, 0.0, 0.0], (0.001, 0.166), period=2.0 * math.pi)


# In units of the energy 1/6 of the saddles: where the orbits R5 and L6 are born (M. Brack, Foundations of
# Physics 31, 209, 2001).
PUBLISHED = {"BP1": 0.969309, "BP2": 0.986709}


@pytest.mark.long
def test_henon_heiles_bifurcations_of_the_orbit_on_an_axis(nodding):
    """Each where the trace is 2 or -2 by SciPy, and counted in pairs."""
    found = {point.name: point for point in bifurcations(nodding)}
    assert list(found) == ["PD1", "PD2", "BP1", "BP2", "PD3"]
    for name, point in found.items():
        energy, target = point.parameters["energy"], -1.0 if name.startswith("PD") else 1.0
        h = 1e-6 * energy
        slope = (half_trace(energy + h) - half_trace(energy - h)) / (2.0 * h)
        # SciPy's tolerance of 1e-12 grows to some 1e-9 of the trace over the period.
        off = abs((half_trace(energy) - target) / slope)
        assert off <= point.error + 3e-9 / abs(slope), name
        assert point.error <= ACCURACY * energy
        assert point.criticality is None
        assert "pair meets" in str(point.note)
    counts = [(point.unstable_before, point.unstable_after) for point in found.values()]
    assert counts == [(0, 1), (1, 0), (0, 1), (1, 0), (0, 1)]
    for name, share in PUBLISHED.items():  # six digits are printed
        assert found[name].parameters["energy"] * 6.0 == pytest.approx(share, abs=5e-7)


@pytest.mark.parametrize("name", ["PD1", "BP1"])
def test_henon_heiles_branches_that_leave(nodding, name):
    """What is born where the orbit on the axis loses its stability is stable at first."""
    problem, point = orbits(HENON_HEILES, "energy"), nodding.special(name)
    branch = cw.switch_branch(problem, nodding, name, (0.001, 0.166), max_points=8)
    assert len(branch) >= 8
    assert branch["energy"].min() >= point.parameters["energy"] * (1.0 - 1e-9)
    assert not branch["unstable"][np.argsort(branch["energy"])[1:4]].any()
    rounds = 2.0 if name == "PD1" else 1.0
    assert branch["period"].min() == pytest.approx(rounds * point.period, rel=1e-3)


@pytest.mark.long
def test_henon_heiles_multipliers_along_the_branch(nodding):
    """Two are left of four: on the unit circle but for the errors of the steps, or real."""
    for row in nodding.points[::12]:
        values, half = row["spectrum"], half_trace(float(row["free"][0]))
        assert values.shape == (2,)
        # Errors of the steps, some thousand of them, in a map with entries of some tens.
        assert 0.5 * complex(values.sum()) == pytest.approx(half, abs=1e3 * WALKED)
        assert int(row["unstable"]) == int(abs(half) > 1.0)
