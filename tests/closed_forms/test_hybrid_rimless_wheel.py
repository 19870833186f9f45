"""The rimless wheel in closed form, up to the slope at which it just gets over a spoke.

Just after an impact omega^2 = eta^2 / (1 - eta^2) 4 lambda2 (g / l) sin(a) sin(gamma), and between impacts
energy is kept. The multiplier is eta^2. Where omega is zero over the foot, the time over it is infinite: a
homoclinic orbit.
"""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from contwalk_systems.rimless_wheel import SYSTEM
from hybrid_invariants import check_hybrid_branch
from hybrid_runs import ACCURACY, branch_of
from scipy.integrate import quad

from contwalk.branch import Branch

WHEEL = json.loads(
    (Path(__file__).resolve().parents[1] / "thesis/planar_walker_reference.json").read_text(encoding="utf-8")
)["rimless_wheel"]
# Long periods need many steps.
TO_THE_END = ("0.1_n8_lam2_1", "0.2_n6_lam2_1")
CASES = {name: case for name, case in WHEEL["cases"].items() if isinstance(case, dict)}
WALKED = 100.0 * ACCURACY
# Deviations grow over the foot as exp(t): up to this period a walked point keeps four digits and more.
LONGEST = 8.0


def parameters_of(name: str) -> dict[str, float]:
    """Parameters of a case, which its name tells: slope, number of spokes, lambda^2."""
    slope, spokes, lambda2 = name.split("_", 2)
    return {
        "g": 1.0,
        "l": 1.0,
        "gamma": float(slope),
        "a": math.pi / int(spokes[1:]),
        "lambda2": float(lambda2.removeprefix("lam2_")),
    }


@cache
def rolling(name: str) -> Branch:
    """From the case's slope to steeper ones, and in two cases to where the wheel just gets over a spoke."""
    p = parameters_of(name)
    before = [p["gamma"] + p["a"], float(CASES[name]["wminus"])]
    low = 0.01 if name in TO_THE_END else 0.95 * p["gamma"]
    return branch_of(SYSTEM, "gamma", (low, 0.4), before, p, event="heel_strike", events={"GR": "ignore"})


def kept(name: str) -> float:
    p = parameters_of(name)
    return 1.0 - p["lambda2"] * (1.0 - math.cos(2.0 * p["a"]))


def speed_after(name: str, gamma: np.ndarray) -> np.ndarray:
    p, eta2 = parameters_of(name), kept(name) ** 2
    return np.sqrt(eta2 / (1.0 - eta2) * 4.0 * p["lambda2"] * np.sin(p["a"]) * np.sin(gamma))


def least_slope(name: str) -> float:
    """Where the wheel just gets over a spoke, by bisection of the closed form."""
    p = parameters_of(name)

    def over(gamma: float) -> float:
        return float(speed_after(name, np.array(gamma))) ** 2 - 2.0 * p["lambda2"] * (
            1.0 - math.cos(p["a"] - gamma)
        )

    low, high = 0.0, p["a"]
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if over(middle) < 0.0 else (low, middle)
    return high


def duration(name: str, gamma: float) -> float:
    """Time between impacts: the integral of 1 / omega over theta."""
    p, first = parameters_of(name), float(speed_after(name, np.array(gamma)))
    start = gamma - p["a"]

    def slowness(theta: float) -> float:
        return 1.0 / math.sqrt(first**2 + 2.0 * p["lambda2"] * (math.cos(start) - math.cos(theta)))

    # It has a peak where the spoke stands upright.
    return sum(
        quad(slowness, *ends, epsabs=1e-13, epsrel=1e-12, limit=200)[0]
        for ends in ((start, 0.0), (0.0, gamma + p["a"]))
    )


def test_the_least_slope_is_that_of_the_reference():
    for name, key in (("0.1_n8_lam2_1", "gamma_min_n8"), ("0.2_n6_lam2_1", "gamma_min_n6")):
        assert least_slope(name) == pytest.approx(float(WHEEL["cases"][key]), rel=1e-14)


