"""Orbits whose periods, amplitudes, states or parameters are far from one; the numbers must not notice."""

import math

import numpy as np
import pytest
from small_orbits import WALKING, assert_stuart_landau, orbits, stuart_landau
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.errors import StartError
from contwalk.problems.initial.recurrence import recurrent
from contwalk.system import State

ACCURACY = 1e-8
PERIOD_OF_BRUSSELATOR = 5.61627585  # A = 1.2, B = 3


def van_der_pol(t, x, p, dx):
    dx[0] = p.rate * x[1]
    dx[1] = p.rate * (p.mu * (1.0 - x[0] ** 2) * x[1] - x[0])


class TestPeriod:
    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("period", [1e-6, 1e6])
    def test_a_cycle_of_closed_form(self, period):
        rate = 2.0 * math.pi / period
        problem = orbits(stuart_landau(rate), "xy", {"mu": 0.5}, "mu")
        branch = cw.continue_branch(problem, [math.sqrt(0.5), 0.0], (0.05, 1.0), period=1.01 * period)
        assert branch.outcome.reason == "bound"
        assert_stuart_landau(branch, rate, WALKING * ACCURACY)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("rate", [1e-6, 1e6])
    def test_its_hopf_point_has_the_cycle(self, rate):
        system = small_system(stuart_landau(rate), "xy", {"mu": -0.5})
        problem = cw.Equilibrium(system, system.defaults(), "mu")
        branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
        cycle = cw.switch_branch(problem, branch, "HB1", (-1.0, 0.5))
        assert cycle.outcome.reason == "bound"
        assert_stuart_landau(cycle, rate, WALKING * ACCURACY)
        assert np.hypot(cycle["x"], cycle["y"])[-1] == pytest.approx(math.sqrt(0.5), rel=WALKING * ACCURACY)

    @pytest.mark.long
    def test_van_der_pol_at_three_rates_is_one_branch(self):
        periods = {}
        for rate in (1.0, 1e-6, 1e6):
            problem = orbits(van_der_pol, "xv", {"mu": 1.0, "rate": rate}, "mu")
            branch = cw.continue_branch(problem, [2.0, 0.0], (0.5, 1.5), until="settled")
            assert branch.outcome.reason == "bound"
            ends = [float(branch["period"][branch["mu"] == mu][0]) for mu in (0.5, 1.0, 1.5)]
            periods[rate] = rate * np.array(ends)
        # By an integrator of another library at 1e-13.
        assert periods[1.0][1] == pytest.approx(6.663286859323, rel=WALKING * ACCURACY)
        assert periods[1e-6] == pytest.approx(periods[1.0], rel=WALKING * ACCURACY)
        assert periods[1e6] == pytest.approx(periods[1.0], rel=WALKING * ACCURACY)


