"""Figs 12, 14 and 15: the Hopf point of the balanced rotor and four period doublings, for three accuracies.

Numbers are verified values: those of the source, except where a comment says otherwise.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from autobalancer_figures import figure_run

from contwalk.branch import Branch, SpecialPoint
from contwalk.plugin_check.traced import Traced, vector_form
from contwalk.system import load_system

pytestmark = pytest.mark.thesis

ACCURACIES = (1e-6, 1e-8, 1e-10)
HOPF, FREQUENCY, L1 = 0.0060721205237529744, 0.49169541423201135, -0.234204779330787
# Parameter and period of each doubling, to the digits known.
DOUBLINGS = (
    (0.00326757880587, 14.030990726),
    (0.00305875641347, 28.2193541082),
    (0.00302990131111, 56.5073059487),
    (0.00302521443315, None),
)
# One unit of the last digit known of the parameters and periods above.
DIGIT, PERIOD_DIGIT = 1e-14, 1e-9
# Half the peak-to-peak swing of each mass over sqrt(HB - delta), towards the Hopf point.
SWINGS = {"swing1": 14.83501379, "swing2": 14.27642698}
# The leading multipliers to 10 decimals. The source has 0.0305666458 for the pair at 0.0055; the test
# `test_multipliers_by_another_integrator` computes it by an integrator of its own.
MULTIPLIERS = {
    0.0055: (0.798170057, complex(0.0305664579, 0.0528558163), complex(0.0305664579, -0.0528558163)),
    0.0045: (complex(0.206096993, 0.357336599), complex(0.206096993, -0.357336599), 0.0375742183),
    0.0035: (complex(-0.500897318, 0.412309792), complex(-0.500897318, -0.412309792), 0.0326351469),
}


def cascade(accuracy: float) -> tuple[Branch, ...]:
    return figure_run("autobalancer_cascade", f"accuracy={accuracy}")


def only(branch: Branch, label: str) -> SpecialPoint:
    (point,) = [p for p in branch.special_points if p.label == label]
    return point


@pytest.mark.parametrize(
    "accuracy", [ACCURACIES[1], *(pytest.param(a, marks=pytest.mark.long) for a in ACCURACIES[::2])]
)
class TestCascade:
    def test_the_tree_is_one_equilibrium_and_four_orbits(self, accuracy):
        branches = cascade(accuracy)
        assert [b.info.problem for b in branches] == ["equilibrium", *["periodic_orbit"] * 4]
        assert [b.info.origin.split("/")[-1] for b in branches[1:]] == ["HB1", "PD1", "PD1", "PD1"]
        assert [b.info.parent[0] for b in branches[1:]] == ["b1", "b2", "b3", "b4"]
        for branch in branches:
            assert branch.outcome.status == "complete"
            found = [p for p in branch.special_points if p.label not in ("EP", "UZ")]
            assert [p.status for p in found] == ["located"]

    def test_the_hopf_point(self, accuracy):
        hopf = only(cascade(accuracy)[0], "HB")
        assert abs(hopf.parameters["delta"] - HOPF) <= accuracy * HOPF
        assert hopf.parameters["delta"] == pytest.approx(HOPF, rel=1e-14)  # refined beyond the request
        assert hopf.coefficients["omega"] == pytest.approx(FREQUENCY, rel=1e-13)
        assert hopf.coefficients["l1"] == pytest.approx(L1, rel=1e-6)
        assert hopf.criticality == "supercritical"

    @pytest.mark.parametrize("number", range(4))
    def test_doublings_within_the_accuracy_requested(self, accuracy, number):
        delta, period = DOUBLINGS[number]
        point = only(cascade(accuracy)[number + 1], "PD")
        off = abs(point.parameters["delta"] - delta)
        assert off <= accuracy * delta + DIGIT
        assert off <= point.error + DIGIT, (off, point.error)
        assert point.error <= accuracy * delta
        if period is not None:
            assert abs(point.period - period) <= accuracy * period + PERIOD_DIGIT

    @pytest.mark.parametrize("number", range(4))
    def test_criticality_is_that_of_the_branch_that_emanates(self, accuracy, number):
        parent, point = cascade(accuracy)[number + 1], only(cascade(accuracy)[number + 1], "PD")
        assert point.criticality == "supercritical"
        assert point.coefficients["c"] > 0.0
        assert {point.unstable_before, point.unstable_after} == {0, 1}
        assert np.all(parent["unstable"][parent["delta"] < point.parameters["delta"]] == 1)
        if number == 3:
            return
        child, at = cascade(accuracy)[number + 2], point.parameters["delta"]
        assert np.all(child["delta"] <= at * (1.0 + accuracy))
        # Up to the next doubling; how many rows lie before it is a matter of step lengths.
        next_one = only(child, "PD")
        before = (child["delta"] < at * (1.0 - accuracy)) & (child["delta"] > next_one.parameters["delta"])
        beside = child.points[~child["special"] & before]
        assert len(beside) >= 1
        assert np.all(beside["unstable"] == 0), "a stable orbit beside the unstable one: supercritical"
        assert next_one.unstable_before == 0
        # Twice the parent's period, which near by is as far off as the distance from the doubling.
        distance = 1.0 - float(beside["free"][0, 0]) / at
        assert beside["period"][0] == pytest.approx(2.0 * point.period, rel=distance)

    def test_stability_changes_at_the_doublings_only(self, accuracy):
        for number, branch in enumerate(cascade(accuracy)[1:]):
            # At its birth an orbit is its parent, or an equilibrium: a multiplier is 1 there.
            delta, regular = DOUBLINGS[number][0], ~branch["special"] & (branch["s"] > 0.0)
            above = regular & (branch["delta"] > delta)
            assert np.all(branch["unstable"][above] == 0)
            assert np.all(branch["unstable"][regular & ~above] == 1)

    @pytest.mark.parametrize("delta", MULTIPLIERS)
    def test_multipliers_at_marks(self, accuracy, delta):
        orbit = cascade(accuracy)[1]
        (point,) = [p for p in orbit.special_points if p.label == "UZ" and p.parameters["delta"] == delta]
        found = np.array(point.spectrum[:3])
        assert found == pytest.approx(np.array(MULTIPLIERS[delta]), abs=1e-8)
        assert np.array_equal(orbit.points["spectrum"][point.index], np.array(point.spectrum))

    def test_the_flow_carries_its_own_velocity_round(self, accuracy):
        """An independent measure of the orbits; walked points are a hundred times coarser."""
        for branch in cascade(accuracy)[1:]:
            assert only(branch, "PD").trivial_error <= accuracy
            regular = ~branch["special"] & (branch["s"] > 0.0)
            assert np.all(branch["trivial_error"][regular] <= 100.0 * accuracy)


@pytest.mark.parametrize("name", SWINGS)
def test_the_amplitude_law_near_the_hopf_point(name):
    """Half the swing over sqrt(HB - delta), as a parabola in HB - delta, at zero."""
    orbit = cascade(1e-10)[1]
    distance = HOPF - orbit["delta"]
    # Nearer ones have lost digits of the difference; farther ones need more than a parabola.
    near = (distance > 1e-6) & (distance < 1.5e-4) & ~orbit["special"]
    assert near.sum() >= 4
    law = np.polynomial.Polynomial.fit(distance[near], orbit[name][near] / np.sqrt(distance[near]), 2)
    # 512 samples a period miss a peak by up to (pi / 512)^2 / 2 of the swing.
    assert law(0.0) == pytest.approx(SWINGS[name], rel=3e-5)


def test_orbits_of_three_accuracies_are_one():
    """Periods at the marks differ by no more than the coarser run was asked for."""
    periods = {
        accuracy: [p.period for p in cascade(accuracy)[1].special_points if p.label == "UZ"]
        for accuracy in ACCURACIES
    }
    for coarse, fine in ((1e-6, 1e-10), (1e-8, 1e-10)):
        assert periods[coarse] == pytest.approx(periods[fine], rel=coarse)


@cache
def monodromy(delta: float, steps: int) -> np.ndarray:
    """Flow derivative once round, by the classical method of order 4 with exact Jacobians.

    Stored state and period are those of the orbit; nothing of the program's integrators is used.
    """
    orbit = cascade(1e-10)[1]
    (point,) = [p for p in orbit.special_points if p.label == "UZ" and p.parameters["delta"] == delta]
    system = load_system("autobalancer", {"masses": 2})
    field = Traced(system.modes[0].field, system, vector_form(system, "field", "dx"))
    values = [point.parameters[name] for name in system.parameter_names]
    x, h = np.array(list(point.state.values())), point.period / steps
    n = len(x)
    y = np.column_stack([x, np.eye(n)])

    def rates(y: np.ndarray) -> np.ndarray:
        f = field.values(0.0, y[:, 0], values)
        return np.column_stack([f, field.slopes(0.0, y[:, 0], values)[:, 1:] @ y[:, 1:]])

    for _ in range(steps):
        k1 = rates(y)
        k2 = rates(y + 0.5 * h * k1)
        k3 = rates(y + 0.5 * h * k2)
        k4 = rates(y + h * k3)
        y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return y


def test_multipliers_by_another_integrator():
    """Extrapolated from two step lengths: of order 5, and 1e-10 by the next term."""
    coarse, fine = monodromy(0.0055, 2000), monodromy(0.0055, 4000)
    y = fine + (fine - coarse) / 15.0
    assert np.abs(y[:, 0] - np.array(_start(0.0055))).max() < 1e-9, "the stored orbit closes"
    found = np.linalg.eigvals(y[:, 1:])
    for expected in (1.0, *MULTIPLIERS[0.0055]):
        assert np.abs(found - expected).min() < 1e-9


def _start(delta: float) -> list[float]:
    orbit = cascade(1e-10)[1]
    (point,) = [p for p in orbit.special_points if p.label == "UZ" and p.parameters["delta"] == delta]
    return list(point.state.values())


def test_accuracy_costs_what_it_says():
    """Each two digits more take more right-hand sides, and the orbits of one run are counted."""
    spent = [sum(b.cost["rhs"] for b in cascade(accuracy)[1:4]) for accuracy in ACCURACIES]
    assert all(math.isfinite(n) and n > 0 for n in spent)
    assert spent[2] > spent[1] > 0.9 * spent[0]
