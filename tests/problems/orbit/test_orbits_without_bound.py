"""Families of orbits that run to infinity at a finite parameter, those that do not, and what is claimed."""

import re
import warnings

import numpy as np
import pytest
from hybrid_runs import diagram, machine
from small_systems import bifurcations, small_problem

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System, Transition

pytestmark = pytest.mark.slow

TURN = 2.0 * np.pi


def told(branch):
    """The limit that the end names, and its error."""
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "unbounded"), branch.outcome
    found = re.search(r"tends to (\S+) \+- (\S+), by", branch.outcome.message)
    return float(found[1]), float(found[2])


def round_(x, dx, growth, turning):
    dx[0] = growth * x[0] - turning * x[1]
    dx[1] = growth * x[1] + turning * x[0]


def cubic(t, x, p, dx):
    """A radius of 1 / sqrt(a)."""
    round_(x, dx, 1.0 - p.a * (x[0] ** 2 + x[1] ** 2), 2.0)


def pole(t, x, p, dx):
    """A radius of 1 / (a - 0.3) round (1, 0)."""
    x = [x[0] - 1.0, x[1]]
    round_(x, dx, 1.0 - (p.a - 0.3) * np.sqrt(x[0] ** 2 + x[1] ** 2), 2.0)


def slower(t, x, p, dx):
    """A radius of 1 / (a - 0.3), and a period of 2 pi (1 + radius^2)."""
    size = x[0] ** 2 + x[1] ** 2
    round_(x, dx, (1.0 - (p.a - 0.3) ** 2 * size) / (1.0 + size), 1.0 / (1.0 + size))


def faster(t, x, p, dx):
    """A radius of 1 / sqrt(a), and a period of 2 pi a / (1 + a)."""
    size = x[0] ** 2 + x[1] ** 2
    round_(x, dx, 1.0 - p.a * size, 1.0 + size)


def logarithm(t, x, p, dx):
    """A radius of -log(a)."""
    round_(x, dx, 1.0 - p.a * np.exp(np.sqrt(x[0] ** 2 + x[1] ** 2)), 2.0)


def rayleigh(t, x, p, dx):
    """An ellipse of a size of 1 / sqrt(a), nearly."""
    dx[0] = x[1]
    dx[1] = x[1] - p.a * x[1] ** 3 - 4.0 * x[0]


AUTONOMOUS = [
    (cubic, 1.0, [1.0, 0.0], np.pi, 0.0),
    (pole, 1.0, [1.0 + 1.0 / 0.7, 0.0], np.pi, 0.3),
    (slower, 1.0, [1.0 / 0.7, 0.0], TURN * (1.0 + 1.0 / 0.49), 0.3),
    (faster, 1.0, [1.0, 0.0], np.pi, 0.0),
    (logarithm, 0.5, [np.log(2.0), 0.0], np.pi, 0.0),
    (rayleigh, 1.0, [0.0, 1.2], 3.2, 0.0),
]


@pytest.mark.drawn(2)
@pytest.mark.parametrize(("field", "value", "start", "period", "limit"), AUTONOMOUS)
def test_cycles_grow_without_bound(field, value, start, period, limit):
    problem = cw.PeriodicOrbit(small_problem(field, "xy", {"a": value}, "a").system, {"a": value}, "a")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        branch = cw.continue_branch(problem, start, (-1.0, 2.0), "backward", period=period)
    found, error = told(branch)
    assert abs(found - limit) <= error <= 1e-9
    assert not bifurcations(branch)


def resonant(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - p.c * x[1] + np.cos(p.w * t)


def forced(field, **parameters):
    return System(
        "small",
        states=(State("x"), State("v")),
        parameters=tuple(Parameter(name, value) for name, value in parameters.items()),
        modes=(Mode("only", field),),
        period=lambda p: 2.0 * np.pi / p.w,
    )


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("free", "values", "start", "towards", "limit"),
    [
        ("c", {"c": 1.0, "w": 1.0}, [0.0, 1.0], "backward", 0.0),
        ("w", {"c": 0.0, "w": 0.5}, [1.0 / 0.75, 0.0], "forward", 1.0),
    ],
)
def test_resonances_grow_without_bound(free, values, start, towards, limit):
    problem = cw.PeriodicOrbit(forced(resonant, **values), values, free)
    found, error = told(cw.continue_branch(problem, start, (-1.0, 2.0), towards))
    assert abs(found - limit) <= error <= 1e-9


def test_a_resonance_that_grows_to_a_million_and_comes_back_is_followed():
    values = {"c": 1e-6, "w": 0.5}
    problem = cw.PeriodicOrbit(forced(resonant, **values), values, "w")
    branch = cw.continue_branch(problem, [1.0 / 0.75, 0.0], (0.3, 2.0), "forward")
    assert branch.outcome.reason == "bound"
    assert np.abs(branch["x"]).max() > 3e5


def peak(t, x, p, dx):
    """A radius of 1 / sqrt(a^2 + 1e-12)."""
    round_(x, dx, 1.0 - (p.a**2 + 1e-12) * (x[0] ** 2 + x[1] ** 2), 2.0)


@pytest.mark.long
def test_cycles_that_grow_to_a_million_and_come_back_are_followed():
    problem = cw.PeriodicOrbit(small_problem(peak, "xy", {"a": 1.0}, "a").system, {"a": 1.0}, "a")
    branch = cw.continue_branch(problem, [1.0, 0.0], (-1.0, 2.0), period=np.pi)
    assert branch.outcome.reason == "bound"
    assert max(abs(branch["x"])) == pytest.approx(1e6, rel=0.1)


def pushed(sign):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 2.0 * p.z * x[1] + sign

    return field