class TestAmplitude:
    """A cycle of 1e-7 next to its Hopf point."""

    @pytest.mark.long
    def test_around_the_origin(self):
        problem = orbits(stuart_landau(cubic=1e10), "xy", {"mu": 1e-4}, "mu")
        branch = cw.continue_branch(problem, [1e-7, 0.0], (1e-5, 1e-3), period=6.28)
        assert branch.outcome.reason == "bound"
        assert_stuart_landau(branch, 1.0, WALKING * ACCURACY)
        # The amplitude is as well known as 1 - multiplier is: the tolerance over 4 pi mu.
        known = WALKING * ACCURACY / (4.0 * math.pi * branch["mu"])
        off = np.hypot(branch["x"], branch["y"]) / np.sqrt(branch["mu"] / 1e10) - 1.0
        assert np.all(np.abs(off) <= known)

    def test_around_a_state_of_one(self):
        problem = orbits(stuart_landau(cubic=1e10, middle=1.0), "xy", {"mu": 1e-4}, "mu")
        branch = cw.continue_branch(problem, [1.0 + 1e-7, 2.0], (1e-5, 1e-3), period=6.28)
        assert branch.outcome.reason == "bound"
        # Rounding of the states is 2e-9 of the amplitude.
        assert_stuart_landau(branch, 1.0, WALKING * ACCURACY)

    @pytest.mark.parametrize("cubic", [1e6, 1e8])
    def test_born_at_the_hopf_point(self, cubic):
        """mu up to 1e-14 cubic: the amplitude is 1e-7 at the end.

        mu itself is known to the error of the steps over 4 pi: an accuracy below it must be asked for.
        """
        system = small_system(stuart_landau(cubic=cubic), "xy", {"mu": -0.5})
        problem = cw.Equilibrium(system, system.defaults(), "mu", discretization=cw.Discretization(1e-13))
        branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
        cycle = cw.switch_branch(problem, branch, "HB1", (-1.0, 1e-14 * cubic))
        assert cycle.outcome.reason == "bound"
        assert cycle["mu"][-1] == 1e-14 * cubic
        assert_stuart_landau(cycle, 1.0, ACCURACY)

    @pytest.mark.parametrize("size", [1e-9, 1e9])
    def test_a_simulation_settles_on_it_in_any_unit(self, size):
        """Its first steps have the size of the state that it begins with, which declares no scale."""

        def brusselator(t, x, p, dx):
            u, v = x[0] / size, x[1] / size
            dx[0] = size * (p.A - (p.B + 1.0) * u + u**2 * v)
            dx[1] = size * (p.B * u - u**2 * v)

        system = small_system(brusselator, "xy", {"A": 1.2, "B": 3.0})
        found = recurrent(system, system.defaults(), size * np.array([1.2, 2.6]))
        # By an integrator of another library at 1e-13; a guess is good to `RETURNED` of its way round.
        assert found.period == pytest.approx(PERIOD_OF_BRUSSELATOR, rel=1e-3)

    def test_an_orbit_of_no_amplitude_is_not_stored(self):
        """mu = 1e-14 is within the tolerance of the Hopf point: the cycle, or an outcome that says so."""
        problem = orbits(stuart_landau(), "xy", {"mu": 1e-14}, "mu")
        try:
            branch = cw.continue_branch(problem, [1e-7, 0.0], (1e-15, 1e-10), period=6.28)
        except StartError:
            return
        assert branch.outcome.reason in ("bound", "shrunk"), branch.outcome
        if branch.outcome.reason == "bound":
            assert np.all(np.hypot(branch["x"], branch["y"]) > 1e-9)


SMALL, LARGE = 1e-9, 1e9
# Period at A = 1, B = 3, by an integrator of another library at 1e-13.
BRUSSELATOR = 7.15691992118


def scaled_brusselator(t, x, p, dx):
    u, v = x[0] / SMALL, x[1] / LARGE
    dx[0] = SMALL * (p.A - (p.B + 1.0) * u + u * u * v)
    dx[1] = LARGE * (p.B * u - u * u * v)


@pytest.mark.parametrize("declared", [False, True])
class TestStates:
    """u of 1e-9 beside v of 1e9."""

    def _system(self, declared, b):
        scales = (SMALL, LARGE) if declared else (None, None)
        states = [State(name, scale=s) for name, s in zip("uv", scales, strict=True)]
        return small_system(scaled_brusselator, states, {"A": 1.0, "B": b})

    @pytest.mark.drawn(1)
    def test_the_cycle_from_the_hopf_point(self, declared):
        system = self._system(declared, 1.5)
        problem = cw.Equilibrium(system, system.defaults(), "B")
        branch = cw.continue_branch(problem, [SMALL, 1.5 * LARGE], (1.0, 3.0))
        cycle = cw.switch_branch(problem, branch, "HB1", (1.0, 3.0))
        assert cycle.outcome.reason == "bound"
        assert labelled(cycle, "LP", "BP", "PD", "NS") == []
        assert np.all(cycle["unstable"][cycle["s"] > 0.0] == 0)
        assert cycle["B"][-1] == 3.0
        assert cycle["period"][-1] == pytest.approx(BRUSSELATOR, rel=WALKING * ACCURACY)

    @pytest.mark.drawn(1)
    @pytest.mark.slow
    def test_the_cycle_from_a_simulation(self, declared):
        system = self._system(declared, 3.0)
        problem = cw.PeriodicOrbit(system, system.defaults(), "B")
        branch = cw.continue_branch(problem, [SMALL, 1.5 * LARGE], (2.5, 3.0), until="settled")
        assert branch.outcome.reason == "bound"
        assert branch["period"][branch["B"] == 3.0] == pytest.approx(BRUSSELATOR, rel=WALKING * ACCURACY)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("unit", [1e12, 1e-12])
