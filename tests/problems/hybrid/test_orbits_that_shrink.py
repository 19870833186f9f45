"""Families of orbits with events that shrink to a point, or to no time: where they end, and its error."""

import re

import numpy as np
import pytest
from hybrid_runs import branch_of, machine

from contwalk.system import Transition


def told(branch, name):
    """The parameter at which the family ends, and its error."""
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "shrunk"), branch.outcome
    found = re.search(rf"near {name} = (\S+) \+- ([^\s:]+):", branch.outcome.message)
    return float(found[1]), float(found[2])


def oscillator(damping=0.0, centre=0.0):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -(x[0] - centre) - damping * x[1]

    return field


def kicked(gain, damping=0.0, centre=0.0, **parameters):
    """An oscillator that is kicked where it passes its centre upwards."""

    def reset(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = gain(x[1], p)

    kick = Transition("kick", "on", "on", lambda t, x, p: x[0] - centre, "rising", reset)
    return machine(["x", "v"], parameters, {"on": oscillator(damping, centre)}, [kick])


def corner():
    """Foci of two kinds on both sides of x = 0, whose equilibrium is on the border for mu = 0."""

    def left(t, x, p, dx):
        dx[0], dx[1] = -x[0] - x[1], x[0] - p.mu

    def right(t, x, p, dx):
        dx[0], dx[1] = 0.4 * x[0] - x[1], x[0] - p.mu

    def border(t, x, p):
        return x[0]

    between = [
        Transition("enters", "left", "right", border, "rising"),
        Transition("leaves", "right", "left", border, "falling"),
    ]
    return machine(["x", "y"], {"mu": 0.5}, {"left": left, "right": right}, between)


def shaken():
    """A mass beside a stop at its place of rest, shaken by a force of mu - 0.1."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -(x[0] - 3.0) - 0.1 * x[1] + (p.mu - 0.1) * np.cos(2.0 * t)

    def bounce(t, x, p, x_plus):
        x_plus[0], x_plus[1] = x[0], -0.8 * x[1]

    hit = Transition("hit", "on", "on", lambda t, x, p: x[0] - 3.0, "falling", bounce)
    return machine(["x", "v"], {"mu": 0.5}, {"on": field}, [hit], period=lambda p: np.pi)


def relays(force):
    """A relay that follows the velocity's sign."""

    def up(t, x, p, dx):
        dx[0], dx[1] = x[1], -x[0] - x[1] ** 3 + force(p)

    def down(t, x, p, dx):
        dx[0], dx[1] = x[1], -x[0] - x[1] ** 3 - force(p)

    def velocity(t, x, p):
        return x[1]

    between = [
        Transition("top", "up", "down", velocity, "falling"),
        Transition("bottom", "down", "up", velocity, "rising"),
    ]
    return machine(["x", "v"], {"mu": 0.5}, {"up": up, "down": down}, between)


def delayed():
    """A relay of strength mu that notices the sign of x half a second late: clocks run on at rest."""

    def plant(sign):
        def field(t, x, p, dx):
            dx[0], dx[1], dx[2] = x[1], -0.5 * x[1] - x[0] + sign * p.mu, 1.0

        return field

    def noticed(t, x, p, x_plus):
        x_plus[0], x_plus[1], x_plus[2] = x[0], x[1], 0.0

    def sign(t, x, p):
        return x[0]

    def late(t, x, p):
        return x[2] - 0.5

    between = [
        Transition("rises", "up", "late_up", sign, "rising", noticed),
        Transition("turns", "late_up", "down", late, "rising"),
        Transition("falls", "down", "late_down", sign, "falling", noticed),
        Transition("turns_back", "late_down", "up", late, "rising"),
    ]
    modes = {"up": plant(1.0), "late_up": plant(1.0), "down": plant(-1.0), "late_down": plant(-1.0)}
    return machine(["x", "v", "s"], {"mu": 0.5}, modes, between)


TO_A_POINT = {
    "kick": (lambda: kicked(lambda v, p: v + p.mu, 0.1, mu=0.5), [-0.1, 1.0], "on", 0.0, 1e-8),
    "cubic": (lambda: kicked(lambda v, p: (1.0 + p.mu) * v - v**3, mu=0.3), [-0.1, 0.5], "on", 0.0, 1e-6),
    "aside": (
        lambda: kicked(lambda v, p: (0.9 + p.mu) * v - v**3, 0.0, 3.0, mu=0.3),
        [2.9, 0.5],
        "on",
        0.1,
        1e-6,
    ),
    "corner": (corner, [0.1, -0.3], "right", 0.0, 1e-8),
    "shaken": (shaken, [3.1, 0.5], "on", 0.1, 1e-8),
    "relay": (lambda: relays(lambda p: p.mu), [-0.4, 0.1], "up", 0.0, 1e-8),
    "delay": (delayed, [-0.4, 0.1, 0.0], "up", 0.0, 1e-8),
}


@pytest.mark.drawn(3)
@pytest.mark.parametrize("name", TO_A_POINT)
def test_a_family_that_shrinks_to_a_point_ends_there(name):
    make, start, mode, truth, accuracy = TO_A_POINT[name]
    branch = branch_of(make(), "mu", (-0.5, 1.0), start, direction="down", mode=mode, until="settled")
    value, error = told(branch, "mu")
    assert abs(value - truth) <= error <= accuracy
    assert [p.label for p in branch.special_points] == ["EP"]
    assert all(branch.points["admissible"])


def test_a_family_without_orbits_beyond_its_point_ends_there():
    """Of v' = v + mu sqrt(v) the amplitude falls like mu^2, and no root is real beyond."""
    system = kicked(lambda v, p: v + p.mu * np.sqrt(v), 0.1, mu=0.5)
    branch = branch_of(system, "mu", (-0.5, 1.0), [-0.1, 0.5], direction="down", mode="on", until="settled")
    value, error = told(branch, "mu")
    assert abs(value) <= error <= 1e-4


def test_a_machine_that_a_clock_kicks_passes_rest():
    """A clock ticks at rest, too: x changes its sign where the kicks do, and nothing ends."""

    def field(t, x, p, dx):
        dx[0], dx[1], dx[2] = x[1], -x[0] - 0.1 * x[1], 1.0

    def ticked(t, x, p, x_plus):
        x_plus[0], x_plus[1], x_plus[2] = x[0], x[1] + p.mu, 0.0

    tick = Transition("tick", "on", "on", lambda t, x, p: x[2] - 5.0, "rising", ticked)
    system = machine(["x", "v", "s"], {"mu": 0.5}, {"on": field}, [tick])
    start = [0.1, 0.5, 0.0]
    branch = branch_of(system, "mu", (-0.5, 1.0), start, direction="down", mode="on", until="settled")
    assert branch.outcome.reason == "bound", branch.outcome
    assert branch["mu"].min() == -0.5


def hysteresis(centre):
    def towards(sign):
        def field(t, x, p, dx):
            dx[0] = sign - 0.3 * (x[0] - centre) - 0.1

        return field

    between = [
        Transition("high", "up", "down", lambda t, x, p: x[0] - centre - p.h, "rising"),
        Transition("low", "down", "up", lambda t, x, p: x[0] - centre + p.h, "falling"),
    ]
    return machine(["x"], {"h": 0.5}, {"up": towards(1.0), "down": towards(-1.0)}, between)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("centre", [0.0, 2.0])
def test_a_family_that_shrinks_to_no_time_says_where(centre):
    start = [centre - 0.4]
    branch = branch_of(
        hysteresis(centre), "h", (-1.0, 1.0), start, direction="down", mode="up", until="settled"
    )
    value, error = told(branch, "h")
    assert abs(value) <= error <= 1e-8


@pytest.mark.drawn(1)
@pytest.mark.parametrize("speed", [1e-3, 1e-6, 5e-10])
@pytest.mark.parametrize("centre", [0.0, 3.0])
def test_a_start_with_a_tiny_kick_is_no_orbit_at_rest(speed, centre):
    """At rest the equations hold for every mu, with events without a speed: no such branch is followed."""
    system = kicked(lambda v, p: (1.0 + p.mu) * v - v**3, 0.0, centre, mu=-0.3)
    branch = branch_of(system, "mu", (-0.5, 1.0), [centre, speed], mode="on", event="kick")
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "no_convergence")
    assert len(branch.points) == 0
