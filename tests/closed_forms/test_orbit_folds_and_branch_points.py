"""Folds, pitchforks and transcritical points of cycles in closed form."""

import math

import numpy as np
import pytest
from invariants import check_orbit_branch
from orbit_systems import ACCURACY, assert_met, bautin, born_across, orbits, transverse
from small_systems import labelled

import contwalk as cw

pytestmark = pytest.mark.slow

COEFFICIENT = 1e-6
WALKED = 100.0 * ACCURACY


def bautin_rows(branch):
    for row in branch.points:
        mu, square = float(row["free"][0]), float(row["state"] @ row["state"])
        if square < 1e-2:
            continue
        period = 2.0 * math.pi / (3.0 + 0.4 * square)
        # mu is a parabola of the square: compared as equations, there is no square root of an error.
        assert abs(mu - 1.0 + square - square**2) <= 3.0 * WALKED
        assert row["period"] == pytest.approx(period, rel=30.0 * WALKED)
        exact = math.exp(period * (2.0 * square - 4.0 * square**2))
        assert abs(row["spectrum"][0] - exact) <= max(row["spectrum_error"], 10 * WALKED)


@pytest.mark.long
def test_the_fold_of_cycles():
    problem = orbits(bautin(), "mu")
    square = 0.5 + math.sqrt(0.9 - 0.75)
    branch = cw.continue_branch(
        problem,
        [math.sqrt(square), 0.0],
        (0.5, 1.5),
        period=2.0 * math.pi / (3.0 + 0.4 * square),
        max_points=200,
    )
    # Beyond the fold the cycle shrinks into its Hopf point at mu = 1: tested below, from there.
    points = labelled(branch, "LP", "BP", "PD", "NS")
    assert [p.label for p in points][:1] == ["LP"] or [p.label for p in points][-1:] == ["LP"]
    fold = next(p for p in points if p.label == "LP")
    assert_fold(fold)


def assert_fold(fold):
    assert_met(fold, "mu", 0.75)
    period = 2.0 * math.pi / 3.2
    # The located orbit is good to the square root of the error along the branch.
    assert math.hypot(*fold.state.values()) == pytest.approx(math.sqrt(0.5), rel=1e-4)
    assert fold.period == pytest.approx(period, rel=1e-5)
    assert sorted((fold.unstable_before, fold.unstable_after)) == [0, 1]
    # r -> r + T (r (mu - 3/4) + g'' (r - r0)^2 / 2), g'' = 6 r - 20 r^3 = -2 sqrt 2, in units of r0 = 1 /
    # sqrt 2.
    assert abs(fold.coefficients["a"]) == pytest.approx(period, rel=1e-4)
    assert fold.coefficients["a"] * fold.coefficients["b"] == pytest.approx(-(period**2), rel=1e-4)


def test_from_the_subcritical_hopf_point_round_the_fold():
    system = bautin()
    problem = cw.Equilibrium(
        system, system.defaults() | {"mu": 0.8}, "mu", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    rest = cw.continue_branch(problem, [0.0, 0.0], (0.5, 1.5))
    (hopf,) = labelled(rest, "HB", "BP", "LP")
    assert hopf.criticality == "subcritical"
    branch = cw.switch_branch(problem, rest, "HB1", (0.5, 1.5))
    check_orbit_branch(branch, problem)
    (fold,) = labelled(branch, "LP", "BP", "PD", "NS")
    assert fold.label == "LP"
    assert_fold(fold)
    assert (fold.unstable_before, fold.unstable_after) == (1, 0)
    assert branch.outcome.reason == "bound"
    assert branch["mu"][-1] == 1.5
    bautin_rows(branch)


# Without a declared scale, a state that is zero on the whole branch has its size from nothing but its
# motion across.
@pytest.mark.drawn(1)
@pytest.mark.parametrize(("tilt", "scale"), [(0.0, 1.0), (0.0, None), (0.6, None)])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_pitchfork_of_cycles(sign, tilt, scale):
    """zeta' = (lam - 1) zeta +- zeta^3: the crossing branch is zeta^2 = (1 - lam) / +-1, multiplier
    exp(2 T (1 - lam)).
    """
    system = transverse(lambda p, z: (p.lam - 1.0) * z + sign * z * z * z, tilt=tilt, scale=scale, lam=0.6)
    problem, period = orbits(system, "lam"), math.pi
    branch = cw.continue_branch(problem, [1.0, 0.0, tilt], (0.5, 1.5), period=period)
    check_orbit_branch(branch, problem)
    (point,) = labelled(branch, "LP", "BP", "PD", "NS")
    assert (point.label, point.kind) == ("BP", "pitchfork")
    assert_met(point, "lam", 1.0)
    assert (point.unstable_before, point.unstable_after) == (0, 1)
    assert point.criticality == ("subcritical" if sign > 0 else "supercritical")
    assert point.coefficients["c11"] == 0.0
    if tilt == 0.0 and scale == 1.0:
        assert point.coefficients["c"] == pytest.approx(sign * period, rel=COEFFICIENT)
        assert abs(point.coefficients["c"] - sign * period) <= point.coefficients["c_error"] + 1e-12
        # The critical multiplier is exp(T (lam - 1)): c12 = T.
        assert abs(point.coefficients["c12"]) == pytest.approx(period, rel=COEFFICIENT)
    other = cw.switch_branch(problem, branch, point, (0.5, 1.5))
    check_orbit_branch(other, problem)
    for row in other.points:
        lam, zeta = float(row["free"][0]), float(row["state"][2] - tilt * row["state"][0])
        assert abs((lam - 1.0) + sign * zeta**2) <= 10.0 * WALKED
        exact = sorted([math.exp(2.0 * period * (1.0 - lam)), math.exp(-2.0 * period)], reverse=True)
        np.testing.assert_allclose(row["spectrum"].real, exact, rtol=0, atol=50.0 * WALKED * max(exact))
    end = 1.5 if sign < 0 else 0.5
    assert other["lam"][0] == other["lam"][-1] == end
    assert other["z"][0] * other["z"][-1] < 0.0 or tilt


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("tilt", "scale"), [(0.0, 1.0), (0.0, None), (-0.4, None)])
def test_the_transcritical_point_of_cycles(tilt, scale):
    """zeta' = (lam - 1 - zeta) zeta: the other branch is zeta = lam - 1, and they exchange stability."""
    system = transverse(lambda p, z: (p.lam - 1.0 - z) * z, tilt=tilt, scale=scale, lam=0.6)
    problem, period = orbits(system, "lam"), math.pi
    branch = cw.continue_branch(problem, [1.0, 0.0, tilt], (0.5, 1.5), period=period)
    check_orbit_branch(branch, problem)
    (point,) = labelled(branch, "LP", "BP", "PD", "NS")
    assert (point.label, point.kind, point.criticality) == ("BP", "transcritical", None)
    assert_met(point, "lam", 1.0)
    assert (point.unstable_before, point.unstable_after) == (0, 1)
    other = cw.switch_branch(problem, branch, point, (0.5, 1.5))
    check_orbit_branch(other, problem)
    assert sorted([other["lam"][0], other["lam"][-1]]) == [0.5, 1.5]
    for row in other.points:
        zeta = float(row["state"][2] - tilt * row["state"][0])
        assert zeta == pytest.approx(float(row["free"][0]) - 1.0, abs=10.0 * WALKED)
        if abs(zeta) > 1e-3:
            assert row["unstable"] == (zeta < 0.0)


