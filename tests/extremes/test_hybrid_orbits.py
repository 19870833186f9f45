"""Hybrid orbits at their extremes: restitution, many events, events at once, short legs, ends of a gait."""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from clocks import Clock
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from contwalk_systems.impact_oscillator import SYSTEM as OSCILLATOR
from contwalk_systems.planar_walker import SYSTEM as WALKER
from hybrid_invariants import check_hybrid_branch
from hybrid_runs import ACCURACY, assert_met, branch_of, diagram, machine, opened
from one_impact import forced, parameters, stiffness

from contwalk.branch import Branch, Outcome
from contwalk.system import Mode, State, System, Transition

pytestmark = pytest.mark.slow

WALKED = 100.0 * ACCURACY


class TestRestitution:
    """The bouncing ball with one bounce a period; closed forms as in the tests of closed forms."""

    G, OMEGA = 9.81, 35.0

    @classmethod
    def fold(cls, e: float) -> float:
        return math.pi * cls.G * (1.0 - e) / (cls.OMEGA**2 * (1.0 + e))

    @classmethod
    def doubling(cls, e: float) -> float:
        return math.hypot(cls.fold(e), 2.0 * cls.G * (1.0 + e**2) / (1.0 + e) ** 2 / cls.OMEGA**2)

    @classmethod
    @cache
    def branch(cls, e: float) -> Branch:
        speed = math.pi * cls.G / cls.OMEGA
        amplitude = 0.3 * cls.fold(e) + 0.7 * cls.doubling(e)
        bounce = math.acos(speed * (1.0 - e) / ((1.0 + e) * amplitude * cls.OMEGA)) / cls.OMEGA
        passed = 2.0 * math.pi / cls.OMEGA - bounce
        state = [
            amplitude * math.sin(cls.OMEGA * bounce) + speed * passed - 0.5 * cls.G * passed**2,
            speed - cls.G * passed,
        ]
        low = max(0.5 * cls.fold(e), 0.3 * amplitude)
        values = {"e": e, "A": amplitude, "omega": cls.OMEGA, "g": cls.G}
        return branch_of(BALL, "A", (low, 1.05 * cls.doubling(e)), state, values)

    @pytest.mark.drawn(2)
    @pytest.mark.parametrize("e", [0.0, 1e-9, 0.999999, 1.0])
    def test_doubling_and_determinant(self, e):
        branch = self.branch(e)
        (point,) = [p for p in branch.special_points if p.label == "PD"]
        assert_met(point, "A", self.doubling(e))
        assert branch.outcome.status != "failed"
        products = np.prod(branch.points["spectrum"], axis=1)
        assert np.all(np.abs(products - e**2) <= WALKED * (1.0 + np.abs(branch.points["spectrum"][:, 0])))
        check_hybrid_branch(branch, BALL)

    def test_fold_of_an_all_but_elastic_ball(self):
        """At an amplitude of 13 nm; the branch runs through it from amplitudes a million times as large."""
        e = 0.999999
        speed = math.pi * self.G / self.OMEGA
        amplitude = 2.0 * self.fold(e)
        bounce = math.acos(speed * (1.0 - e) / ((1.0 + e) * amplitude * self.OMEGA)) / self.OMEGA
        passed = 2.0 * math.pi / self.OMEGA - bounce
        state = [
            amplitude * math.sin(self.OMEGA * bounce) + speed * passed - 0.5 * self.G * passed**2,
            speed - self.G * passed,
        ]
        values = {"e": e, "A": amplitude, "omega": self.OMEGA, "g": self.G}
        branch = branch_of(BALL, "A", (0.5 * self.fold(e), 3.0 * self.fold(e)), state, values)
        (point,) = [p for p in branch.special_points if p.label == "LP"]
        off = abs(point.parameters["A"] - self.fold(e))
        assert off <= point.error + 1e-23
        assert point.error <= 1e-6 * self.fold(e)  # rounding of the phase allows no more

    def test_without_restitution_the_ball_stays_on_a_slow_table(self):
        """It leaves where the table falls faster than g: A omega^2 sin(phase) > g. There is a limit."""
        branch = self.branch(0.0)
        leaves = self.G / self.OMEGA**2 * math.hypot(1.0, math.pi)
        found = [p for p in branch.special_points if p.label in ("GR", "OC")]
        assert len(found) == 1
        assert found[0].parameters["A"] == pytest.approx(leaves, rel=1e-6)
        assert branch.outcome.reason == "grazing"

    @classmethod
    def touched(cls, e: float) -> tuple[float, float]:
        """Amplitude at which the ball just touches the table again after a bounce, and how long after it."""
        with mpmath.workdps(30):
            g, omega, small = mpmath.mpf(cls.G), mpmath.mpf(cls.OMEGA), mpmath.mpf(e)
            speed = mpmath.pi * g / omega

            def amplitude(phase: mpmath.mpf) -> mpmath.mpf:
                return speed * (1 - small) / ((1 + small) * omega * mpmath.cos(phase))

            def above(phase: mpmath.mpf, t: mpmath.mpf) -> list[mpmath.mpf]:
                a = amplitude(phase)
                height = speed * t - g * t**2 / 2 - a * (mpmath.sin(phase + omega * t) - mpmath.sin(phase))
                return [height / t, speed - g * t - a * omega * mpmath.cos(phase + omega * t)]

            guess = mpmath.atan(1 / mpmath.pi) * (1 - mpmath.sqrt(small) / 2), mpmath.sqrt(small) / 20
            phase, t = mpmath.findroot(above, guess)
            return float(amplitude(phase)), float(t)

    @pytest.mark.drawn(2)
    @pytest.mark.parametrize(
        "e",
        [
            0.05,
            0.01,
            1e-4,
            1e-5,
            1e-6,
        ],
    )
    def test_the_ball_touches_the_table_again(self, e):
        """With little restitution, soon after a bounce."""
        amplitude, seconds = self.touched(e)
        branch = self.branch(e)
        (point,) = [p for p in branch.special_points if p.label == "GR"]
        # Of the height only the table's curvature, A omega^2 t^2 sin(phase) / 2, says what A is. It is known
        # to a rounding for each of some 30 steps, of terms (speed times time) of six amplitudes each.
        share = 0.5 * (self.OMEGA * seconds) ** 2 / math.hypot(1.0, math.pi)
        assert_met(point, "A", amplitude, max(ACCURACY, 600.0 * 2.0**-52 / share))
        told = float(point.note.split("touched ")[1].split(" s ")[0])
        assert told == pytest.approx(seconds, rel=1e-5)
        assert branch.outcome.reason == "grazing"
        assert np.all(branch["admissible"][~branch["special"]])

    @pytest.mark.drawn(2)
    @pytest.mark.parametrize("restitution", [0.0, 1e-6, 0.999999, 1.0])
    def test_impact_oscillator(self, restitution):
        """The determinant is restitution^2 exp(-2 zeta T) at every point."""
        p = parameters(1.3, 0.1, restitution, 1.0)
        found = diagram(
            OSCILLATOR,
            "force",
            (0.9, 1.3),
            [0.0, 0.0],
            vars(p),
            until="settled",
        )
        (branch,) = found
        assert branch.outcome.reason == "bound"
        assert branch.info.signature == ("impact",)
        expected = restitution**2 * math.exp(-4.0 * math.pi * p.zeta / p.omega)
        products = np.prod(branch.points["spectrum"], axis=1)
        assert np.all(np.abs(products - expected) <= WALKED * 10.0)
        np.testing.assert_allclose(
            branch.points["unknowns"][:, 1], -restitution * branch["impact_speed"], rtol=0, atol=WALKED * 10.0
        )
        check_hybrid_branch(branch, OSCILLATOR)


