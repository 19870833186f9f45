"""Where orbits stop being the machine's: points located by the engine against roots found in closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from clocks import FIRST, Clock
from contwalk_systems.impact_oscillator import SYSTEM as OSCILLATOR
from hybrid_invariants import check_hybrid_branch
from hybrid_runs import ACCURACY, assert_met, branch_of, diagram
from one_impact import OneImpact, parameters
from scipy.optimize import brentq

from contwalk.branch import Branch
from contwalk.system import Condition, Transition


class TestClocks:
    """Two events are exchanged: the branch goes on smoothly, in a corner, or turns back."""

    CROSSING = Clock((0.0, 1.0, 1.0, 2.0))
    CORNER = Clock((0.0, 1.0, 3.0, 2.0))
    FOLD = Clock((0.0, 1.0, 3.0, 2.0), k=-0.6)
    CLOCKS = (
        (CROSSING, "crossing"),
        (CORNER, "corner"),
        (Clock((0.0, 1.0, 3.0, 2.0), k=-0.3), "corner"),
        (Clock((0.0, 3.0, 1.0, 2.0), k=-0.6), "corner"),
        (FOLD, "corner"),
    )

    @staticmethod
    @cache
    def study(clock: Clock, policy: str = "switch") -> tuple[Branch, ...]:
        b = clock.parameter(0.25)
        return tuple(
            diagram(
                clock.system(),
                "b",
                (clock.parameter(0.0) - 0.3, b + 0.1),
                [0.0, clock.at_zero(0.25)],
                {"b": b},
                events={"OC": policy},
            )
        )

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(("clock", "kind"), CLOCKS)
    def test_place_and_kind(self, clock, kind):
        """Where `second` is at 0.4; a corner where the branch's slopes on both sides differ."""
        # v at the end, and b, on both sides.
        ends = [
            (clock.at(d, 1.0) - clock.at(0.0, 1.0)) / d / clock.slope(0.0, h)
            for d, h in ((1e-6, 1e-3), (-1e-6, -1e-3))
        ]
        assert (abs(ends[1] - ends[0]) > 1e-3) == (kind == "corner")
        branch = self.study(clock)[0]
        point = next(p for p in branch.special_points if p.label == "OC")
        assert_met(point, "b", clock.parameter(0.0))
        assert point.kind == kind
        assert "'second_later' follows 'first' at once" in point.note
        assert point.period == pytest.approx(1.0, rel=ACCURACY)
        assert point.unstable_before == point.unstable_after == 0
        assert point.criticality is None

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(("clock", "kind"), CLOCKS)
    def test_orbits_in_the_other_order_leave(self, clock, kind):
        first, other = self.study(clock)[:2]
        assert set(first.info.signature) == {"first", "second_later", "again"}
        assert set(other.info.signature) == {"second", "first_later", "again"}
        assert other.info.origin == "b1/OC1"
        for branch, sign in ((first, 1.0), (other, -1.0)):
            rows = branch.points[~branch["special"]]
            leg = [name for _, name, _ in branch.info.settings["legs"]].index(
                "second_later" if sign > 0.0 else "first_later"
            )
            # The leg between the two events.
            d = sign * rows["unknowns"][:, 6 + leg]
            assert np.all(sign * d >= -1e-12)
            expected = [clock.parameter(value) for value in d]
            np.testing.assert_allclose(rows["free"][:, 0], expected, rtol=0, atol=10.0 * ACCURACY)
            check_hybrid_branch(branch, clock.system())

    def test_a_fold_without_a_tangent(self):
        """Both branches lie on one side of the point: no orbits below it."""
        first, other = self.study(self.FOLD)[:2]
        corner = self.FOLD.parameter(0.0)
        assert self.FOLD.slope(0.0) > 0.0 > self.FOLD.slope(0.0, -1e-3)
        for branch in (first, other):
            assert branch["b"].min() == pytest.approx(corner, abs=3.0 * ACCURACY)
            assert branch["b"].max() > corner + 0.1
        # What is stable on one side is unstable on the other; no multiplier passes one.
        assert np.all(first["unstable"] == 0)
        assert np.all(other["unstable"][other["s"] > 0.0] == 1)
        assert [p.label for p in (*first.special_points, *other.special_points) if p.label == "LP"] == []

    def test_a_smooth_fold_and_a_grazing_on_the_branch_that_leaves(self):
        clock = Clock((0.0, 3.0, 1.0, 2.0), k=-0.6)
        other = self.study(clock)[1]
        (fold,) = [p for p in other.special_points if p.label == "LP"]
        d = brentq(lambda u: clock.slope(u, -1e-3), -0.3, -1e-3, xtol=1e-13)
        assert_met(fold, "b", clock.parameter(d))
        # `second` comes with no speed where k v' = 1, at the end of the phase before both events.
        graze = next(p for p in other.special_points if p.label == "GR")
        d = brentq(
            lambda u: clock.k * (clock.pushes[0] - clock.at(u, FIRST + u)) - 1.0, -0.39, -1e-3, xtol=1e-14
        )
        assert_met(graze, "b", clock.parameter(d))
        assert graze.kind == "terminal"
        assert "arrives with no rate" in graze.note


def with_watched(*transitions: Transition, conditions: tuple[Condition, ...] = ()):
    """The impact oscillator with more to look at."""
    return replace(OSCILLATOR, transitions=(*OSCILLATOR.transitions, *transitions), conditions=conditions)


