"""The cycle of the Stuart-Landau equation: amplitude, period and multiplier in closed form."""

import math

import numpy as np
import pytest
from invariants import check_branch, check_orbit_branch
from orbit_systems import ACCURACY, orbits, stuart_landau
from small_systems import bifurcations, labelled

import contwalk as cw

# Along a branch local errors are 100 times the accuracy of special points (Discretization.walking); those
# of some
# ten steps a round add up, and a neutral multiplier's cycle (small mu) sums them over 1 / (2 mu T) rounds.
WALKED = 100.0 * ACCURACY

# Rotation by an arbitrary angle, a shear, unequal units, and a cycle that is small beside its place.
COORDINATES = {
    "plain": ((1.0, 0.0, 0.0, 1.0), (0.0, 0.0)),
    "rotated": ((math.cos(1.1), -math.sin(1.1), math.sin(1.1), math.cos(1.1)), (0.0, 0.0)),
    "sheared": ((1.0, 0.7, -0.2, 0.4), (0.0, 0.0)),
    "units": ((1e-6, 0.0, 0.0, 1e5), (0.0, 0.0)),
    "offset": ((1.0, 0.0, 0.0, 1.0), (30.0, -200.0)),
    "all": ((2e-3, -1e-3, 40.0, 300.0), (1.0, -2e3)),
}


def assert_rows(branch, matrix, offset):
    a, b, c, d = matrix
    for row in branch.points:
        mu = float(row["free"][0])
        if mu < 1e-3:  # near the Hopf point: see the test of its own
            continue
        u, v = row["state"] - np.array(offset)
        re, im = np.linalg.solve([[a, b], [c, d]], [u, v])
        period = 2.0 * math.pi / (2.0 + 0.5 * mu)
        # What one round does not contract is summed up: deviations are 1 / (1 - multiplier) times larger.
        gathered = 1.0 / -math.expm1(-2.0 * mu * period)
        assert re**2 + im**2 == pytest.approx(mu, rel=3.0 * WALKED * gathered)
        assert row["period"] == pytest.approx(period, rel=3.0 * WALKED * gathered)
        multiplier = math.exp(-2.0 * mu * period)
        assert row["spectrum"].shape == (1,)
        assert row["spectrum"][0].imag == 0.0
        true = abs(row["spectrum"][0].real - multiplier)
        assert true <= row["spectrum_error"]
        assert true <= 10.0 * WALKED


@pytest.mark.long
@pytest.mark.parametrize("name", COORDINATES)
def test_the_cycle_in_any_coordinates(name):
    matrix, offset = COORDINATES[name]
    problem = orbits(stuart_landau(matrix, offset), "mu")
    start = np.array(offset) + np.array(matrix).reshape(2, 2) @ [1.0, 0.0]
    branch = cw.continue_branch(problem, start, (0.05, 3.0), period=2.0 * math.pi / 2.5)
    check_orbit_branch(branch, problem, every=10)
    assert branch.outcome.reason == "bound"
    assert not bifurcations(branch)
    assert sorted([branch["mu"][0], branch["mu"][-1]]) == [0.05, 3.0]
    assert_rows(branch, matrix, offset)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ["plain", "sheared", "all"])
def test_the_cycle_born_at_the_hopf_point(name):
    matrix, offset = COORDINATES[name]
    system = stuart_landau(matrix, offset, mu=-0.5)
    chosen = cw.Discretization(accuracy=ACCURACY)
    problem = cw.Equilibrium(system, system.defaults(), "mu", discretization=chosen)
    rest = cw.continue_branch(problem, list(offset), (-1.0, 1.0))
    check_branch(rest, problem, np.abs(matrix).reshape(2, 2).max(axis=1))
    (hopf,) = bifurcations(rest)
    branch = cw.switch_branch(problem, rest, "HB1", (-1.0, 2.0))
    check_orbit_branch(branch, problem, every=10)
    assert branch.info.parent == (rest.name, hopf.s)
    assert not bifurcations(branch)
    # The branch begins at the Hopf point itself and goes one way: the other half is the same cycles.
    assert branch["s"][0] == 0.0
    assert branch["mu"][0] == pytest.approx(0.0, abs=1e-12)
    assert branch["mu"][-1] == 2.0
    assert np.all(np.diff(branch["mu"]) > 0.0)
    assert branch["period"][0] == pytest.approx(math.pi, rel=1e-10)
    assert_rows(branch, matrix, offset)


@pytest.mark.long
def test_amplitudes_next_to_the_hopf_point():
    """The branch is a parabola there: mu = |z|^2 to the part of the local errors that one cycle gathers."""
    system = stuart_landau(mu=-0.5)
    problem = cw.Equilibrium(
        system, system.defaults(), "mu", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    rest = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    branch = cw.switch_branch(problem, rest, "HB1", (-1.0, 0.3))
    for row in branch.points[1:]:
        square, mu = float(row["state"] @ row["state"]), float(row["free"][0])
        # A round multiplies the amplitude by exp((mu - |z|^2) T): local errors, not relative to mu, tell
        # them apart.
        assert abs(square - mu) <= 3.0 * WALKED
        assert row["unstable"] == 0


@pytest.mark.long
def test_the_requested_accuracy_is_that_of_a_mark():
    """A mark is a located point: its orbit is as accurate as was asked for, whatever the walk's is."""
    for accuracy in (1e-5, 1e-7, 1e-10):
        problem = orbits(stuart_landau(), "mu", accuracy)
        branch = cw.continue_branch(
            problem, [1.0, 0.0], (0.5, 2.5), period=2.0 * math.pi / 2.5, marks={"mu": [2.0]}
        )
        (mark,) = labelled(branch, "UZ")
        assert mark.parameters["mu"] == 2.0
        assert mark.period == pytest.approx(2.0 * math.pi / 3.0, rel=accuracy)
        assert math.hypot(*mark.state.values()) == pytest.approx(math.sqrt(2.0), rel=accuracy)


@pytest.mark.long
def test_a_mark_of_the_largest_modulus():
    """max_abs = exp(-4 pi mu / (2 + mu / 2)) is 1/10 at mu = 2 L / (4 pi - L / 2), L = ln 10."""
    problem = orbits(stuart_landau(), "mu")
    branch = cw.continue_branch(
        problem, [1.0, 0.0], (0.1, 2.0), period=2.0 * math.pi / 2.5, marks={"max_abs": [0.1]}
    )
    check_orbit_branch(branch, problem, every=20)
    (mark,) = labelled(branch, "UZ")
    level = math.log(10.0)
    assert mark.parameters["mu"] == pytest.approx(
        2.0 * level / (4.0 * math.pi - 0.5 * level), rel=10 * ACCURACY
    )
