"""Paper 3, Fig. 5: multipliers, impulse and friction as the feet shrink.

The feet are rf = 0.12 - 0.11 s and lf = 0.123 - 0.018 s.

Numbers are verified ones, of two codes that are not contwalk; the run is that of `runs/planar_feet.yaml`.
"""

from __future__ import annotations

import numpy as np
import pytest
from autobalancer_figures import figure_run
from planar_walker_figures import FEET, apart, before_heel_strike, complex_numbers, numbers, opening

from contwalk.branch import Branch

pytestmark = pytest.mark.thesis

POINTS = FEET["points"]
# Numbers of the reference that have fewer digits than a double: 8 decimals, and 12 digits.
FRICTION, IMPULSE = 1e-8, 1e-11


def feet() -> Branch:
    (branch,) = figure_run("planar_feet")
    return branch


def row_of(number: int) -> np.void:
    """The row of a point of the figure: marked, or an end of the range."""
    branch = feet()
    value = number / 11.0
    (found,) = (
        p
        for p in branch.special_points
        if p.label in ("UZ", "EP") and abs(float(branch["path"][p.index]) - value) < 1e-12
    )
    assert found.status == "located"
    return branch.points[found.index]


def test_gait_is_followed_from_large_to_small_feet():
    branch = feet()
    assert branch.info.problem == "hybrid_orbit"
    assert branch.info.free == ("path",)
    assert branch.info.signature == ("heel_strike", "knee_strike")
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "bound")
    assert (branch["path"].min(), branch["path"].max()) == (0.0, 1.0)


def test_gait_is_stable_throughout():
    """As the paper says; so there is no bifurcation."""
    branch = feet()
    assert np.all(branch["unstable"] == 0)
    assert {p.label for p in branch.special_points} <= {"EP", "UZ", "GR", "AZ"}


@pytest.mark.parametrize("number", range(12))
class TestPoints:
    def test_parameters(self, number):
        branch, row, point = feet(), row_of(number), POINTS[number]
        s = float(row["free"][0])
        named = {p.index: p for p in branch.special_points}
        found = named[int(np.flatnonzero(branch["path"] == s)[-1])].parameters
        assert found["rf"] == pytest.approx(float(point["rf"]), abs=1e-16)
        assert found["lf"] == pytest.approx(float(point["lf"]), abs=1e-16)

    def test_state(self, number):
        branch, row, point = feet(), row_of(number), POINTS[number]
        state = dict(zip(branch.info.states, row["state"].tolist(), strict=True))
        np.testing.assert_allclose(before_heel_strike(state), numbers(point["x"]), rtol=1e-10)
        lf = float(point["lf"])
        assert state["q1"] + state["q2"] == pytest.approx(opening(lf), abs=1e-11)
        assert row["period"] == pytest.approx(float(point["T"]), rel=1e-10)

    def test_multipliers(self, number):
        row, point = row_of(number), POINTS[number]
        expected = complex_numbers(point["ev"])
        assert len(row["spectrum"]) == 3
        assert apart(row["spectrum"], expected) < 1e-9
        # Of all pairs, the nearest real ones or the complex one.
        assert np.sum(expected.imag != 0.0) == np.sum(row["spectrum"].imag != 0.0)

    def test_observables(self, number):
        branch, row, point = feet(), row_of(number), POINTS[number]
        found = dict(zip(branch.info.observables, row["observables"].tolist(), strict=True))
        assert found["step_length"] == pytest.approx(float(point["step_length"]), rel=1e-10)
        assert found["impulse_heel"] == pytest.approx(float(point["Ry_foot"]), abs=IMPULSE * 5.0)
        assert found["friction_heel"] == pytest.approx(float(point["mu_foot"]), abs=FRICTION)
        assert found["friction_knee"] == pytest.approx(float(point["mu_knee"]), abs=FRICTION)


def test_impulse_falls_along_the_path():
    """ "No dramatic change over the interval": by a quarter, without a turn."""
    branch = feet()
    impulse = branch["impulse_heel"][np.argsort(branch["path"])]
    assert np.all(np.diff(impulse) <= 1e-12)
    assert 0.75 < impulse[-1] / impulse[0] < 0.8


class TestSplit:
    """Near the most stable gait a pair of complex multipliers turns real."""

    def test_place(self):
        branch, (expected,) = feet(), FEET["complex_to_real"]
        (point,) = [p for p in branch.special_points if p.label == "UZ" and p.kind == "observable"]
        assert point.status == "located"
        s = float(branch["path"][point.index])
        # The reference bisected until the pair was apart by 1e-7.
        assert s == pytest.approx(float(expected["s"]), abs=1e-7)
        assert abs(s - float(expected["s"])) <= point.error + 1e-13
        np.testing.assert_allclose(before_heel_strike(point.state), numbers(expected["x"]), rtol=1e-10)
        # A difference of two multipliers is the square root of what they depend on smoothly.
        assert apart(point.spectrum, complex_numbers(expected["ev"])) < 1e-6
        assert point.parameters["rf"] == pytest.approx(float(expected["rf"]), abs=1e-8)

    def test_pair_is_real_before_and_complex_after(self):
        branch, (expected,) = feet(), FEET["complex_to_real"]
        real = np.all(branch.points["spectrum"].imag == 0.0, axis=1)
        s = float(expected["s"])
        assert np.all(real[branch["path"] < s - 1e-6])
        assert not np.any(real[branch["path"] > s + 1e-6])

    def test_observable_is_the_signed_square_of_the_difference(self):
        branch = feet()
        for row in branch.points[:: len(branch) // 10]:
            values = row["spectrum"]
            pairs = [(a - b) ** 2 for i, a in enumerate(values) for b in values[i + 1 :]]
            own = float(row["observables"][branch.info.observables.index("split")])
            complex_ones = [
                p for p, (a, b) in zip(pairs, _pairs(values), strict=True) if a == b.conjugate() and a.imag
            ]
            expected = complex_ones[0].real if complex_ones else min(p.real for p in pairs)
            assert own == pytest.approx(expected, abs=1e-9)
            assert (own < 0.0) == bool(complex_ones)


def _pairs(values: np.ndarray) -> list[tuple[complex, complex]]:
    return [(a, b) for i, a in enumerate(values) for b in values[i + 1 :]]


def test_most_stable_gait_is_near_there():
    """The paper: maximum stability at rf of about 0.05 m, where the largest modulus is least."""
    branch = feet()
    at = int(np.argmin(branch["max_abs"]))
    rf = 0.12 - 0.11 * float(branch["path"][at])
    assert rf == pytest.approx(0.05, abs=0.005)