def crossing_of_the_plane(system):
    """The branch point of the cycles that leave the Hopf point in the plane z = 0."""
    chosen = cw.Discretization(accuracy=ACCURACY)
    problem = cw.Equilibrium(system, system.defaults(), "lam", discretization=chosen)
    rest = cw.continue_branch(problem, [0.0, 0.0, 0.0], (-0.5, 0.5))
    branch = cw.switch_branch(problem, rest, "HB1", (-0.5, 1.5))
    (point,) = labelled(branch, "LP", "BP", "PD", "NS")
    assert point.label == "BP"
    assert_met(point, "lam", 1.0)
    return point


def crossed(p, zeta):
    return (p.lam - 1.0 - zeta) * zeta


@pytest.mark.drawn(1)
@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_a_transcritical_point_at_a_state_of_unknown_size(unit):
    """zeta' = (lam - 1 - zeta) zeta from the cycles with zeta = 0: they cross in whatever unit of z.

    The period is pi, and z is measured in the cycle's radius, 1: z -> z + pi ((lam - 1) z - unit z^2).
    """
    point = crossing_of_the_plane(born_across(crossed, unit))
    assert (point.kind, point.criticality) == ("transcritical", None)
    assert point.coefficients["c11"] == pytest.approx(-2.0 * math.pi * unit, rel=COEFFICIENT)
    assert abs(point.coefficients["c12"]) == pytest.approx(math.pi, rel=COEFFICIENT)


@pytest.mark.long
@pytest.mark.parametrize("unit", [1.0, 1e6])
def test_the_same_point_from_the_cycles_that_cross(unit):
    """From the cycles with zeta = lam - 1, where z has a size until it is met: they say the same."""
    chosen = cw.Discretization(accuracy=ACCURACY)
    problem = cw.PeriodicOrbit(born_across(crossed, unit), {"lam": 1.4}, "lam", discretization=chosen)
    branch = cw.continue_branch(problem, [math.sqrt(1.4), 0.0, 0.4 / unit], (0.6, 1.5), period=math.pi)
    (point,) = labelled(branch, "LP", "BP", "PD", "NS")
    assert (point.label, point.kind, point.criticality) == ("BP", "transcritical", None)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("sign", "unit"), [(1.0, 1.0), (-1.0, 1.0), (1.0, 1e6), (-1.0, 1e6)])
def test_a_pitchfork_at_a_state_of_unknown_size(sign, unit):
    """zeta' = (lam - 1) zeta +- zeta^3: no quadratic term in any unit, and c = +- pi unit^2."""
    point = crossing_of_the_plane(born_across(lambda p, z: (p.lam - 1.0) * z + sign * z * z * z, unit))
    assert (point.kind, point.coefficients["c11"]) == ("pitchfork", 0.0)
    assert point.coefficients["c"] == pytest.approx(sign * math.pi * unit**2, rel=COEFFICIENT)
    assert point.criticality == ("subcritical" if sign > 0 else "supercritical")
