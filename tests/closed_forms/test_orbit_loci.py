"""Curves of special points of orbits in two parameters, and the points on them, in closed form."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import (
    FINE,
    WALKED,
    assert_at,
    cusped,
    doubling,
    folding,
    henon,
    henon_fixed_point,
    labels,
    largest,
    map_as_machine,
    orbits,
    turning,
    walked,
)
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import StartError

pytestmark = pytest.mark.slow


class TestSmoothOrbits:
    def test_folds(self):
        system, radius = folding(), math.sqrt(0.5 + math.sqrt(0.15))
        curve = walked(
            system,
            "mu",
            [radius, 0.0],
            (0.7, 0.95),
            "LP1",
            {"mu": (0.3, 0.99), "a": (0.3, 1.6)},
            2.0 * np.pi / 3.3,
        )
        assert labels(curve) == []
        assert largest(curve["mu"] - (1.0 - curve["a"] ** 2 / 4.0)) < WALKED
        assert largest(np.hypot(curve["x"], curve["y"]) ** 2 - curve["a"] / 2.0) < WALKED
        assert largest(curve.points["spectrum"][:, 0] - 1.0) == 0.0  # what the curve holds
        assert set(curve.points["unstable"]) == {0}  # beside it there is nothing
        facts = curve.info.settings
        assert (curve.info.problem, facts["of"], facts["of_problem"]) == ("locus", "LP", "periodic_orbit")

    def test_folds_that_shrink_to_nothing_end_at_a_generalized_hopf_point(self):
        """r' = r (mu + a r^2 - r^4): folds at mu = -a^2 / 4 for positive a."""

        def field(t, x, p, dx):
            s = x[0] ** 2 + x[1] ** 2
            g, w = p.mu + p.a * s - s * s, 2.0 + 0.3 * s
            dx[0] = g * x[0] - w * x[1]
            dx[1] = w * x[0] + g * x[1]

        square = 0.25 + math.sqrt(0.1625)
        curve = walked(
            small_system(field, "xy", {"mu": 0.1, "a": 0.5}),
            "mu",
            [math.sqrt(square), 0.0],
            (-0.2, 0.3),
            "LP1",
            {"mu": (-0.3, 0.3), "a": (-0.6, 0.7)},
            2.0 * np.pi / (2.0 + 0.3 * square),
        )
        assert (curve.outcome.status, curve.outcome.reason) == ("complete", "shrunk")
        assert largest(curve["mu"] + curve["a"] ** 2 / 4.0) < WALKED
        assert 0.0 < curve["a"].min() < 1e-3

    @pytest.mark.long
    def test_both_ends_are_met_exactly(self):
        system = folding()
        curve = walked(
            system,
            "mu",
            [math.sqrt(0.5 + math.sqrt(0.15)), 0.0],
            (0.7, 0.95),
            "LP1",
            {"mu": (0.5, 0.9), "a": (0.3, 1.3)},
            2.0 * np.pi / 3.3,
        )
        ends = sorted(
            (p.parameters["a"], p.parameters["mu"]) for p in curve.special_points if p.label == "EP"
        )
        assert ends[0][1] == 0.9  # the range of mu ends first
        assert ends[1][0] == 1.3
        assert ends[0][0] == pytest.approx(math.sqrt(0.4), abs=WALKED)

    @pytest.mark.long
    def test_a_cusp_of_cycles(self):
        system = cusped()
        branch = cw.continue_branch(orbits(system, "lam"), [1.0, 0.0], (-0.5, 0.5), period=np.pi)
        assert [p.label for p in branch.special_points if p.label == "LP"] == ["LP", "LP"]
        curve = cw.continue_locus(system, branch, "LP1", {"lam": (-0.5, 0.5), "nu": (-0.2, 0.6)}, **FINE)
        assert labels(curve) == ["CPC"]
        # lam moves by nu^(3/2): what nu is known to hides in it
        assert_at(curve, "CPC", [(0.0, 0.0)])
        assert largest(curve["lam"] ** 2 - 4.0 * curve["nu"] ** 3 / 27.0) < WALKED
        (point,) = [p for p in curve.special_points if p.label == "CPC"]
        # u = r^2 - 1, u' = 2 (1 + u) (-u^3): in a closure u changes by -2 T u^3, and |q| = 1 is a change
        # of r by
        # half the range of x, so that u = 2 xi
        assert point.coefficients["c"] == pytest.approx(-2.0 * np.pi * 4.0, rel=1e-4)

    def test_doublings_and_where_they_change_sides(self):
        curve = walked(
            doubling(),
            "lam",
            [1.0, 0.0, 0.0, 0.0],
            (0.5, 1.2),
            "PD1",
            {"lam": (0.1, 1.6), "sigma": (-2.0, 1.0)},
            np.pi,
        )
        assert labels(curve) == ["GPD"]
        assert largest(curve["lam"] - (1.0 - 0.2 * curve["sigma"] ** 2)) < WALKED
        assert_at(curve, "GPD", [(1.0 - 0.2 * 1.5**2, -1.5)])

    @pytest.mark.long
    def test_tori_their_resonances_and_where_they_change_sides(self):
        curve = walked(
            turning(),
            "lam",
            [1.0, 0.0, 0.0, 0.0],
            (0.5, 1.2),
            "NS1",
            {"lam": (0.1, 1.6), "nu": (0.1, 0.84)},
            2.0 * np.pi / 1.5,
        )
        assert labels(curve) == ["CH", "R2", "R3", "R4"]
        assert largest(curve["lam"] - (1.0 - 0.3 * curve["nu"] ** 2)) < WALKED
        assert largest(curve["cos_theta"] - np.cos(2.0 * np.pi / 1.5 * curve["nu"])) < WALKED
        for label, nu in (("R4", 0.375), ("R3", 0.5), ("CH", 0.44), ("R2", 0.75)):
            assert_at(curve, label, [(1.0 - 0.3 * nu**2, nu)])
        # the map turns the plane, by half a turn there: its cosine comes to minus one and turns back
        (point,) = [p for p in curve.special_points if p.label == "R2"]
        assert point.kind == "semisimple"
        assert "the angle turns back" in point.note


