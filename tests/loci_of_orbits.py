"""Systems whose curves of special points of orbits are known in closed form, and comparisons with them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import Mode, Parameter, State, System, Transition

ACCURACY = 1e-9
# Long steps: what is found does not depend on them.
FINE = {"discretization": cw.Discretization(accuracy=ACCURACY), "max_step": 0.4, "max_share": 0.1}
# Points of a branch are solved for on steps of a hundred times the accuracy of special points.
WALKED = 100.0 * ACCURACY


def parameters_of(branch: Branch, label: str) -> list[tuple[float, ...]]:
    """Both parameters of each special point of a kind."""
    return [
        tuple(p.parameters[name] for name in branch.info.free)
        for p in branch.special_points
        if p.label == label
    ]


def assert_at(
    branch: Branch, label: str, truths: Sequence[tuple[float, float]], slack: float = 1e-15
) -> None:
    """The points of a kind are those given, in some order, each parameter within its own estimated error.

    `slack` is added for the rounding of the truths themselves.
    """
    found = [p for p in branch.special_points if p.label == label]
    assert len(found) == len(truths), (label, parameters_of(branch, label))
    for truth in truths:
        point = min(found, key=lambda p: _apart(branch, p, truth))
        assert point.status == "located", point.note
        assert point.error == point.errors[branch.info.free[0]]
        for name, value in zip(branch.info.free, truth, strict=True):
            off = abs(point.parameters[name] - value)
            assert off <= point.errors[name] + slack * max(abs(value), 1.0), (label, name, off, point.errors)
            assert point.errors[name] <= 10.0 * ACCURACY * max(abs(value), 1.0), (label, name, point.errors)


def _apart(branch: Branch, point: SpecialPoint, truth: tuple[float, float]) -> float:
    return max(abs(point.parameters[name] - v) for name, v in zip(branch.info.free, truth, strict=True))


def labels(branch: Branch) -> list[str]:
    """Labels of the special points but the ends, sorted."""
    return sorted(p.label for p in branch.special_points if p.label != "EP")


def orbits(system: System, free: str) -> cw.PeriodicOrbit:
    """Orbits of a small system."""
    return cw.PeriodicOrbit(
        system, system.defaults(), free, discretization=cw.Discretization(accuracy=ACCURACY)
    )


def walked(
    system: System,
    free: str,
    start: Sequence[float],
    along: tuple[float, float],
    point: str,
    ranges: dict[str, tuple[float, float]],
    period: float,
) -> Branch:
    """The curve through a special point of the branch along one parameter."""
    branch = cw.continue_branch(orbits(system, free), start, along, period=period)
    return cw.continue_locus(system, branch, point, ranges, **FINE)


def studied(folder: Path, name: str, plugin: str, run: str) -> tuple[System, list[Branch], list[str]]:
    """The system of a plugin file, the branches of a run file over it, and the notes of the run."""
    (folder / f"{name}.py").write_text(plugin)
    (folder / "run.yaml").write_text(run)
    path = cw.run(cw.read_run_file(folder / "run.yaml", (), str(folder / f"{name}.h5"))).path
    with cw.open_database(path) as db:
        return cw.load_system(str(folder / f"{name}.py")), db.branches(), list(db.notes().values())


def folding() -> System:
    """r' = r (mu - 1 + a r^2 - r^4), phi' = 3 + 0.4 r^2: cycles fold at r^2 = a/2, mu = 1 - a^2/4."""

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        g, w = p.mu - 1.0 + p.a * s - s * s, 3.0 + 0.4 * s
        dx[0] = g * x[0] - w * x[1]
        dx[1] = w * x[0] + g * x[1]

    return small_system(field, "xy", {"mu": 0.9, "a": 1.0})


def cusped() -> System:
    """r' = r (lam + nu u - u^3) with u = r^2 - 1, phi' = 2: folds at lam^2 = 4 nu^3 / 27, a cusp at (0,
    0)."""

    def field(t, x, p, dx):
        u = x[0] ** 2 + x[1] ** 2 - 1.0
        g = p.lam + p.nu * u - u**3
        dx[0] = g * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + g * x[1]

    return small_system(field, "xy", {"lam": 0.0, "nu": 0.3})


def doubling() -> System:
    """A unit cycle in a Moebius band with doublings at lam = 1 - sigma^2/5, generalized at sigma = -3/2.

    As `orbit_systems.moebius` with beta kappa = 3/2.
    """
    beta, kappa, omega = 3.0, 0.5, 2.0

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        r = s**0.5
        cos, sin = x[0] / r, x[1] / r
        first = 0.5 * ((1.0 + cos) * x[2] + sin * x[3])
        second = 0.5 * (sin * x[2] + (1.0 - cos) * x[3])
        square = first * first + second * second
        g = 1.0 - s + kappa * square
        dx[0] = g * x[0] - omega * x[1]
        dx[1] = omega * x[0] + g * x[1]
        a = p.lam - 1.0 + 0.2 * p.sigma**2 + beta * (s - 1.0) + p.sigma * square
        dx[2] = a * first - 0.5 * (x[2] - first) - 0.5 * omega * x[3]
        dx[3] = a * second - 0.5 * (x[3] - second) + 0.5 * omega * x[2]

    return small_system(
        field, ("x", "y", State("z", scale=1.0), State("w", scale=1.0)), {"lam": 0.7, "sigma": -1.0}
    )


def turning() -> System:
    """A unit cycle with an oscillator across it: tori are born at lam = 1 - 3 nu^2/10, cos(theta) = cos(T
    nu).

    With T = 2 pi / 1.5 the resonances 1:4 and 1:3 are at nu = 0.375 and nu = 0.5; the cubic coefficient is
    zero at nu = 0.44.
    """
    beta, kappa, omega = 3.0, 0.5, 1.5

    def field(t, x, p, dx):
        s, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        g = 1.0 - s + kappa * q
        dx[0] = g * x[0] - omega * x[1]
        dx[1] = omega * x[0] + g * x[1]
        a = p.lam - 1.0 + 0.3 * p.nu**2 + beta * (s - 1.0) + (p.nu - 1.94) * q
        dx[2] = a * x[2] - p.nu * x[3]
        dx[3] = p.nu * x[2] + a * x[3]

    return small_system(
        field, ("x", "y", State("u", scale=1.0), State("v", scale=1.0)), {"lam": 0.6, "nu": 0.3}
    )


def map_as_machine(
    step: Callable, names: str, values: dict[str, float], *scales: float, scale: float = 1.0
) -> System:
    """A map as a machine: its field stands still, and once a period of one second a kick applies the map.

    `step(x, p)` returns the image; `scales` are those of the states, if not all have one.
    """

    def still(t, x, p, dx):
        for k in range(len(names)):
            dx[k] = 0.0 * x[k]

    def scaled(name: str, own: float) -> State:
        return State(name, scale=own)

    def clock(t, x, p):
        return (t % 1.0) - 0.5

    def kick(t, x, p, x_plus):
        for k, value in enumerate(step(x, p)):
            x_plus[k] = value

    return System(
        "map",
        about="a map as a machine",
        states=tuple(map(scaled, names, scales or [scale] * len(names))),
        parameters=tuple(Parameter(name, value) for name, value in values.items()),
        modes=(Mode("still", still),),
        transitions=(Transition("kick", "still", "still", clock, "rising", reset=kick),),
        period=lambda p: 1.0,
    )


def map_plugin(name: str, images: Sequence[str], values: dict[str, float]) -> str:
    """The text of a plugin of a map of x and y as a machine; `images` are written in x[0], x[1] and p."""
    kick = "\n".join(f"    x_plus[{k}] = {image}" for k, image in enumerate(images))
    parameters = ", ".join(f'Parameter("{key}", {value})' for key, value in values.items())
    return f"""
