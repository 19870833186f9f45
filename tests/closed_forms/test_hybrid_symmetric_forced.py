"""Forced machines whose orbits are their own images half a cycle later: where they lose that symmetry."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from forced_mirrors import BLOCK_R, OMEGA, block, breaking, half, pair, spring_between_stops
from hybrid_runs import ACCURACY, assert_met, diagram, solution

from contwalk.branch import Branch

# Machine, half periods of the forcing in half a cycle, a value with a symmetric orbit, and a range around
# the value at which the symmetry is lost.
CASES = {"block": (True, 3, 2.8, (2.5, 3.6)), "pair": (False, 1, 12.0, (11.0, 22.0))}


def start(name: str) -> tuple[list[float], dict[str, float], str]:
    rocks, n, beta, _ = CASES[name]
    state = half(beta, n, rocks).at_zero
    return list(state), {"beta": beta}, ("right" if state[0] > 0.0 else "left") if rocks else "free"


@cache
def walked(name: str, accuracy: float = ACCURACY) -> list[Branch]:
    state, values, mode = start(name)
    system = block() if name == "block" else pair()
    range_ = CASES[name][3]
    return diagram(system, "beta", range_, state, values, mode=mode, follow=("BP",), accuracy=accuracy)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", CASES)
def test_half_a_cycle_is_walked(name: str) -> None:
    (parent, *_), (_, n, _, _) = walked(name), CASES[name]
    assert parent.info.closure == "inversion"
    assert len(parent.info.signature) == 1
    assert parent.info.subharmonic == n  # of the whole cycle
    # The closure lasts n half periods at every point: an equation without error.
    assert np.allclose(parent["period"], n * np.pi / OMEGA, rtol=1e-13)


@pytest.mark.parametrize("name", CASES)
def test_velocities_and_multipliers_are_the_closed_form(name: str) -> None:
    rocks, n, *_ = CASES[name]
    parent = walked(name)[0]
    for k in range(0, len(parent), 5):
        own = half(float(parent["beta"][k]), n, rocks)
        # Unknowns: state at the start, duration, time of the start. Walked to a hundred times the accuracy.
        assert abs(abs(parent.unknowns(k)[1]) - own.v) < 100.0 * ACCURACY * own.v
        largest = np.abs(np.linalg.eigvals(own.jacobian)).max()
        found = np.abs(parent.points["spectrum"][k]).max()
        # Near the point where two meet: the root of what states are known to.
        assert abs(found - largest) < 1e-5


@pytest.mark.parametrize("name", CASES)
def test_max_abs_is_that_of_the_whole_cycle(name: str) -> None:
    """A deviation is multiplied twice, once in each half."""
    parent = walked(name)[0]
    of_the_half = np.abs(parent.points["spectrum"]).max(axis=1)
    np.testing.assert_array_max_ulp(parent["max_abs"], of_the_half**2, 2)  # a power, and a product


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("accuracy", [ACCURACY, 1e-6])
def test_symmetry_is_lost_where_a_multiplier_of_the_half_is_minus_one(name: str, accuracy: float) -> None:
    rocks, n, beta, range_ = CASES[name]
    parent = walked(name, accuracy)[0]
    (point,) = [p for p in parent.special_points if p.label != "EP"]
    assert (point.label, point.kind) == ("BP", "symmetry-breaking")
    assert_met(point, "beta", breaking(n, rocks, beta, range_[1]), accuracy)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("accuracy", [ACCURACY, 1e-6])
def test_both_halves_of_the_branch_without_symmetry_are_walked_and_mirror_each_other(
    name: str, accuracy: float
) -> None:
    _, child = walked(name, accuracy)
    assert all(p.status == "located" for p in child.special_points), child.special_points
    ends = [p for p in child.special_points if p.label == "EP"]
    assert len(ends) == 2
    first, last = (child.special(p.name).parameters["beta"] for p in ends)
    assert abs(first - last) < 100.0 * accuracy * first
    # Durations of the two legs change places from one half of the branch to the other.
    legs = child.points["unknowns"][:, 4:6]
    assert np.allclose(legs[0], legs[-1, ::-1], rtol=100.0 * accuracy)
    assert abs(legs[0, 0] - legs[0, 1]) > 0.1 * legs[0].sum()


@pytest.mark.drawn(1)
@pytest.mark.parametrize("accuracy", [ACCURACY, 1e-6])
def test_an_inversion_that_nobody_declared_makes_a_pitchfork_with_two_halves(accuracy: float) -> None:
    state, values, mode = start("block")
    system, (rocks, n, beta, range_) = block(declared=False), CASES["block"]
    found = diagram(system, "beta", range_, state, values, mode=mode, follow=("BP",), accuracy=accuracy)
    parent, child = found
    assert parent.info.closure == "full"
    (point,) = [p for p in parent.special_points if p.label != "EP"]
    assert (point.label, point.kind) == ("BP", "pitchfork")
    assert_met(point, "beta", breaking(n, rocks, beta, range_[1]), accuracy)
    # Nothing is made up beside the pitchfork, and neither half goes back along the parent.
    assert [p.label for p in child.special_points if p.label not in ("EP", "GR")] == []
    assert np.all(np.diff(child["beta"][child["s"] >= 0.0]) > 0.0)
    assert np.all(np.diff(child["beta"][child["s"] <= 0.0]) < 0.0)


def test_a_push_that_spoils_the_symmetry_keeps_the_orbit_whole() -> None:
    state, values, mode = start("block")
    # Motions miss their images by about what the push is, far less than what a near return may miss by.
    problem, z = solution(block(bias=1e-4), "beta", state, values, mode=mode)
    assert problem.whole == ("full", 1)
    first, second = z[problem.layout.durations]
    assert first + second == pytest.approx(3.0 * 2.0 * np.pi / OMEGA, rel=1e-13)
    assert 1e-6 < abs(first - second) < 1e-2  # about as much as it is pushed
    assert problem.values_of(z)["r"] == BLOCK_R


def test_the_only_impact_of_a_half_ceases_where_the_linear_motion_touches_both_stops() -> None:
    found = diagram(
        spring_between_stops(),
        "beta",
        (0.1, 1.0),
        [0.0, 0.5],
        events={"GR": "switch"},
        follow=("GR",),
        direction="down",
        until="settled",
        max_step=0.3,
    )
    impacts, quiet = found
    assert (impacts.info.closure, len(impacts.info.signature)) == ("inversion", 1)
    (grazing,) = [p for p in impacts.special_points if p.label == "GR"]
    # |1 - omega^2 + 0.2 i omega| is the force that moves the mass by 1.
    assert_met(grazing, "beta", abs(1.0 - 0.8**2 + 0.2j * 0.8))
    assert (quiet.info.signature, quiet.info.closure, quiet.info.subharmonic) == ((), "full", 1)


@pytest.mark.drawn
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("value", [0.1, -0.3])
def test_a_place_in_the_half_that_is_an_image_is_told_as_its_image(name: str, value: float) -> None:
    """What passes a value on its way up in one half passes its negative on its way down in the other."""
    state, values, mode = start(name)
    system = block() if name == "block" else pair()
    problem, z = solution(system, "beta", state, values, mode=mode)
    up, down = (
        problem.varied(
            discretization=replace(problem.discretization, report_at=(0, sign * value, sign))
        ).reported(z)
        for sign in (1.0, -1.0)
    )
    assert up[0] == pytest.approx(value, abs=1e-13)  # stepped to, by the secant method
    assert up == pytest.approx(-down, abs=1e-12)  # its rounding, times velocities and accelerations
