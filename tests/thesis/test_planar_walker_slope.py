"""Paper 3: the gait of Table I, and what becomes of it along the slope.

Numbers are verified ones, of two codes that are not contwalk; the run is that of `runs/planar_slope.yaml`.
"""

from __future__ import annotations

import numpy as np
import pytest
from autobalancer_figures import figure_run
from planar_walker_figures import (
    GAIT,
    REFERENCE,
    SLOPE,
    apart,
    assert_alpha,
    before_heel_strike,
    complex_numbers,
    numbers,
    only,
    opening,
)

from contwalk.branch import Branch, SpecialPoint

pytestmark = pytest.mark.thesis

EVENTS = {entry["label"]: entry for entry in SLOPE["events"]}
# Label, kind, name of the margin that is zero there, and what is said of the place.
LIMITS = {
    "up hind dip clearance=0": ("GR", "interior", "hind_dip", "after 'heel_strike', in mode three_link"),
    "down hind dip clearance=0": ("GR", "interior", "hind_dip", "after 'heel_strike', in mode three_link"),
    "down front dip clearance=0": ("GR", "interior", "front_dip", "after 'heel_strike', in mode three_link"),
    "down R_y at knee strike=0": ("AZ", "knee_contact", "knee_contact", "zero at 'knee_strike'"),
    "down Q2 (hind knee) at heel strike=0": (
        "AZ",
        "hind_knee_impulse",
        "hind_knee_impulse",
        "zero at 'heel_strike'",
    ),
    "up v_C2 after heel strike=0": (
        "AZ",
        "trailing_foot_lifts",
        "trailing_foot_lifts",
        "zero at 'heel_strike'",
    ),
}
DOUBLINGS = tuple(SLOPE["period_doublings"].values())


def slope() -> tuple[Branch, ...]:
    return figure_run("planar_slope")


def table_1() -> Branch:
    """Gaits beside Table I's, at an accuracy that leaves the start's own row within the tolerances below.

    A run is solved to a hundred times its accuracy between special points.
    """
    (branch,) = figure_run("planar_slope", "continue.range=[0.089,0.091]", "diagram=none", "accuracy=1e-12")
    return branch


def limit(label: str) -> SpecialPoint:
    kind = LIMITS[label]
    return only(slope()[0], kind[0], kind[1], float(EVENTS[label]["alpha"]))


class TestGait:
    """Table I: alpha = 0.09, the start of the run."""

    def row(self) -> np.void:
        branch = table_1()
        (row,) = branch.points[branch["s"] == 0.0]
        assert row["free"][0] == 0.09
        return row

    def test_state_before_heel_strike(self):
        branch, row = table_1(), self.row()
        found = dict(zip(branch.info.states, row["state"].tolist(), strict=True))
        np.testing.assert_allclose(before_heel_strike(found), numbers(GAIT["x"]), rtol=1e-10)
        # The landing guard (16) is zero, to what it is solved to.
        assert found["q1"] + found["q2"] == pytest.approx(opening(0.123), abs=1e-11)
        assert row["period"] == pytest.approx(float(GAIT["T_step"]), rel=1e-10)

    def test_durations_of_the_two_phases(self):
        """The unknowns: 6 and 4 states, then the duration of the mode with three links and that with two."""
        three, two = self.row()["unknowns"][10:12]
        assert three == pytest.approx(float(GAIT["T_threelink"]), rel=1e-10)
        assert two == pytest.approx(float(GAIT["T_twolink"]), rel=1e-10)

    def test_multipliers_of_the_step(self):
        found, expected = self.row()["spectrum"], complex_numbers(GAIT["multipliers"])
        assert len(found) == 3
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)

    def test_observables(self):
        branch, row = table_1(), self.row()
        found = dict(zip(branch.info.observables, row["observables"].tolist(), strict=True))
        assert found["step_length"] == pytest.approx(float(GAIT["step_length"]), rel=1e-10)
        assert found["speed"] == pytest.approx(
            float(GAIT["step_length"]) / float(GAIT["T_step"]), rel=1e-10
        )  # the mean over a step that repeats
        # 14 decimals are given of what the friction must be.
        assert found["friction_heel"] == pytest.approx(float(GAIT["mu_foot"]), rel=1e-10)
        assert found["friction_knee"] == pytest.approx(float(GAIT["mu_knee"]), rel=1e-10)
        assert found["impulse_heel"] == pytest.approx(float(GAIT["foot_impulse"][1]), rel=1e-10)
        assert found["impulse_knee"] == pytest.approx(float(GAIT["knee_impulse"][1]), rel=1e-10)
        # The least clearance is interpolated between samples, at an instant where its rate is zero.
        assert found["hind_dip"] == pytest.approx(float(GAIT["hind_dip_clearance"]), rel=1e-7)
        assert found["max_abs"] == pytest.approx(abs(row["spectrum"][0]), abs=1e-10)  # of two meshes

    def test_the_paper_reads_the_same_to_its_digits(self):
        """Multipliers by differences of 5e-6, and friction to two digits, cut off."""
        row, paper = self.row(), REFERENCE["paper_values"]
        assert apart(row["spectrum"], complex_numbers(paper["multipliers"])) < 5e-4
        branch = table_1()
        for name, printed in zip(("friction_heel", "friction_knee"), numbers(paper["mu"]), strict=True):
            value = float(row["observables"][branch.info.observables.index(name)])
            assert printed <= value < printed + 0.01

    def test_gait_is_admissible_and_stable(self):
        row = self.row()
        assert row["admissible"]
        assert row["stable"]
        assert row["unstable"] == 0

    def test_flow_maps_its_own_direction_to_nothing(self):
        """A later start on the same step leads to the same strike; to the steps' own error."""
        assert 0.0 <= self.row()["trivial_error"] <= 1e-10