class TestImpactOscillator:
    """Watched guards and conditions on the motion with one impact: omega 1.3, zeta 0.1, restitution 0.8."""

    P = parameters(1.3, 0.1)
    RANGE = (0.6, 2.2)

    @classmethod
    def branch(cls, system, **options) -> Branch:
        return branch_of(
            system, "force", cls.RANGE, [0.0, 0.0], {**vars(cls.P), "force": 1.0}, until="settled", **options
        )

    @classmethod
    def exact(cls) -> OneImpact:
        return OneImpact(cls.P)

    @classmethod
    def motion(cls, force: float, t: float) -> tuple[float, float]:
        """Displacement and velocity of the stable motion, a while after the impact."""
        exact = cls.exact()
        v = exact.velocity(mpmath.mpf(force), faster=True)
        q, rate = exact.at(v, mpmath.mpf(t))
        return float(q), float(rate)

    @classmethod
    def lowest(cls, force: float) -> float:
        """Least displacement between impacts: where the velocity passes zero upwards."""
        times = np.linspace(0.05, float(cls.exact().duration) - 0.05, 25)
        rates = [cls.motion(force, t)[1] for t in times]
        least = math.inf
        for k in range(24):
            if rates[k] < 0.0 <= rates[k + 1]:
                t = brentq(lambda s: cls.motion(force, s)[1], times[k], times[k + 1], xtol=1e-14)
                least = min(least, cls.motion(force, t)[0])
        return least

    @classmethod
    @cache
    def touching(cls) -> float:
        """Force at which the least displacement is -2."""
        return brentq(lambda f: cls.lowest(f) + 2.0, 1.0, 2.0, xtol=1e-13)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("policy", ["stop", "ignore", "switch"])
    def test_a_watched_guard_is_touched(self, policy):
        """A second stop, which is only watched: there is nothing to switch to."""
        bottom = Transition("bottom", "free", "free", lambda t, x, p: x[0] + 2.0, role="watched")
        branch = self.branch(with_watched(bottom), events={"GR": policy})
        (point,) = [p for p in branch.special_points if p.label == "GR"]
        assert_met(point, "force", self.touching())
        assert point.kind == "interior"
        assert point.margin["bottom"] == pytest.approx(0.0, abs=ACCURACY)
        beyond = branch["force"] > point.parameters["force"] * (1.0 + 1e-9)
        if policy == "stop":
            assert branch.outcome.reason == "grazing"
            assert not np.any(beyond)
        else:
            assert branch.outcome.reason == "bound"
            assert beyond.sum() >= 3
            assert not np.any(branch["admissible"][beyond])
        before = branch["force"] < point.parameters["force"] * (1.0 - 1e-9)
        assert np.all(branch["admissible"][before])
        if policy != "stop":
            return
        rows = branch.points[~branch["special"]][::12]
        names = branch.info.observables
        for row in rows:
            expected = self.lowest(float(row["free"][0])) + 2.0
            assert row["observables"][names.index("bottom")] == pytest.approx(expected, abs=1e-6)
        check_hybrid_branch(branch, with_watched(bottom))

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("side", ["before", "after"])
    @pytest.mark.parametrize("policy", ["stop", "ignore"])
    def test_a_condition_at_an_event(self, side, policy):
        """The impact may not be faster than 3, or not leave faster than 2.4 (its 0.8)."""
        if side == "before":
            soft = Condition("soft", lambda t, x, p: 3.0 - x[1], "impact")
        else:
            soft = Condition("soft", lambda t, x, p: 2.4 + x[1], "impact", side="after")
        branch = self.branch(with_watched(conditions=(soft,)), events={"AZ": policy})
        (point,) = [p for p in branch.special_points if p.label == "AZ"]
        exact = self.exact()
        force = brentq(
            lambda f: float(exact.velocity(mpmath.mpf(f), faster=True)) + 2.4, 0.6, 2.2, xtol=1e-14
        )
        assert_met(point, "force", force)
        assert point.kind == "soft"
        assert point.note == "'soft' is zero at 'impact'"
        assert point.margin["soft"] == pytest.approx(0.0, abs=ACCURACY)
        beyond = branch["force"] > force * (1.0 + 1e-9)
        if policy == "stop":
            assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "inadmissible")
            assert not np.any(beyond)
        else:
            assert branch.outcome.reason == "bound"
            assert beyond.sum() >= 3
        assert np.array_equal(branch["admissible"][~branch["special"]], ~beyond[~branch["special"]])
        # The margin is an observable of the branch.
        speeds = -branch.points["unknowns"][:, 1]
        expected = 3.0 - speeds / 0.8 if side == "before" else 2.4 - speeds
        np.testing.assert_allclose(branch["soft"], expected, rtol=0, atol=1e-6)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("phase", [0.0, 0.4])
    def test_a_watched_guard_at_the_end_of_a_leg(self, phase):
        """It is zero at the impact itself: the angle of the force there."""
        late = Transition(
            "late",
            "free",
            "free",
            lambda t, x, p: math.cos(p.omega * t - phase) + 0.2,
            role="watched",
            direction="rising",
        )
        branch = self.branch(with_watched(late))
        found = [p for p in branch.special_points if p.label == "AZ"]
        exact = self.exact()

        def at_impact(force: float) -> float:
            wave = exact.wave(exact.velocity(mpmath.mpf(force), faster=True))
            turn = math.atan2(-float(wave[1]) / 1.3, float(wave[0])) + math.atan2(0.26, 1.0 - 1.69)
            return math.cos(turn - phase) + 0.2

        forces = np.linspace(*self.RANGE, 60)
        signs = [at_impact(f) > 0.0 for f in forces]
        roots = [
            brentq(at_impact, forces[k], forces[k + 1], xtol=1e-14)
            for k in range(59)
            if signs[k] != signs[k + 1]
        ]
        assert len(roots) == len(found)
        for point, root in zip(sorted(found, key=lambda q: q.parameters["force"]), roots, strict=True):
            assert_met(point, "force", root)
            assert point.kind == "late"
