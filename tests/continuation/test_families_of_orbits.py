"""Starts that no correction can isolate: a family of orbits, two events at once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Mode, Neutral, Parameter, State, System, Transition

# A shaken mass on a spring (x, v), and a ball in a cage on it (y, w) that nothing moves between impacts.


def shaken(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = math.cos(1.3 * t) - 0.2 * x[1] - x[0]
    dx[2] = x[3]
    dx[3] = 0.0


def knock(t, x, p, after):
    after[0], after[1], after[2], after[3] = x[0], x[1], x[2], 2.0 * x[1] - x[3]


def along(t, x, p, v):
    v[0], v[1], v[2], v[3] = 0.0, 0.0, 1.0, 0.0


@pytest.mark.parametrize(("neutral", "differ"), [((), "y"), ((Neutral("along", along, pin="y"),), "w")])
def test_orbits_that_come_in_a_family_are_told_to(neutral, differ):
    """With the place held the speed is left: one who drifts along sees another orbit."""
    system = machine(
        ["x", "v", "y", "w"],
        {"half": 9.0},
        {"free": shaken},
        [
            Transition("right", "free", "free", lambda t, x, p: p.half - (x[2] - x[0]), reset=knock),
            Transition("left", "free", "free", lambda t, x, p: p.half + (x[2] - x[0]), reset=knock),
        ],
        period=lambda p: 2.0 * math.pi / 1.3,
        neutral=neutral,
    )
    outcome = opened_orbit(
        system, {"half": 9.0}, "half", np.zeros(4), Settings(range=(8.0, 12.0)), until="settled"
    )
    assert isinstance(outcome, Outcome)
    assert outcome.message.startswith("The start leads to no solution. Orbits come in a family there")
    assert f"they differ in {differ}." in outcome.message
    assert "Neutral" in outcome.message
    assert "Give a state nearer" not in outcome.message


def twins(t, x, p, dx):
    for k in (0, 2):
        dx[k] = x[k + 1]
        dx[k + 1] = math.cos(1.3 * t) - 0.2 * x[k + 1] - x[k]


def hits(k):
    def hit(t, x, p, after):
        for i in range(4):
            after[i] = -0.8 * x[i] if i == k + 1 else x[i]

    return hit


def test_two_events_at_once_are_named():
    system = machine(
        ["a", "va", "b", "vb"],
        {"gap": 1.0},
        {"free": twins},
        [
            Transition("ka", "free", "free", lambda t, x, p: 1.0 - x[0], reset=hits(0)),
            Transition("kb", "free", "free", lambda t, x, p: p.gap - x[2], reset=hits(2)),
        ],
        period=lambda p: 2.0 * math.pi / 1.3,
    )
    outcome = opened_orbit(
        system, {"gap": 1.0}, "gap", np.zeros(4), Settings(range=(0.5, 1.6)), until="settled"
    )
    assert isinstance(outcome, Outcome)
    assert "'ka' and 'kb' happen at once" in outcome.message
    assert "another value of a parameter" in outcome.message


def smooth(field, names, **parameters):
    return System(
        name="small",
        states=tuple(State(name) for name in names),
        parameters=tuple(Parameter(name, value) for name, value in parameters.items()),
        modes=(Mode("only", field),),
    )


def refused(system, free, state, **given):
    parameters = system.defaults()
    value = parameters[free]
    outcome = opened_orbit(
        system, parameters, free, np.array(state), Settings(range=(0.5 * value, 2.0 * value)), **given
    )
    assert isinstance(outcome, Outcome)
    assert (outcome.status, outcome.reason) == ("failed", "no_convergence")
    return outcome.message


def pendulum(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g * math.sin(x[0])


def test_what_a_pendulum_conserves_is_seen_in_its_second_multiplier():
    """A year of periods would do: each amplitude has its own, and none is the one that is meant."""
    message = refused(smooth(pendulum, "qw", g=9.81), "g", [1.0, 0.0], until="settled")
    assert "they differ in q, w. They last differently long. A second multiplier is 1" in message
    assert "conserved=(Conserved(" in message
    assert "continue: {parameter: energy}" in message
    assert "images of each other" not in message


def test_the_left_vector_is_the_gradient_of_the_energy():
    """Two oscillators on an axis of the plane: (omega^2 x, v) at the start, whichever it is."""

    def springs(t, x, p, dx):
        dx[0], dx[1] = x[2], x[3]
        dx[2], dx[3] = -4.0 * x[0] - p.k * x[0] ** 3, -3.0 * x[1] * (1.0 + p.k * x[0] ** 2)

    system, period = smooth(springs, "xyuv", k=0.0), math.pi
    parameters = {"k": 0.0}
    outcome = opened_orbit(
        system, parameters, "k", np.array([1.0, 0.0, 0.5, 0.0]), Settings(range=(-1, 1)), period=period
    )
    assert isinstance(outcome, Outcome)
    assert "with the left vector x +1, u +0.125:" in outcome.message  # 4 x = 4, u = 0.5


def test_orbits_that_last_equally_long_may_be_images_too():
    """Of a linear oscillator the scaling is a neutral direction as well: both are offered."""

    def oscillator(t, x, p, dx):
        dx[0], dx[1] = p.w * x[1], -p.w * x[0]

    message = refused(smooth(oscillator, "xy", w=2.0), "w", [1.0, 0.0], period=math.pi)
    assert "last differently long" not in message
    assert "conserved=(Conserved(" in message
    assert "If they are images of each other instead: Declare a Neutral direction" in message


def test_a_ball_without_losses_is_told_what_it_conserves():
    def falls(t, x, p, dx):
        dx[0], dx[1] = x[1], -p.g

    def returned(t, x, p, after):
        after[0], after[1] = x[0], -x[1]

    bounce = Transition("bounce", "flight", "flight", lambda t, x, p: x[0], reset=returned)
    system = machine(["y", "v"], {"g": 9.81}, {"flight": falls}, [bounce])
    message = refused(system, "g", [1.0, 0.0], until="settled")
    assert "shrink to nothing" not in message
    # After the bounce the gradient of g y + v^2/2 is (g, v): v = sqrt(2 g) there.
    assert f"with the left vector y +1, v {math.sqrt(2.0 / 9.81):+.3g}:" in message
    assert "(itinerary: bounce)" in message


def test_a_solution_that_converges_at_once_may_be_one_of_many():
    """Newton's method does not move from an exact solution; a system of its kind has no branch there."""
    message = refused(smooth(pendulum, "qw", g=1.0), "g", [0.0, 1e-3], period=2.0 * math.pi)
    assert "come in a family" in message