class TestTree:
    @pytest.mark.slow
    def test_one_branch_a_doubling(self):
        branches = slope()
        assert [b.info.problem for b in branches] == ["hybrid_orbit"] * 4
        assert [b.info.origin for b in branches[1:]] == ["b1/PD1", "b2/PD1", "b3/PD1"]
        assert [b.info.parent[0] for b in branches[1:]] == ["b1", "b2", "b3"]
        for number, branch in enumerate(branches):
            assert branch.info.signature == ("heel_strike", "knee_strike") * 2**number
            assert branch.outcome.status in ("complete", "stopped")
            assert branch.outcome.message.endswith(".")
            assert [p.status for p in branch.special_points] == ["located"] * len(branch.special_points)

    def test_a_step_is_half_of_a_whole_period(self):
        """After one step the legs have changed names; after two, four and eight they have not."""
        step, *doubled = slope()
        assert step.info.closure == "legs"
        for point in step.special_points:
            assert point.period_full == 2.0 * point.period
            squares = np.array(point.spectrum) ** 2
            np.testing.assert_allclose(point.spectrum_full, squares, rtol=1e-14)
        for branch in doubled:
            assert branch.info.closure == "full"
            for point in branch.special_points:
                assert point.period_full == point.period

    def test_counts_change_at_fold_and_doublings_only(self):
        for branch in slope():
            for point in branch.special_points:
                changes = abs(point.unstable_after - point.unstable_before)
                assert changes == (1 if point.label in ("LP", "PD") else 0), point.name


class TestFold:
    def test_place(self):
        point = only(slope()[0], "LP")
        assert_alpha(point, SLOPE["fold"]["alpha"])
        assert point.period == pytest.approx(float(SLOPE["fold"]["T"]), rel=1e-9)
        # Along a fold states run with the square root of the parameter: no more than this of 1e-12 is lost.
        np.testing.assert_allclose(before_heel_strike(point.state), numbers(SLOPE["fold"]["x"]), rtol=1e-8)
        assert apart(point.spectrum, complex_numbers(SLOPE["fold"]["ev"])) < 1e-8

    def test_gaits_are_born_there(self):
        branch, point = slope()[0], only(slope()[0], "LP")
        assert branch["alpha"].min() >= point.parameters["alpha"] - point.error
        assert {point.unstable_before, point.unstable_after} == {0, 1}
        # Of the map xi + b mu + a xi^2: for gaits on the upper side a and b have different signs.
        assert point.coefficients["a"] * point.coefficients["b"] < 0.0


@pytest.mark.parametrize("number", range(4))
class TestDoublings:
    def point(self, number: int) -> SpecialPoint:
        return only(slope()[number], "PD")

    def test_place(self, number):
        point = self.point(number)
        assert_alpha(point, DOUBLINGS[number])
        assert point.spectrum[0] == pytest.approx(-1.0, abs=1e-9)
        assert (point.unstable_before, point.unstable_after) == (0, 1)

    def test_criticality_is_that_of_the_branch_that_emanates(self, number):
        """c > 0: the doubled gait lives where the single one is unstable, and is stable there."""
        point = self.point(number)
        assert point.criticality == "supercritical"
        assert point.coefficients["c"] > 0.0
        if number == 3:
            return
        child, at = slope()[number + 1], point.parameters["alpha"]
        assert np.all(child["alpha"] >= at * (1.0 - 1e-9))
        beside = child.points[(child["s"] > 0.0) & ~child["special"]][:2]
        assert np.all(beside["unstable"] == 0)