def test_a_parameter_of_1e12(unit):
    system = small_system(stuart_landau(unit=unit), "xy", {"mu": -0.5 * unit})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-unit, unit))
    cycle = cw.switch_branch(problem, branch, "HB1", (-unit, unit))
    assert cycle.outcome.reason == "bound"
    assert cycle["mu"][-1] == unit
    assert_stuart_landau(cycle, 1.0, WALKING * ACCURACY, unit)


def test_a_parameter_of_1e12_that_changes_by_one():
    """The cycle is that of mu - 1e12, exactly: the subtraction has no rounding."""

    def field(t, x, p, dx):
        mu, square = p.mu - 1e12, x[0] ** 2 + x[1] ** 2
        dx[0] = mu * x[0] - x[1] - x[0] * square
        dx[1] = x[0] + mu * x[1] - x[1] * square

    problem = orbits(field, "xy", {"mu": 1e12 + 0.5}, "mu")
    branch = cw.continue_branch(problem, [math.sqrt(0.5), 0.0], (1e12 + 0.25, 1e12 + 1.0), period=6.28)
    assert branch.outcome.reason == "bound"
    off = branch["mu"] - 1e12
    # 1e12 is known to 1.2e-4, which is what a parameter found by the walk is rounded to.
    assert np.hypot(branch["x"], branch["y"]) ** 2 == pytest.approx(off, abs=1e-3)
    assert branch["period"] == pytest.approx(2.0 * math.pi, rel=WALKING * ACCURACY)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("lowest", [1.01, 1.0001])
def test_an_orbit_that_creeps_past_a_point_where_the_field_nearly_vanishes(lowest):
    """Angular velocity a^2 - cos: T = 2 pi / sqrt(a^4 - 1), and the other multiplier is exp(-2 T)."""

    def field(t, x, p, dx):
        square, rate = x[0] ** 2 + x[1] ** 2, p.a * p.a - x[0]
        dx[0] = x[0] - rate * x[1] - x[0] * square
        dx[1] = rate * x[0] + x[1] - x[1] * square

    problem = orbits(field, "xy", {"a": 1.5}, "a")
    start = 2.0 * math.pi / math.sqrt(1.5**4 - 1.0)
    branch = cw.continue_branch(problem, [-1.0, 0.0], (lowest, 1.5), period=1.01 * start)
    assert branch.outcome.reason == "bound"
    a = branch["a"]
    period = 2.0 * math.pi / np.sqrt(a**4 - 1.0)
    # An error of the parameter by the walk's tolerance moves the period by 2 a^3 / (a^4 - 1) of itself.
    assert np.all(
        np.abs(branch["period"] / period - 1.0) <= WALKING * ACCURACY * (1.0 + 2.0 * a**3 / (a**4 - 1.0))
    )
    # Speeds along the orbit differ by a^4 - 1, and so do the sizes of its own, trivial, deviation.
    off = np.abs(branch.points["spectrum"][:, 0] - np.exp(-2.0 * period))
    assert np.all(off <= np.maximum(WALKING * ACCURACY, branch["spectrum_error"]))


@pytest.mark.slow
def test_an_orbit_that_creeps_for_ever_ends_as_homoclinic():
    def field(t, x, p, dx):
        square, rate = x[0] ** 2 + x[1] ** 2, p.a * p.a - x[0]
        dx[0] = x[0] - rate * x[1] - x[0] * square
        dx[1] = rate * x[0] + x[1] - x[1] * square

    problem = orbits(field, "xy", {"a": 1.5}, "a")
    branch = cw.continue_branch(problem, [-1.0, 0.0], (0.5, 1.5), direction="backward", period=3.1)
    assert branch.outcome.reason == "homoclinic", branch.outcome
    assert branch["a"].min() == pytest.approx(1.0, abs=1e-3)
    assert branch["period"].max() > 100.0