class TestManyEvents:
    """A ball that is kicked at each bounce by k + 0.3 cos c, where c goes round in 50 bounces.

    v+ = e v + k + 0.3 cos c is linear, c is drawn to multiples of 2 pi / 50, and flights last 2 v / g.
    """

    NUMBER = 50

    @classmethod
    def system(cls) -> System:
        n = cls.NUMBER

        def fly(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = -p.g
            dx[2] = 0.0 * x[0]

        def hit(t, x, p, after):
            after[0] = 0.0 * x[0]
            after[1] = -p.e * x[1] + p.k + 0.3 * math.cos(x[2])
            after[2] = x[2] + 2.0 * math.pi / n - 0.01 * math.sin(n * x[2])

        return machine(
            ["y", "v", State("c", period=2.0 * math.pi)],
            {"e": 0.9, "k": 1.0, "g": 10.0},
            {"flight": fly},
            [Transition("hit", "flight", "flight", lambda t, x, p: x[0], reset=hit)],
        )

    def speeds(self, k: float) -> np.ndarray:
        """Speeds after the bounces with c = 2 pi j / 50."""
        n, kicks = self.NUMBER, k + 0.3 * np.cos(2.0 * math.pi * np.arange(self.NUMBER) / self.NUMBER)
        matrix = np.eye(n) - 0.9 * np.roll(np.eye(n), -1, axis=1)
        return np.linalg.solve(matrix, kicks)

    def test_fifty_impacts_in_a_period(self):
        branch = branch_of(self.system(), "k", (0.9, 1.1), [0.0, 10.0, 0.0], until="settled", max_points=6)
        assert branch.outcome.reason == "max_points"
        assert branch.info.signature == ("hit",) * self.NUMBER
        for row in branch.points:
            speeds = self.speeds(float(row["free"][0]))
            assert row["period"] == pytest.approx(0.2 * speeds.sum(), rel=WALKED)
            own = row["unknowns"][: 3 * self.NUMBER].reshape(-1, 3)
            order = np.argsort(np.mod(own[:, 2] + 0.01, 2.0 * math.pi))
            # The bounce at c leads to the flight with the next multiple.
            np.testing.assert_allclose(own[order, 1], np.roll(speeds, 1), rtol=WALKED)
            np.testing.assert_allclose(
                np.abs(row["spectrum"]), [0.9**self.NUMBER, 0.0], rtol=0, atol=WALKED * 10.0
            )


class TestEventsAtOnce:
    """Two events of a clock, and the leg between them, that are next to nothing apart."""

    CLOCK = Clock((0.0, 1.0, 3.0, 2.0))

    def study(self, d: float, policy: str) -> list[Branch]:
        b = self.CLOCK.parameter(d)
        return diagram(
            self.CLOCK.system(),
            "b",
            (b - 0.1, b + 0.1),
            [0.0, self.CLOCK.at_zero(d)],
            {"b": b},
            events={"OC": policy},
        )

    @pytest.mark.drawn(2)
    @pytest.mark.parametrize("sign", [1.0, -1.0])
    @pytest.mark.parametrize(
        "apart",
        [
            1e-12,
            1e-9,
            1e-5,
        ],
    )
    def test_order_change_is_found_from_next_to_it(self, apart, sign):
        (branch,) = self.study(sign * apart, "stop")
        (point,) = [p for p in branch.special_points if p.label == "OC"]
        assert_met(point, "b", self.CLOCK.parameter(0.0))
        assert branch.outcome.reason == "order_change"
        # The branch goes on the other way to its bound.
        assert {p.kind for p in branch.special_points if p.label == "EP"} == {"bound", "order_change"}
        rows = branch.points[~branch["special"]]
        assert np.all(sign * (rows["free"][:, 0] - self.CLOCK.parameter(0.0)) >= -1e-12)
        assert np.all(rows["admissible"])

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("d", [1e-12, -1e-12])
    def test_the_orbit_itself(self, d):
        """Its word is that of its order, and the short leg lasts what it should."""
        branch = self.study(d, "stop")[0]
        expected = ("first", "second_later", "again") if d > 0.0 else ("second", "first_later", "again")
        assert set(branch.info.signature) == set(expected)
        (row,) = branch.points[branch["s"] == 0.0]
        shortest = float(np.min(row["unknowns"][6:9]))
        assert shortest == pytest.approx(abs(d), abs=1e-15)
        assert row["spectrum"][0] == pytest.approx(math.exp(-1.0), abs=WALKED)

    @pytest.mark.parametrize("policy", ["stop", "ignore", "switch"])
    def test_policies(self, policy):
        first, *others = self.study(0.05, policy)
        corner = self.CLOCK.parameter(0.0)
        (point,) = [p for p in first.special_points if p.label == "OC"]
        assert_met(point, "b", corner)
        assert point.kind == "corner"
        beyond = first["b"] < corner - 1e-9
        if policy == "ignore":
            assert (first.outcome.status, first.outcome.reason) == ("complete", "bound")
            assert beyond.sum() >= 3
            assert not np.any(first["admissible"][beyond])
            assert others == []
            return
        assert not np.any(beyond)
        assert "order_change" in {p.kind for p in first.special_points if p.label == "EP"}
        assert first.outcome.status == ("stopped" if policy == "stop" else "complete")
        assert [b.info.origin for b in others] == (["b1/OC1"] if policy == "switch" else [])
        if policy == "switch":
            (other,) = others
            assert other["b"].min() == pytest.approx(corner - 0.05, abs=1e-12)
            assert other["b"].max() <= corner + 1e-12
            assert np.all(other["admissible"])
            check_hybrid_branch(other, self.CLOCK.system())


class TestShortLegs:
    """A ball on a spring of frequency pi / duration: contacts last so long, flights 2 v / g; v+ = e v + 1."""

    @staticmethod
    def system(duration: float) -> System:
        stiffness_ = (math.pi / duration) ** 2

        def fly(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = -p.g

        def press(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = -stiffness_ * x[0]

        def leave(t, x, p, after):
            after[0] = x[0]
            after[1] = p.e * x[1] + 1.0

        return machine(
            ["y", "v"],
            {"e": 0.8, "g": 10.0},
            {"flight": fly, "contact": press},
            [
                Transition("touch", "flight", "contact", lambda t, x, p: x[0]),
                Transition(
                    "leave", "contact", "flight", lambda t, x, p: x[0], direction="rising", reset=leave
                ),
            ],
        )

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(
        "duration",
        [
            1e-3,
            1e-6,
            1e-9,
        ],
    )
    def test_a_contact(self, duration):
        branch = branch_of(self.system(duration), "e", (0.7, 0.9), [0.0, 5.2], until="settled", mode="flight")
        assert branch.outcome.reason == "bound"
        speed = 1.0 / (1.0 - branch["e"])
        np.testing.assert_allclose(branch["period"], 0.2 * speed + duration, rtol=WALKED * 10.0)
        shortest = np.min(branch.points["unknowns"][:, 4:6], axis=1)
        # Known as the orbit is, in units of its period.
        np.testing.assert_allclose(shortest, duration, rtol=0, atol=WALKED * branch["period"].max())
        np.testing.assert_allclose(branch.points["spectrum"][:, 0], branch["e"], rtol=0, atol=WALKED * 10.0)


class TestResets:
    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("gap", [1e-4, 1e-6])
    def test_a_nearly_singular_impact_matrix(self, gap):
        """Masses (1, 1 - gap; 1 - gap, 1) whose difference in speed is lost in flight.

        The sum of both speeds becomes k - s / 2, and the fall from it takes s / g. Elimination loses 1 / gap
        roundings.
        """

        def fly(t, x, p, dx):
            dx[0] = x[1] + x[2]
            dx[1] = -0.5 * p.g - 0.5 * (x[1] - x[2]) + 0.3
            dx[2] = -0.5 * p.g + 0.5 * (x[1] - x[2]) - 0.3

        def hit(t, x, p, after):
            c = 1.0 - gap
            push = 0.5 * (1.0 + c) * (p.k - 1.5 * (x[1] + x[2]))
            first, second = x[1] + c * x[2] + push, c * x[1] + x[2] + push
            det = 1.0 - c * c
            after[0] = 0.0 * x[0]
            after[1] = (first - c * second) / det
            after[2] = (second - c * first) / det

        system = machine(
            ["y", "u", "w"],
            {"k": 1.0, "g": 10.0},
            {"flight": fly},
            [Transition("hit", "flight", "flight", lambda t, x, p: x[0], reset=hit)],
        )
        branch = branch_of(system, "k", (0.5, 2.0), [0.0, 1.0, 1.0], until="settled")
        assert branch.outcome.reason == "bound"
        # s+ = k + s+ / 2 with s- = -s+ / 1: s = 2 k, and the flight lasts 2 s / g.
        np.testing.assert_allclose(branch["period"], 0.4 * branch["k"], rtol=WALKED)
        known = WALKED + 1e-14 / gap
        expected = np.exp(-branch["period"])
        for values, relaxed in zip(branch.points["spectrum"], expected, strict=True):
            assert sorted(values.real) == pytest.approx(sorted([0.5, relaxed]), abs=10.0 * known)

    def test_an_accumulation_of_events_is_no_orbit(self):
        """A rotor whose kicks come faster and faster: nothing is left to continue, and that is said."""

        def turn(t, x, p, dx):
            dx[0] = 1.0 + x[1] + 0.2 * math.cos(x[0])
            dx[1] = -p.damping * x[1] + 0.1 * math.sin(2.0 * x[0])

        def kick(t, x, p, after):
            after[0] = x[0]
            after[1] = 0.5 * x[1] + 0.4 * math.cos(x[0] - p.damping)

        system = machine(
            [State("phi", period=2.0 * math.pi), "v"],
            {"damping": 0.4},
            {"turning": turn},
            [
                Transition(
                    "through",
                    "turning",
                    "turning",
                    lambda t, x, p: math.sin(x[0] - 0.1 * x[1]),
                    direction="both",
                    reset=kick,
                )
            ],
        )
        outcome = opened(system, "damping", [0.5, 0.0], until="settled")
        assert isinstance(outcome, Outcome)
        assert outcome.status == "failed"
        assert "'through' accumulates" in outcome.message

    def test_all_is_forgotten_at_an_event(self):
        """A leg with one state ends at a value of it: there are no multipliers, and the orbit is stable."""

        def leak(t, x, p, dx):
            dx[0] = -x[0]

        def rise(t, x, p, dx):
            dx[1] = x[2]
            dx[2] = -2.0

        def launch(t, x, p, after):
            after[1] = 0.0
            after[2] = p.k * (1.0 + x[0])

        def fill(t, x, p, after):
            after[0] = 1.0 - 0.1 * x[2]

        system = machine(
            ["z", "y", "v"],
            {"k": 1.0},
            [Mode("leaking", leak, states=("z",)), Mode("rising", rise, states=("y", "v"))],
            [
                Transition("empty", "leaking", "rising", lambda t, x, p: x[0] - 0.5, reset=launch),
                Transition("landed", "rising", "leaking", lambda t, x, p: x[1], reset=fill),
            ],
        )
        branch = branch_of(system, "k", (0.5, 2.0), [0.8, 0.0, 0.0], until="settled")
        assert branch.outcome.reason == "bound"
        speed = 1.5 * branch["k"]
        expected = speed + np.log((1.0 + 0.1 * speed) / 0.5)
        np.testing.assert_allclose(branch["period"], expected, rtol=WALKED)
        assert np.all(np.isnan(branch.points["spectrum"].real))
        assert np.all(branch["stable"] == 1)
        assert np.all(branch["unstable"] == 0)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("rate", [10.0, 1e3, 1e5])
    def test_a_state_that_is_kicked_and_relaxes_fast(self, rate):
        """A wheel with z' = -rate z and z+ = 1 at each impact: as without z, and one multiplier more."""

        def roll(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = math.sin(x[0])
            dx[2] = -p.rate * x[2]

        def strike(t, x, p, after):
            after[0] = x[0] - 0.8
            after[1] = 0.7 * x[1]
            after[2] = 1.0

        system = machine(
            ["theta", "omega_", "z"],
            {"gamma": 0.15, "rate": rate},
            {"rolling": roll},
            [Transition("strike", "rolling", "rolling", lambda t, x, p: p.gamma + 0.4 - x[0], reset=strike)],
        )
        branch = branch_of(system, "gamma", (0.14, 0.16), [-0.25, 0.4, 1.0], until="settled")
        assert branch.outcome.reason == "bound"
        values = np.sort(np.abs(branch.points["spectrum"]), axis=1)
        np.testing.assert_allclose(values, np.array([[0.0, 0.49]] * len(values)), rtol=0, atol=WALKED * 10.0)


class TestWalkerDownTheSlope:
    """Down to where gaits cease: every policy ends with a reason, and none of them is a failure."""

    STATE = (-0.5196, 0.1528388, 0.0, 0.0, -1.933, -2.037, 0.0)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(
        ("policy", "reason", "low"),
        [
            ("stop", "grazing", 0.0573319),
            ("ignore", "grazing", 0.0368974),
            ("switch", "grazing", 0.0368974),
        ],
    )
    def test_down_to_the_fold_and_beyond(self, policy, reason, low):
        """`stop` ends where the swing foot scuffs; others pass the fold and end at a grazing heel strike."""
        first, *others = diagram(
            WALKER,
            "alpha",
            (0.001, 0.0901),
            self.STATE,
            event="heel_strike",
            until="settled",
            events={"GR": policy, "OC": policy},
            direction="down",
        )
        assert first.outcome.status in ("complete", "stopped")
        assert reason in {p.kind for p in first.special_points if p.label == "EP"}
        assert first["alpha"].min() == pytest.approx(low, abs=1e-7)
        for branch in (first, *others):
            assert branch.outcome.status != "failed", branch.outcome.message
            assert branch.outcome.message.endswith(".")

    def test_friction_runs_out(self):
        """With AZ: stop and mu = 0.3 the gait of Table I needs more than there is."""
        (branch,) = diagram(
            WALKER,
            "alpha",
            (0.06, 0.095),
            self.STATE,
            {"mu": 0.45},
            event="heel_strike",
            until="settled",
            events={"AZ": "stop", "GR": "ignore"},
        )
        (point,) = [p for p in branch.special_points if p.label == "AZ"]
        assert point.kind == "knee_friction"
        assert "inadmissible" in {p.kind for p in branch.special_points if p.label == "EP"}
        # What is needed is what there is.
        friction = branch["friction_knee"][point.index]
        assert friction == pytest.approx(0.45, abs=1e-7)


def test_a_start_right_at_a_grazing():
    """Where the motion without impacts just touches the stop either word will do, and no failure."""
    p = parameters(1.3, 0.1)
    p.force = stiffness(p)
    found = diagram(
        OSCILLATOR,
        "force",
        (0.5 * p.force, 1.2 * p.force),
        forced(p, 0.0),
        vars(p),
        events={"GR": "ignore"},
    )
    for branch in found:
        assert branch.outcome.status != "failed", branch.outcome.message
        assert branch["force"].min() == 0.5 * p.force or branch.info.signature
