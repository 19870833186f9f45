"""The van der Pol equation x'' - mu (1 - x^2) x' + x = 0 from almost harmonic to relaxation oscillations."""

import math

import numpy as np
import pytest
from invariants import check_orbit_branch
from orbit_systems import ACCURACY
from small_systems import labelled, small_system

import contwalk as cw

# Amplitude, period, and logarithm of the multiplier (the integral of mu (1 - x^2)): Newton's method on the
# return to
# x' = 0 with scipy's DOP853 at rtol 2.3e-14. The periods at 1 and 10 are those of M. Urabe (1960), 6.663287
# and 19.07837.
REFERENCE = {
    0.01: (2.0000010416479275, 6.283224576985489, -0.06283263846988359),
    0.1: (2.000103979872776, 6.287111272288721, -0.6291039210259994),
    1.0: (2.0086198608748402, 6.663286859323124, -7.058932808798904),
    10.0: (2.014285360926405, 19.078369566939042, -311.8442192862289),
    100.0: (2.001318681177224, 162.8370710923684, -28997.988457286916),
}
# mu = 1000: scipy's Radau at rtol 1e-9 and 1e-10 agree to 1e-7, second round.
STIFF_PERIOD = 1614.4011258


def van_der_pol(mu):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.mu * (1.0 - x[0] * x[0]) * x[1] - x[0]

    return small_system(field, ["x", "v"], {"mu": mu})


def walked(mu, low, high, accuracy=ACCURACY, scheme="shooting", **settings):
    system = van_der_pol(mu)
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "mu", discretization=cw.Discretization(accuracy=accuracy, scheme=scheme)
    )
    guess = REFERENCE.get(mu, (2.0, STIFF_PERIOD))
    start = [guess[0], 0.0]
    return problem, cw.continue_branch(
        problem, start, (low * mu, high * mu), period=guess[1], marks={"mu": [mu]}, **settings
    )


def small_period(mu):
    """Lindstedt's series (A. H. Nayfeh, Perturbation Methods, 1973)."""
    return 2.0 * math.pi * (1.0 + mu**2 / 16.0 - 5.0 * mu**4 / 3072.0)


def large_period(mu):
    """Dorodnicyn's expansion (J. Grasman, Asymptotic Methods for Relaxation Oscillations, 1987,
    section 2.1).
    """
    first = (3.0 - 2.0 * math.log(2.0)) * mu + 7.01432 * mu ** (-1.0 / 3.0)
    return first - 2.0 * math.log(mu) / (3.0 * mu) - 1.3246 / mu


@pytest.mark.drawn(1)
@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.01, 0.1, 1.0, 10.0])
def test_period_amplitude_and_multiplier(mu):
    problem, branch = walked(mu, 0.8, 1.25, max_points=60)
    check_orbit_branch(branch, problem, every=10)
    assert not branch["unstable"].any()
    assert not labelled(branch, "LP", "BP", "PD", "NS")
    _, period, log = REFERENCE[mu]
    (mark,) = labelled(branch, "UZ")
    assert mark.period == pytest.approx(period, rel=ACCURACY)
    # Multipliers are absolute numbers to ten times the accuracy of the orbit: no shooting tells 1e-136 from
    # zero.
    true = abs(mark.spectrum[0] - math.exp(log))
    assert true <= branch.points[mark.index]["spectrum_error"]
    # What lies across the flow becomes a shift of phase, some ten times larger in units of the cycle at mu
    # = 10.
    assert true <= 1e2 * ACCURACY


@pytest.mark.parametrize("scheme", ["shooting", "collocation"])
@pytest.mark.parametrize("accuracy", [1e-5, 1e-6, 1e-7, 1e-8])
def test_a_mark_is_as_accurate_as_was_asked_for(accuracy, scheme):
    """Though the parameter's value at a mark is exact, its orbit is refined like that of any special point:
    that of a start too.
    """
    _, branch = walked(1.0, 0.9, 1.1, accuracy=accuracy, scheme=scheme, max_points=3)
    (mark,) = labelled(branch, "UZ")
    assert mark.period == pytest.approx(REFERENCE[1.0][1], rel=accuracy)


@pytest.mark.parametrize("mu", [0.01, 0.1])
def test_lindstedts_series(mu):
    _, branch = walked(mu, 0.8, 1.25, max_points=60)
    for row in branch.points:
        at = float(row["free"][0])
        # The next term is of the sixth order, with a coefficient below 1e-2; and local errors of the walk.
        assert row["period"] == pytest.approx(small_period(at), rel=1e-2 * at**6 + 300.0 * ACCURACY)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("mu", [100.0])
def test_relaxation_oscillations(mu):
    _, branch = walked(mu, 0.9, 1.1, accuracy=1e-7, max_points=30)
    assert not branch["unstable"].any()
    (mark,) = labelled(branch, "UZ")
    assert mark.period == pytest.approx(REFERENCE[mu][1], rel=1e-7)
    # It is zero to ten times the accuracy that is asked for: 1e-7, on steps a thirtieth of that.
    assert abs(mark.spectrum[0]) < 1e-8
    for row in branch.points:
        # The next term is of the order mu^(-4/3).
        at = float(row["free"][0])
        assert row["period"] == pytest.approx(large_period(at), abs=at ** (-4.0 / 3.0))


@pytest.mark.long
def test_a_stiff_relaxation_oscillation():
    """mu = 1000: the fast parts are a million times as fast as the slow ones.

    The orbit is found by simulation: on a cycle with jumps a guess of state and period is hardly ever good
    enough.
    """
    system = van_der_pol(1000.0)
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "mu", discretization=cw.Discretization(accuracy=1e-6)
    )
    branch = cw.continue_branch(
        problem, [2.0, 0.0], (950.0, 1050.0), until="settled", marks={"mu": [1000.0]}, max_points=12
    )
    mark = labelled(branch, "UZ")[0]
    assert mark.period == pytest.approx(STIFF_PERIOD, rel=1e-6)
    assert mark.period == pytest.approx(large_period(1000.0), abs=1000.0 ** (-4.0 / 3.0))


@pytest.mark.long
def test_from_one_regime_to_the_other():
    """One branch from almost harmonic to relaxation oscillations; the period only grows."""
    system = van_der_pol(0.1)
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "mu", discretization=cw.Discretization(accuracy=1e-7)
    )
    branch = cw.continue_branch(
        problem, [2.0, 0.0], (0.05, 12.0), period=2.0 * math.pi, marks={"mu": [1.0, 10.0]}
    )
    check_orbit_branch(branch, problem, every=40)
    assert branch.outcome.reason == "bound"
    assert np.all(np.diff(branch["period"]) > -1e-5)
    for mark in labelled(branch, "UZ"):
        assert mark.period == pytest.approx(REFERENCE[mark.parameters["mu"]][1], rel=1e-7)