@pytest.mark.parametrize("name", CASES)
class TestRolling:
    def test_reference_case(self, name):
        branch, case = rolling(name), CASES[name]
        (row,) = branch.points[branch["s"] == 0.0]
        assert branch.info.signature == ("heel_strike",)
        assert branch.info.closure == "full"
        # A start is solved to a hundred times the accuracy.
        assert row["period"] == pytest.approx(float(case["T"]), rel=WALKED)
        assert row["state"][1] == pytest.approx(float(case["wminus"]), rel=WALKED)
        assert row["unknowns"][1] == pytest.approx(float(case["wplus"]), rel=WALKED)
        assert row["spectrum"][0] == pytest.approx(float(case["mult"]), abs=WALKED)
        names = branch.info.observables
        assert row["observables"][names.index("step_length")] == pytest.approx(float(case["step"]), rel=1e-14)
        speed = float(case["step"]) / float(case["T"])
        assert row["observables"][names.index("speed")] == pytest.approx(speed, rel=WALKED)

    def test_speed_multiplier_and_period_along_the_branch(self, name):
        branch, p = rolling(name), parameters_of(name)
        chosen = branch.points[branch["period"] < LONGEST]
        assert len(chosen) > 20
        gamma, period = chosen["free"][:, 0], chosen["period"]
        known = WALKED * np.exp(period)
        first = speed_after(name, gamma)
        assert np.all(np.abs(chosen["unknowns"][:, 0] - (gamma - p["a"])) <= known)
        assert np.all(np.abs(chosen["unknowns"][:, 1] / first - 1.0) <= known)
        assert np.all(np.abs(chosen["state"][:, 1] * kept(name) / first - 1.0) <= known)
        assert np.all(np.abs(chosen["spectrum"][:, 0] - kept(name) ** 2) <= known)
        expected = [duration(name, g) for g in gamma]
        assert np.all(np.abs(period - expected) <= known * period)

    def test_rolling_is_always_stable(self, name):
        branch = rolling(name)
        assert np.all(branch["unstable"] == 0)
        assert [p.label for p in branch.special_points if p.label not in ("EP", "AZ", "GR")] == []

    def test_contact_is_lost_where_the_normal_force_vanishes(self, name):
        """Just before an impact, where the wheel is fastest and its spoke most inclined."""
        branch, p = rolling(name), parameters_of(name)
        (point,) = [q for q in branch.special_points if q.label in ("AZ", "GR")]

        def force(gamma: float) -> float:
            theta, omega = gamma + p["a"], float(speed_after(name, np.array(gamma))) / kept(name)
            tangential = p["lambda2"] * math.sin(theta) * math.sin(p["a"])
            return math.cos(gamma) - tangential - omega**2 * math.cos(p["a"])

        gamma = point.parameters["gamma"]
        assert "contact_lost" in point.note
        slope = (force(gamma + 1e-6) - force(gamma - 1e-6)) / 2e-6
        off = abs(force(gamma) / slope)
        assert off <= point.error + 1e-15
        assert point.error <= ACCURACY * gamma
        assert np.all(branch["admissible"][branch["gamma"] < gamma - 1e-9])
        assert not np.any(branch["admissible"][branch["gamma"] > gamma + 1e-9])

    def test_invariants(self, name):
        branch = rolling(name)
        kept_rows = branch.points["period"] < LONGEST
        assert kept_rows.sum() > 20
        check_hybrid_branch(branch, SYSTEM, chosen=kept_rows)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", TO_THE_END)
def test_it_ends_at_the_least_slope_in_a_homoclinic_orbit(name):
    branch = rolling(name)
    (end,) = [p for p in branch.special_points if p.kind == "homoclinic"]
    assert "homoclinic" in branch.outcome.message
    assert branch.outcome.status != "failed"
    # Which slope belongs to a long period is known to exp(T) walked errors, and the period is long.
    assert end.parameters["gamma"] == pytest.approx(least_slope(name), rel=1e-4)
    assert end.period == branch["period"].max()
    assert end.period > 10.0


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", TO_THE_END)
def test_errors_are_claimed_up_to_the_homoclinic_end(name):
    """The multiplier is eta^2 at every slope, and the speed is known: what a row claims of them holds."""
    branch = rolling(name)
    off = np.abs(branch.points["spectrum"][:, 0] - kept(name) ** 2)
    assert np.all(off <= branch["spectrum_error"] + 10.0 * WALKED)
    # Errors are in the metric, in which the speed has a weight of half its range.
    expected = speed_after(name, branch["gamma"]) / kept(name)
    apart = np.abs(branch.points["state"][:, 1] - expected) / branch.points["weights"][:, 1]
    assert np.all(apart <= 10.0 * branch["error"])
    assert np.all(branch["gamma"] >= least_slope(name) * (1.0 - 10.0 * branch["error"]))