from contwalk.system import Mode, Parameter, State, System, Transition

def still(t, x, p, dx):
    dx[0] = 0.0 * x[0]
    dx[1] = 0.0 * x[1]

def clock(t, x, p):
    return (t % 1.0) - 0.5

def kick(t, x, p, x_plus):
{kick}

SYSTEM = System(
    "{name}",
    states=(State("x", scale=1.0), State("y", scale=1.0)),
    parameters=({parameters},),
    modes=(Mode("still", still),),
    transitions=(Transition("kick", "still", "still", clock, "rising", reset=kick),),
    period=lambda p: 1.0,
)
"""


HENON = ("x[1]", "p.alpha - p.beta * x[0] - x[1] ** 2")


def henon() -> System:
    """(x, y) -> (y, alpha - beta x - y^2)."""
    return map_as_machine(
        lambda x, p: (x[1], p.alpha - p.beta * x[0] - x[1] ** 2), "xy", {"alpha": 0.5, "beta": 0.3}
    )


def henon_fixed_point(alpha: float, beta: float) -> float:
    """The larger x = y of both."""
    return (-(1.0 + beta) + math.sqrt((1.0 + beta) ** 2 + 4.0 * alpha)) / 2.0


def largest(values: np.ndarray) -> float:
    """The largest modulus."""
    return float(np.max(np.abs(values)))
