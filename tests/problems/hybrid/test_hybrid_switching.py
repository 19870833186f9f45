"""Doubled orbits: born, taken apart, ended on their parent; normal forms against the branches that leave."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from contwalk_systems.planar_walker import SYSTEM as WALKER
from hybrid_invariants import check_hybrid_branch
from hybrid_machines import orbit
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch, SpecialPoint
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.least_part import divided
from contwalk.problems.orbit.asymmetry import repetitions
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.restoring import problem_of
from contwalk.system import System, Transition

WALKED = 100.0 * ACCURACY


def bubbles(rate: float = 0.0) -> System:
    """A clock that ticks once a second, and x+ = 1 - (0.9 - lam^2) x^2 at each tick.

    x = 2 / (1 + sqrt(1 + 4 a)) doubles its period at a = 3 / 4, on both sides of lam = 0; the doubled orbit
    is x = (1 +- sqrt(4 a - 3)) / (2 a).
    """

    def run(t, x, p, dx):
        dx[0] = 1.0
        dx[1] = -p.rate * x[1]

    def tick(t, x, p, after):
        after[0] = x[0] - 1.0
        after[1] = 1.0 - (0.9 - p.lam * p.lam) * x[1] * x[1]

    return machine(
        ["theta", "x"],
        {"lam": 0.7, "rate": rate},
        {"run": run},
        [Transition("tick", "run", "run", lambda t, x, p: 1.0 - x[0], reset=tick)],
    )


@cache
def bubble() -> tuple[Branch, ...]:
    return tuple(diagram(bubbles(), "lam", (-0.8, 0.8), [0.0, 0.6], until="settled", follow=["PD"], depth=3))


class TestBubble:
    """A doubled orbit that is born at one doubling and ends at the other."""

    def test_two_doublings_and_one_doubled_orbit(self):
        parent, child = bubble()
        first, second = [p for p in parent.special_points if p.label == "PD"]
        assert_met(first, "lam", -math.sqrt(0.15))
        assert_met(second, "lam", math.sqrt(0.15))
        assert (first.unstable_before, first.unstable_after) == (0, 1)
        assert (second.unstable_before, second.unstable_after) == (1, 0)
        assert (child.outcome.status, child.outcome.reason) == ("complete", "rejoined")
        assert "one that repeats itself" in child.outcome.message
        last = max(child.special_points, key=lambda p: p.s)
        assert last.parameters["lam"] == pytest.approx(math.sqrt(0.15), abs=ACCURACY)

    def test_normal_form(self):
        """c = (3 B(q, (1 - A)^-1 B(q, q))) / 6 with B = -2 a = -3 / 2 and A = -1."""
        for point in bubble()[0].special_points:
            if point.label == "PD":
                assert point.coefficients["c"] == pytest.approx(27.0 / 48.0, rel=1e-9)
                assert abs(point.coefficients["c"] - 27.0 / 48.0) <= point.coefficients["c_error"] + 1e-12
                assert point.criticality == "supercritical"

    def test_doubled_orbit_and_its_multiplier(self):
        child = bubble()[1]
        rows = child.points[~child["special"]]
        a = 0.9 - rows["free"][:, 0] ** 2
        apart = np.sqrt(np.maximum(4.0 * a - 3.0, 0.0)) / a
        # x at the starts of both legs: its distance is a root of what is left of a.
        found = np.abs(rows["unknowns"][:, 1] - rows["unknowns"][:, 3])
        assert np.all(np.abs(found**2 - apart**2) <= 10.0 * WALKED)
        assert np.all(np.abs(rows["spectrum"][:, 0] - (4.0 - 4.0 * a)) <= 100.0 * WALKED)

    def test_invariants(self):
        for branch in bubble():
            check_hybrid_branch(branch, bubbles())


class TestNormalForms:
    """Coefficients against the branches themselves: of the ball, and of the walker."""

    @staticmethod
    @cache
    def study(name: str) -> tuple[System, tuple[Branch, ...], float]:
        if name == "walker":
            state = [-0.5196, 0.1528388, 0.0, 0.0, -1.933, -2.037, 0.0]
            options = {"event": "heel_strike", "until": "settled", "follow": ["PD"], "max_step": 0.02}
            found = diagram(
                WALKER, "alpha", (0.0968, 0.0992), state, {"alpha": 0.097}, events={"GR": "ignore"}, **options
            )
            return WALKER, tuple(found), 0.0982
        problem, z = orbit("time-dependent guard and reset")
        values = problem.values_of(z)
        period = 2.0 * math.pi / values["omega"]
        x, t = z[:2], float(z[3])
        passed = period - t
        state = [x[0] + x[1] * passed - 0.5 * 9.81 * passed**2, x[1] - 9.81 * passed]
        found = diagram(BALL, "A", (0.0083, 0.0126), state, values, follow=["PD"], max_step=0.03)
        return BALL, tuple(found), 0.0122

    def problem(self, name: str, branch: Branch, point: SpecialPoint) -> HybridOrbit:
        system = self.study(name)[0]
        problem = problem_of(system, branch.info, np.array(list(point.state.values())), None)
        return discretized(problem, np.array(point.unknowns))

    @staticmethod
    def size(problem: HybridOrbit, point: SpecialPoint, deviation: np.ndarray) -> float:
        """Root mean square of a deviation over the orbit, in units of half the range of each state.

        Of the ball by hand: height and velocity of a flight that starts with (y, v), as far after its start.
        """
        if problem.system is not BALL:
            map_ = problem.return_map(np.array(point.unknowns))
            return map_.size(np.linalg.solve(map_.basis, deviation))
        _, v, lasting, _ = point.unknowns[:4]
        half_height, half_speed = v**2 / (4.0 * 9.81), 0.5 * 9.81 * lasting
        y, u = deviation[:2]
        squares = y**2 + y * u * lasting + u**2 * lasting**2 / 3.0
        return math.sqrt(squares / half_height**2 + u**2 / half_speed**2)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("name", ["ball", "walker"])
    def test_doubling(self, name):
        """On the doubled orbit, half the distance of its two halves is xi with c xi^2 = mu."""
        _, (parent, child), _ = self.study(name)
        (point,) = [p for p in parent.special_points if p.label == "PD"]
        problem = self.problem(name, parent, point)
        at = point.parameters[parent.info.free[0]]
        rows = [i for i in range(len(parent)) if not parent["special"][i]]
        rows = sorted(rows, key=lambda i: abs(i - point.index))[:5]
        values = parent.points["spectrum"][rows]
        mu = -1.0 - np.where(values.real < -0.5, values.real, 0.0).min(axis=1)
        distance = np.append(parent["free"][rows, 0] - at, 0.0)
        slope = np.polynomial.Polynomial.fit(distance, np.append(mu, 0.0), 5).deriv()(0.0)
        first_leg = int(np.argmin(problem.layout.sizes))
        m, beside = problem.layout.legs, child.points[(child["s"] > 0.0) & ~child["special"]][:4]
        width = problem.layout.states[-1].stop
        found = []
        for row in beside:
            both, i = row["unknowns"], first_leg
            first, second = (
                both[k * width + problem.layout.states[i].start : k * width + problem.layout.states[i].stop]
                for k in (0, 1)
            )
            half = 0.5 * (first - second)
            if problem.forced:
                lasting = both[2 * width : 2 * width + 2 * m]
                period = 0.5 * lasting.sum()
                half = np.append(half, -0.5 * (lasting[:m].sum() - period))
            xi = self.size(problem, point, half)
            found.append((row["free"][0] - at) * slope / xi**2)
        distance = beside["free"][:, 0] - at
        c = np.polynomial.Polynomial.fit(distance, found, 2)(0.0)
        # A parabola through four points; of the walker, the distance is not across the flow alone.
        assert point.coefficients["c"] == pytest.approx(c, rel=1e-4 if name == "ball" else 0.01)

    def test_fold(self):
        """The two orbits of an amplitude are 2 xi apart, with b mu + a xi^2 = 0."""
        _, (branch, *_), _ = self.study("ball")
        (point,) = [p for p in branch.special_points if p.label == "LP"]
        problem = self.problem("ball", branch, point)
        at, found, mus = point.parameters["A"], [], []
        for row in branch.points[~branch["special"]]:
            mu = float(row["free"][0]) - at
            if not 1e-6 * at < mu < 0.02 * at:
                continue
            y, _, _, t = row["unknowns"]
            # The other orbit has the opposite phase.
            half = np.array([y, 0.0, t])
            xi = self.size(problem, point, half)
            found.append(mu / xi**2)
            mus.append(mu)
        assert len(found) >= 4
        ratio = np.polynomial.Polynomial.fit(mus, found, 2)(0.0)
        assert -point.coefficients["a"] / point.coefficients["b"] == pytest.approx(ratio, rel=0.01)

    def test_coefficients_do_not_depend_on_the_steps(self):
        """Of the ball, whose flights are integrated exactly by three steps."""
        found = []
        problem, z = orbit("time-dependent guard and reset")
        values = problem.values_of(z)
        passed = 2.0 * math.pi / values["omega"] - float(z[3])
        state = [z[0] + z[1] * passed - 0.5 * 9.81 * passed**2, z[1] - 9.81 * passed]
        for accuracy in (1e-5, 1e-9):
            (branch,) = diagram(BALL, "A", (0.0083, 0.0126), state, values, accuracy=accuracy)
            (fold,) = [p for p in branch.special_points if p.label == "LP"]
            (doubling,) = [p for p in branch.special_points if p.label == "PD"]
            found.append([fold.coefficients["a"], fold.coefficients["b"], doubling.coefficients["c"]])
        np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


def first_of(problem: HybridOrbit, times: int) -> np.ndarray:
    """A direction in which the first of so many parts of an orbit differs from the others."""
    along, states = np.zeros(problem.size + 1), problem.layout.durations.start // times
    along[:states] = cycle_scales(problem)[1][:states]
    return along


class TestParts:
    """Words run through several times."""

    @staticmethod
    def repeated(name: str, times: int) -> tuple[HybridOrbit, HybridOrbit, np.ndarray, np.ndarray]:
        problem, z = orbit(name)
        layout = problem.layout
        states, lasting = z[: layout.durations.start], z[layout.durations]
        rest = z[layout.durations.stop :]
        longer = np.concatenate([*[states] * times, *[lasting] * times, rest])
        if np.any(problem.turns):
            n = len(problem.system.states)
            for k in range(times):
                for i in range(layout.legs):
                    place = slice(
                        k * len(states) + layout.states[i].start, k * len(states) + layout.states[i].stop
                    )
                    assert place.stop - place.start == n
                    longer[place] += k * problem.turns
        other = problem.of_itinerary(problem.itinerary.repeated(times), times)
        return problem, discretized(other, longer), z, longer

    @pytest.mark.parametrize("times", [2, 3])
    @pytest.mark.parametrize(
        "name",
        [
            "time-dependent guard and reset",
            "different numbers of states",
            "guard of both directions",
            "walker",
        ],
    )
    def test_an_orbit_that_repeats_itself_is_divided(self, name, times):
        problem, longer, z, zs = self.repeated(name, times)
        assert repetitions(longer, zs) == times
        assert longer.returned_to_parent(zs, first_of(longer, times))
        # Where those beside it repeat themselves too, the branch is that of the parent.
        assert not longer.returned_to_parent(zs, np.zeros(len(zs)))
        assert np.all(
            np.abs(longer.linearize(zs).residual) <= 100.0 * problem.mesh.tolerance * longer.equation_scales
        )
        part, start = divided(longer, zs, times)
        np.testing.assert_array_equal(start, z)
        assert part.itinerary == problem.itinerary
        assert part.subharmonic == problem.subharmonic
        np.testing.assert_allclose(part.turns, problem.turns, rtol=1e-15)
        # Multipliers of the longer itinerary are powers.
        once = problem.multipliers(z, problem.linearize(z).jacobian).values
        often = longer.multipliers(zs, longer.linearize(zs).jacobian).values
        np.testing.assert_allclose(np.poly(often), np.poly(once**times), rtol=0, atol=1e-5)

    @pytest.mark.parametrize("name", ["time-dependent guard and reset", "walker"])
    def test_an_orbit_that_nearly_repeats_itself_is_kept(self, name):
        _, longer, _, zs = self.repeated(name, 2)
        zs[: longer.layout.durations.start // 2] += 1e-4 * longer.mesh.variation.min()
        assert repetitions(longer, zs) == 1
        assert not longer.returned_to_parent(zs, first_of(longer, 2))

    def test_a_word_without_parts_does_not_repeat(self):
        problem, z = orbit("different numbers of states")
        assert repetitions(problem, z) == 1

    def test_relabelled_closures(self):
        """An odd number of swaps closes up to them, and two closures are a period."""
        for name, closure in (("walker", "legs"), ("names that are swapped", "names")):
            problem, _ = orbit(name)
            assert problem.whole == (closure, 2)
            _, twice, _, _ = self.repeated(name, 2)
            assert twice.whole == ("full", 1)
            _, thrice, _, _ = self.repeated(name, 3)
            assert thrice.whole == (closure, 2)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("laps", [1, 2, 3])
    def test_a_start_that_looks_at_several_laps_finds_the_orbit(self, laps):
        """A simulation of several periods of the ball, from its orbit: one bounce a period all the same."""
        problem, z = orbit("time-dependent guard and reset")
        values = problem.values_of(z)
        period = 2.0 * math.pi / values["omega"]
        passed = laps * period - float(z[3])
        at = passed - period * math.floor(passed / period)
        state = [z[0] + z[1] * at - 0.5 * 9.81 * at**2, z[1] - 9.81 * at]
        (branch,) = diagram(
            BALL, "A", (0.0094, 0.0096), state, values, until=(laps + 0.5) * period, max_points=5
        )
        assert branch.info.signature == ("bounce",)
        assert branch.info.subharmonic == 1