@cache
def henon_branch(free: str, low: float, high: float) -> Branch:
    x = henon_fixed_point(0.5, 0.3)
    return branch_of(henon(), free, (low, high), [x, x], {"alpha": 0.5, "beta": 0.3})


class TestMapsAsMachines:
    """Exact references for all resonances: Henon's map (Kuznetsov 2004, section 9.5.3)."""

    def test_henons_folds(self):
        ranges = {"alpha": (-3.0, 8.0), "beta": (-1.5, 1.8)}
        curve = cw.continue_locus(henon(), henon_branch("alpha", -0.5, 3.0), "LP1", ranges, **FINE)
        assert largest(curve["alpha"] + (1.0 + curve["beta"]) ** 2 / 4.0) < WALKED
        assert labels(curve) == ["LPPD", "R1"]
        assert_at(curve, "R1", [(-1.0, 1.0)])
        assert_at(curve, "LPPD", [(0.0, -1.0)])

    def test_henons_doublings(self):
        ranges = {"alpha": (-3.0, 8.0), "beta": (-1.5, 1.8)}
        branch = henon_branch("alpha", -0.5, 3.0)
        curve = cw.continue_locus(henon(), branch, "PD1", ranges, **FINE)
        assert largest(curve["alpha"] - 0.75 * (1.0 + curve["beta"]) ** 2) < WALKED
        assert labels(curve) == ["LPPD", "R2"]  # the normal form has a pole at R2, and no zero beside it
        assert_at(curve, "R2", [(3.0, 1.0)])
        assert_at(curve, "LPPD", [(0.0, -1.0)])

    def test_a_point_at_an_end_of_the_range_is_there_to_its_error(self):
        branch = henon_branch("alpha", -0.5, 3.0)
        point = branch.special("PD1")
        high = point.parameters["alpha"] - 0.5 * point.error
        assert high < point.parameters["alpha"]
        ranges = {"alpha": (0.5, high), "beta": (-0.5, 1.8)}
        curve = cw.continue_locus(henon(), branch, "PD1", ranges, **FINE)
        assert max(curve["beta"]) == pytest.approx(0.3, abs=1e-9)  # all of it is to one side
        assert min(curve["alpha"]) == 0.5

    @pytest.mark.long
    def test_henons_tori(self):
        """The map preserves areas there: no cubic coefficient, and signs of noise tell no Chenciner point."""
        ranges = {"alpha": (-1.5, 3.5), "beta": (0.2, 1.8)}
        curve = cw.continue_locus(henon(), henon_branch("beta", 0.2, 1.3), "NS1", ranges, **FINE)
        assert largest(curve["beta"] - 1.0) < WALKED
        assert labels(curve) == ["R1", "R2", "R3", "R4"]
        for label, alpha in (("R1", -1.0), ("R4", 0.0), ("R3", 1.25), ("R2", 3.0)):
            assert_at(curve, label, [(alpha, 1.0)])
        # beyond R1 and R2 the curve goes on as neutral saddles, to the other fixed point at R1
        saddles = np.abs(curve["cos_theta"]) > 1.0
        assert largest(curve["x"][saddles & (curve["cos_theta"] < 0.0)]) > 1.0
        assert np.all(curve["x"][curve["cos_theta"] > 1.0] < -1.0)

    @pytest.mark.long
    def test_a_cusp_and_a_generalized_doubling_of_maps(self):
        """x -> x + mu + nu x - x^3 and x -> -(1 + mu) x + a x^2 + b x^3, a = 1/2: GPD at b = -a^2."""
        system = map_as_machine(
            lambda x, p: (x[0] + p.mu + p.nu * x[0] - x[0] ** 3,), "x", {"mu": 0.0, "nu": 0.3}
        )
        branch = branch_of(system, "mu", (-0.5, 0.5), [math.sqrt(0.3)])
        curve = cw.continue_locus(system, branch, "LP1", {"mu": (-0.5, 0.5), "nu": (-0.1, 0.6)}, **FINE)
        assert labels(curve) == ["CPC"]
        assert_at(curve, "CPC", [(0.0, 0.0)])
        assert largest(np.abs(curve["mu"]) - 2.0 * np.maximum(curve["nu"] / 3.0, 0.0) ** 1.5) < WALKED

        system = map_as_machine(
            lambda x, p: (-(1.0 + p.mu) * x[0] + 0.5 * x[0] ** 2 + p.b * x[0] ** 3,),
            "x",
            {"mu": -0.5, "b": 0.1},
        )
        branch = branch_of(system, "mu", (-0.6, 0.3), [0.0])
        curve = cw.continue_locus(system, branch, "PD1", {"mu": (-0.5, 0.5), "b": (-1.0, 0.5)}, **FINE)
        assert labels(curve) == ["GPD"]
        assert_at(curve, "GPD", [(0.0, -0.25)])
        assert largest(curve["mu"]) < WALKED


def test_points_that_no_curve_begins_at_are_refused_with_a_sentence():
    branch = henon_branch("alpha", -0.5, 3.0)
    with pytest.raises(StartError, match="No curve in two parameters can be followed from EP1"):
        cw.continue_locus(henon(), branch, "EP1", {"alpha": (-3.0, 8.0), "beta": (-1.5, 1.8)})