def relay_of_the_velocity():
    """Half a turn takes A + 1 from one side to A - 1 on the other: A = (1 + q) / (1 - q)."""
    return machine(
        ["x", "v"],
        {"z": 0.1},
        {"up": pushed(1.0), "down": pushed(-1.0)},
        [
            Transition("top", "up", "down", lambda t, x, p: x[1], "falling"),
            Transition("bottom", "down", "up", lambda t, x, p: x[1], "rising"),
        ],
    )


def relay_with_hysteresis():
    """Tsypkin's oscillation: what damping takes is what the delay by a threshold of 0.2 gives."""
    return machine(
        ["x", "v"],
        {"z": 0.1},
        {"up": pushed(1.0), "down": pushed(-1.0)},
        [
            Transition("high", "up", "down", lambda t, x, p: x[0] - 0.2, "rising"),
            Transition("low", "down", "up", lambda t, x, p: x[0] + 0.2, "falling"),
        ],
    )


def flight(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0


def driven_ball(restitution):
    """A ball that each impact pushes: v = 0.1 / (1 - e), and a period of 2 v."""

    def bounce(t, x, p, x_plus):
        x_plus[0] = 0.0
        x_plus[1] = -restitution(p) * x[1] + 0.1

    hit = Transition("hit", "flight", "flight", lambda t, x, p: x[0], "falling", bounce)
    return machine(["y", "v"], {"e": 0.5}, {"flight": flight}, [hit])


def kicked(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = p.e * x[1] + 1.0


def kicked_oscillator():
    """v = 1 / (1 - e q), q = exp(-2 pi z / sqrt(1 - z^2)), right after each kick."""
    kick = Transition("kick", "on", "on", lambda t, x, p: x[0], "rising", kicked)
    return machine(["x", "v"], {"z": 0.05, "e": 1.0}, {"on": pushed(0.0)}, [kick])


def wound(t, x, p, dx):
    pushed(0.0)(t, x, p, dx)
    dx[2] = 1.0


def ticked(t, x, p, x_plus):
    x_plus[0], x_plus[1], x_plus[2] = x[0], x[1] + 1.0, 0.0


def kicked_by_a_clock():
    tick = Transition("tick", "on", "on", lambda t, x, p: x[2] - 2.0 * np.pi, "rising", ticked)
    return machine(["x", "v", "s"], {"z": 0.05}, {"on": wound}, [tick])


def rubbed(sign):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 0.1 * sign + np.cos(p.w * t)

    return field


def rubbed_at_resonance():
    """Den Hartog's oscillator: friction below pi / 4 of the force does not bound the resonance."""
    return machine(
        ["x", "v"],
        {"w": 0.8},
        {"forth": rubbed(1.0), "back": rubbed(-1.0)},
        [
            Transition("top", "forth", "back", lambda t, x, p: x[1], "falling"),
            Transition("bottom", "back", "forth", lambda t, x, p: x[1], "rising"),
        ],
        period=lambda p: 2.0 * np.pi / p.w,
    )


def shaken(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - p.c * x[1] + np.cos(2.0 * t)


def mirrored(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -x[1]


def shaken_against_a_stop():
    """A stop at rest doubles the frequency: the force resonates with it."""
    hit = Transition("hit", "on", "on", lambda t, x, p: x[0], "falling", mirrored)
    return machine(["x", "v"], {"c": 0.3}, {"on": shaken}, [hit], period=lambda p: np.pi)


SETTLED = "settled"
MACHINES = {
    "relay": (relay_of_the_velocity, "z", (-0.5, 0.5), "down", [-1.0, 0.5], "up", SETTLED, 0.0),
    "hysteresis": (relay_with_hysteresis, "z", (-0.5, 0.5), "down", [-1.0, 0.5], "up", SETTLED, 0.0),
    "ball": (lambda: driven_ball(lambda p: p.e), "e", (0.0, 1.5), "up", [1.0, 0.0], "flight", SETTLED, 1.0),
    "damping": (kicked_oscillator, "z", (-0.5, 0.5), "down", [1.0, 1.0], "on", SETTLED, 0.0),
    "gain": (
        kicked_oscillator,
        "e",
        (0.5, 2.0),
        "up",
        [1.0, 1.0],
        "on",
        SETTLED,
        float(np.exp(0.1 * np.pi / np.sqrt(1.0 - 0.05**2))),
    ),
    "clock": (kicked_by_a_clock, "z", (-0.5, 0.5), "down", [1.0, 1.0, 0.0], "on", SETTLED, 0.0),
    "friction": (rubbed_at_resonance, "w", (0.7, 1.5), "up", [0.0, 0.1], "forth", 200.0, 1.0),
    "stop": (shaken_against_a_stop, "c", (-0.5, 0.5), "down", [1.0, 0.0], "on", SETTLED, 0.0),
}


@pytest.mark.drawn(2)
@pytest.mark.parametrize("name", MACHINES)
def test_motions_with_events_grow_without_bound(name):
    make, free, range_, direction, start, mode, until, limit = MACHINES[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        branches = diagram(make(), free, range_, start, direction=direction, mode=mode, until=until)
    assert len(branches) == 1
    found, error = told(branches[0])
    assert abs(found - limit) <= error <= 1e-8
    assert not bifurcations(branches[0])
    assert all(branches[0].points["admissible"])


def test_a_ball_that_flies_to_a_thousand_and_comes_down_again_is_followed():
    """v = 0.1 / (e^2 + 1e-4)."""
    system = driven_ball(lambda p: 1.0 - p.e**2 - 1e-4)
    (branch,) = diagram(system, "e", (-0.7, 0.7), [1.0, 0.0], mode="flight", until=SETTLED, max_points=1000)
    assert branch.outcome.reason == "bound", branch.outcome
    assert np.abs(branch["v"]).max() > 500.0