@pytest.mark.parametrize("number", range(3))
def test_multipliers_beside_a_doubling_are_those_of_its_normal_form(number):
    """-(1 + mu) of the gait and 1 - 4 mu of the doubled one, whatever the coefficient is.

    Slopes at the doubling are those of parabolas and quintics through neighbouring rows, which agree with
    narrower ones to some parts in a thousand.
    """
    fitted = np.polynomial.Polynomial.fit
    parent, child, point = slope()[number], slope()[number + 1], only(slope()[number], "PD")
    at = point.parameters["alpha"]
    rows = [i for i in range(point.index - 8, point.index + 9) if not parent["special"][i]]
    rows = sorted(rows, key=lambda i: abs(i - point.index))[:5]
    distance = np.append(parent["alpha"][rows] - at, 0.0)
    grown = np.append(-1.0 - parent.points["spectrum"][rows].real.min(axis=1), 0.0)
    expected = 4.0 * fitted(distance, grown, 5).deriv()(0.0)
    beside = child.points[(child["s"] > 0.0) & ~child["special"]][:4]
    distance = beside["free"][:, 0] - at
    found = fitted(distance, (1.0 - beside["spectrum"][:, 0].real) / distance, 2)(0.0)
    assert found == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("label", LIMITS)
class TestLimits:
    def test_place(self, label):
        point = limit(label)
        assert_alpha(point, EVENTS[label]["alpha"])
        assert point.period == pytest.approx(float(EVENTS[label]["T"]), rel=1e-9)
        # The run asks for 1e-9; states are of size one, and deviations grow up to six times in a step.
        np.testing.assert_allclose(
            before_heel_strike(point.state), numbers(EVENTS[label]["x"]), rtol=0, atol=6e-9
        )
        expected = complex_numbers(EVENTS[label]["ev"])
        assert apart(point.spectrum, expected) < 1e-9 * max(1.0, abs(expected[0]))

    def test_what_is_said_of_it(self, label):
        point, (_, _, margin, place) = limit(label), LIMITS[label]
        assert f"'{margin}' is" in point.note
        assert place in point.note
        # Margins are in m, N s, N m s and m/s, of size 1e-2 and more.
        assert point.margin[margin] == pytest.approx(0.0, abs=1e-9)
        assert point.criticality is None

    def test_margin_changes_sign_there(self, label):
        branch, point = slope()[0], limit(label)
        name = LIMITS[label][2]
        before, after = branch[name][point.index - 1], branch[name][point.index + 1]
        assert before * after < 0.0


def test_strict_gaits_lie_between_the_two_scuffs_of_the_hind_dip():
    branch = slope()[0]
    low, high = (
        limit(label).parameters["alpha"] for label in ("down hind dip clearance=0", "up hind dip clearance=0")
    )
    upper = branch["unstable"] == 0  # the stable side of the fold
    between = upper & (branch["alpha"] > 0.0660) & (branch["alpha"] < high) & ~branch["special"]
    # Below 0.0660 a friction of mu = 1 at knee strike does not suffice.
    assert between.sum() >= 3
    assert np.all(branch["admissible"][between])
    assert np.all(branch["hind_dip"][upper & (branch["alpha"] > low) & (branch["alpha"] < high)] > -1e-12)
    assert not np.any(branch["admissible"][branch["alpha"] > high * (1.0 + 1e-9)])
    assert not np.any(branch["admissible"][branch["alpha"] < low * (1.0 - 1e-9)])


def test_the_unstable_side_of_the_fold_ends_in_a_grazing_heel_strike():
    branch, expected = slope()[0], SLOPE["grazing_heel_strike_end"]
    point = only(branch, "GR", "terminal")
    assert_alpha(point, expected["alpha"])
    assert point.period == pytest.approx(float(expected["T"]), rel=1e-9)
    # The reference's guard is zero to 2e-14 m there.
    np.testing.assert_allclose(before_heel_strike(point.state), numbers(expected["x"]), rtol=1e-8)
    assert apart(point.spectrum, complex_numbers(expected["ev"])) < 1e-8 * 45.0
    # It is told from knee strike on; the reference counts from heel strike.
    seconds = float(point.note.split("touched ")[1].split(" s ")[0])
    three = branch.unknowns(point.index)[10]
    assert three + seconds == pytest.approx(float(expected["t_graze"]), abs=1e-8)
    (end,) = [p for p in branch.special_points if p.kind == "grazing"]
    assert end.parameters["alpha"] == point.parameters["alpha"]
    assert end.index == point.index
