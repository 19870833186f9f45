"""The state that stands for an orbit, its observables and marks of them: the bouncing ball in closed form."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from hybrid_machines import CASES, TANK, orbit
from hybrid_runs import ACCURACY, assert_met, branch_of, machine, solution

import contwalk as cw
from contwalk.branch import Branch
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.system import Condition, State, Transition

G, OMEGA, E, A = 9.81, 35.0, 0.5, 0.0095
SPEED = math.pi * G / OMEGA  # after a bounce, and down before it
PHASE = math.acos(SPEED * (1.0 - E) / ((1.0 + E) * A * OMEGA))
HEIGHT = A * math.sin(PHASE)
# An orbit is solved for to a hundred times the accuracy.
KNOWN = 100.0 * ACCURACY


def at_zero() -> tuple[float, float]:
    passed = (2.0 * math.pi - PHASE) / OMEGA
    return HEIGHT + SPEED * passed - 0.5 * G * passed**2, SPEED - G * passed


def ball() -> tuple[HybridOrbit, np.ndarray]:
    return orbit("time-dependent guard and reset")


@cache
def branch(marks: tuple = (), **options) -> Branch:
    found = {name: list(values) for name, values in marks}
    return branch_of(
        BALL,
        "A",
        (0.00839, 0.0121),
        at_zero(),
        {"A": A, "e": E, "omega": OMEGA, "g": G},
        marks=found,
        **options,
    )


def reported(**where) -> np.ndarray:
    problem, z = ball()
    chosen = replace(problem.discretization, **where)
    return problem.varied(discretization=chosen).reported(z)


class TestReported:
    def test_before_the_first_event_by_default(self):
        np.testing.assert_allclose(reported(), [HEIGHT, -SPEED], rtol=0, atol=KNOWN)

    @pytest.mark.parametrize(("side", "speed"), [("before", -SPEED), ("after", SPEED)])
    def test_beside_an_event(self, side, speed):
        np.testing.assert_allclose(
            reported(report_event=("bounce", side)), [HEIGHT, speed], rtol=0, atol=KNOWN
        )

    @pytest.mark.parametrize("direction", [1.0, -1.0])
    def test_where_a_state_passes_a_value(self, direction):
        """Height 0.02 m on the way up and down: the speed is that of energy."""
        speed = math.sqrt(SPEED**2 - 2.0 * G * (0.02 - HEIGHT))
        np.testing.assert_allclose(
            reported(report_at=(0, 0.02, direction)), [0.02, direction * speed], rtol=0, atol=KNOWN
        )

    def test_at_the_top(self):
        top = HEIGHT + SPEED**2 / (2.0 * G)
        np.testing.assert_allclose(reported(report_at=(1, 0.0, -1.0)), [top, 0.0], rtol=0, atol=KNOWN)

    def test_nowhere(self):
        """A value that is not reached; at a bounce the velocity jumps, and passes nothing on the way up."""
        assert np.all(np.isnan(reported(report_at=(0, 1.0, 1.0))))
        assert np.all(np.isnan(reported(report_at=(1, 0.0, 1.0))))

    def test_states_that_do_not_exist_are_zero(self):
        problem, z = orbit("different numbers of states")
        for event, side, missing in (
            ("empty", "before", "v"),
            ("empty", "after", "z"),
            ("landed", "before", "z"),
            ("full", "after", "v"),
        ):
            chosen = replace(problem.discretization, report_event=(event, side))
            state = problem.varied(discretization=chosen).reported(z)
            for name, value in zip(TANK.state_names, state, strict=True):
                assert (value == 0.0) == (name == missing) or (name == "y" and event in ("landed", "empty"))

    def test_conditions_see_them_as_zero_too(self):
        """The tank has no water after `empty`; what a condition is told of it is neither old nor anything."""
        case = CASES["different numbers of states"]
        dry = Condition("dry", lambda t, x, p: 1.0 + x[1], "empty", side="after")
        system = replace(TANK, conditions=(dry,))
        problem, z = solution(
            system, case.free, case.state, case.parameters, accuracy=ACCURACY, **case.options
        )
        told = [view.conditions for view in problem.view(z)]
        assert [c for c in told if c] == [{"dry": 1.0}]

    def test_reported_states_are_those_of_the_rows(self):
        found = branch_of(
            BALL,
            "A",
            (0.0094, 0.0096),
            at_zero(),
            {"A": A, "e": E},
            report_event=("bounce", "after"),
            max_points=10,
        )
        np.testing.assert_allclose(found["v"], SPEED, rtol=0, atol=KNOWN)
        np.testing.assert_array_equal(found["v"], found.points["unknowns"][:, 1])


def swinging(t, x, p, dx):
    """A pendulum in honey, and what follows cos t: (cos t + sin t) / 2."""
    dx[0] = p.a * np.cos(t) - np.sin(x[0])
    dx[1] = -x[1] + np.cos(t)


def test_an_angle_passes_a_value_in_any_turn_and_where_the_orbit_begins():
    """Of a machine whose motion meets no event."""
    system = machine(
        (State("phi", period=2.0 * math.pi), "y"),
        {"a": 0.5},
        {"run": swinging},
        [Transition("far", "run", "run", lambda t, x, p: x[1] + 100.0)],
        period=lambda p: 2.0 * math.pi,
    )
    problem, z = solution(system, "a", [0.3, 0.0], until="settled")

    def told(value, direction):
        chosen = replace(problem.discretization, report_at=(0, value, direction))
        return problem.varied(discretization=chosen).reported(z)

    turn = np.array([2.0 * math.pi, 0.0])
    for direction in (1.0, -1.0):
        here = told(0.1, direction)
        assert here[0] == pytest.approx(0.1, abs=1e-13)  # stepped to, by the secant method
        assert told(0.1 + turn[0], direction) == pytest.approx(here + turn, abs=1e-13)
        assert told(0.1 - turn[0], direction) == pytest.approx(here - turn, abs=1e-13)
    # It begins on its way up, at y = 1 / 2.
    assert told(z[0], 1.0) == pytest.approx([z[0], 0.5], abs=KNOWN)
    assert told(z[0] + turn[0], 1.0) == pytest.approx([z[0] + turn[0], 0.5], abs=KNOWN)


@pytest.mark.parametrize("name", CASES)
def test_motion_has_both_instants_of_each_event(name):
    """Times grow, and stand still between the two sides of an event alone; ends meet."""
    problem, z = orbit(name)
    t, x = problem.motion_of(z)
    assert x.shape == (len(t), len(problem.system.states))
    steps = np.diff(t)
    assert np.all(steps >= 0.0)
    assert np.sum(steps == 0.0) >= problem.layout.legs - 1
    assert t[-1] - t[0] == pytest.approx(problem.duration(z), rel=1e-12)
    starts = problem.starting_times(z)
    np.testing.assert_allclose(t[0], starts[0], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(x[0], problem.first_state(z))


class TestMarks:
    """Values of the parameter, of observables of the motion and at an event, and of multipliers."""

    def test_of_the_parameter(self):
        (point,) = [p for p in branch((("A", (0.0105,)),)).special_points if p.label == "UZ"]
        assert point.parameters["A"] == 0.0105
        phase = math.acos(SPEED * (1.0 - E) / ((1.0 + E) * 0.0105 * OMEGA))
        # A mark is computed to the accuracy itself.
        assert point.state["y"] == pytest.approx(0.0105 * math.sin(phase), abs=ACCURACY)
        assert point.state["v"] == pytest.approx(-SPEED, abs=ACCURACY)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("phase", [0.45, 0.6])
    def test_of_an_observable_at_an_event(self, phase):
        (point,) = [p for p in branch((("impact_phase", (phase,)),)).special_points if p.label == "UZ"]
        assert_met(point, "A", SPEED * (1.0 - E) / ((1.0 + E) * OMEGA * math.cos(phase)))
        assert point.kind == "observable"

    @pytest.mark.long
    def test_of_an_observable_of_the_motion(self):
        """Largest height: that of the bounce and of the flight."""
        top = 0.0445
        sine = top - SPEED**2 / (2.0 * G)
        (point,) = [p for p in branch((("y_max", (top,)),)).special_points if p.label == "UZ"]
        cosine = SPEED * (1.0 - E) / ((1.0 + E) * OMEGA)
        assert_met(point, "A", math.hypot(sine, cosine), accuracy=3.0 * ACCURACY)

    def test_of_the_largest_multiplier(self):
        """Both are complex and of modulus e between two amplitudes; beyond, the trace tells."""
        (first, second) = [p for p in branch((("max_abs", (0.8,)),)).special_points if p.label == "UZ"]
        for point, trace in ((first, 0.8 + E**2 / 0.8), (second, -0.8 - E**2 / 0.8)):
            height = (1.0 + E**2 - trace) * G / ((1.0 + E) ** 2 * OMEGA**2)
            cosine = SPEED * (1.0 - E) / ((1.0 + E) * OMEGA)
            assert_met(point, "A", math.hypot(height, cosine))

    @pytest.mark.long
    def test_of_the_split(self):
        """trace^2 = 4 e^2: where the pair turns complex, and real again."""
        (first, second) = [p for p in branch((("split", (0.0,)),)).special_points if p.label == "UZ"]
        for point, trace in ((first, 2.0 * E), (second, -2.0 * E)):
            height = (1.0 + E**2 - trace) * G / ((1.0 + E) ** 2 * OMEGA**2)
            cosine = SPEED * (1.0 - E) / ((1.0 + E) * OMEGA)
            assert_met(point, "A", math.hypot(height, cosine))
            # The square root of what is left of the trace.
            assert abs(point.spectrum[0] - point.spectrum[1]) < 1e-4
            assert point.spectrum[0].real == pytest.approx(0.5 * trace, abs=1e-4)

    def test_of_a_margin(self):
        """The least value of a watched guard: height over 0.0445 - y_max."""
        from contwalk.system import Transition

        low = Transition("ceiling", "flight", "flight", lambda t, x, p: 0.05 - x[0], role="watched")
        system = replace(BALL, transitions=(*BALL.transitions, low))
        found = branch_of(
            system, "A", (0.0088, 0.0118), at_zero(), {"A": A, "e": E}, marks={"ceiling": [0.0055]}
        )
        (point,) = [p for p in found.special_points if p.label == "UZ"]
        sine = 0.0445 - SPEED**2 / (2.0 * G)
        cosine = SPEED * (1.0 - E) / ((1.0 + E) * OMEGA)
        assert_met(point, "A", math.hypot(sine, cosine), accuracy=3.0 * ACCURACY)


@pytest.mark.parametrize("name", ["y_max", "impact_phase", "impact_speed", "split", "max_abs"])
def test_rates_of_observables_along_the_branch(name):
    """Derivative along the tangent, against the slope of the branch's own rows."""
    problem, _ = ball()
    points = list(cw.points(problem, at_zero(), (0.0088, 0.0118), max_points=8, max_step=0.02, step=0.02))
    found = [p.state.sample for p in points if p.special is None]
    k = len(found) // 2
    own = [problem.observable_names.index(name), name]
    s = [float(np.linalg.norm((q.z - found[k].z) / q.weights)) * np.sign(i - k) for i, q in enumerate(found)]
    values = [float(q.observables[own[0]]) for q in found]
    slope = np.polynomial.Polynomial.fit(s, values, 4).deriv()(0.0)
    there = problem.adapted_to(found[k].z, found[k].weights)
    rate = there.rate(name, found[k])
    # Chords instead of arcs, and a quartic: some parts in a thousand of the largest slope around.
    size = max(abs(np.polynomial.Polynomial.fit(s, values, 1).deriv()(0.0)), 1e-6)
    assert rate == pytest.approx(slope, rel=0.02, abs=0.02 * size)
