"""Two forced machines that are their own images half a period of the forcing later, solved in closed form.

The rocking block (Hogan 1989, linearised): theta'' = theta - sign(theta) + beta cos(omega t), and where theta
is zero the velocity is multiplied by r. The impact pair: x'' = beta cos(omega t) between stops at -1 and 1,
where the velocity is multiplied by -r. Motions between impacts are sums of a cosine and two functions:
exponentials, or a straight line. Both orbits that are looked at meet one impact in each half of the cycle,
which lasts n half periods, n odd.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from hybrid_runs import machine
from scipy.optimize import brentq

from contwalk.system import Symmetry, System, Transition

OMEGA, BLOCK_R, PAIR_R = 5.0, 0.9, 0.5


def inversion(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def period(p):
    return 2.0 * math.pi / p.omega


def block(bias: float = 0.0, declared: bool = True) -> System:
    """The rocking block, with a steady push `bias`, which spoils its symmetry."""

    def tilted(side):
        def field(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = x[0] - side + p.beta * math.cos(p.omega * t) + bias

        return field

    def strike(t, x, p, after):
        after[0], after[1] = x[0], p.r * x[1]

    swap, events = {"right": "left", "left": "right"}, {"down": "up", "up": "down"}
    own = Symmetry("inversion", "spatial", inversion, modes=swap, events=events)
    return machine(
        ["theta", "v"],
        {"beta": 2.8, "omega": OMEGA, "r": BLOCK_R},
        {"right": tilted(1.0), "left": tilted(-1.0)},
        [
            Transition("down", "right", "left", lambda t, x, p: x[0], reset=strike),
            Transition("up", "left", "right", lambda t, x, p: -x[0], reset=strike),
        ],
        symmetries=(own,) if declared else (),
        period=period,
    )


def pair() -> System:
    """The impact pair."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.beta * math.cos(p.omega * t)

    def strike(t, x, p, after):
        after[0], after[1] = x[0], -p.r * x[1]

    events = {"low": "high", "high": "low"}
    return machine(
        ["x", "v"],
        {"beta": 2.8, "omega": OMEGA, "r": PAIR_R},
        {"free": field},
        [
            Transition("low", "free", "free", lambda t, x, p: 1.0 + x[0], reset=strike),
            Transition("high", "free", "free", lambda t, x, p: 1.0 - x[0], reset=strike),
        ],
        symmetries=(Symmetry("inversion", "spatial", inversion, events=events),),
        period=period,
    )


def spring_between_stops() -> System:
    """A damped mass on a spring between two stops, pushed harmonically; without impacts it is linear."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 0.2 * x[1] + p.beta * math.cos(p.omega * t)

    def strike(t, x, p, after):
        after[0], after[1] = x[0], -0.8 * x[1]

    events = {"low": "high", "high": "low"}
    return machine(
        ["x", "v"],
        {"beta": 1.0, "omega": 0.8},
        {"free": field},
        [
            Transition("low", "free", "free", lambda t, x, p: 1.0 + x[0], reset=strike),
            Transition("high", "free", "free", lambda t, x, p: 1.0 - x[0], reset=strike),
        ],
        symmetries=(Symmetry("inversion", "spatial", inversion, events=events),),
        period=period,
    )


@dataclass(frozen=True)
class Half:
    """Half a symmetric cycle: it begins at `start`, right after an impact, at `x` with the velocity `v`.

    `at_zero` is the state at t = 0, and `jacobian` the derivative by (start, v) of the map to the next
    impact, and on to its image.
    """

    start: float
    x: float
    v: float
    at_zero: tuple[float, float]
    jacobian: np.ndarray

    @property
    def breaks(self) -> float:
        """Zero where the multiplier of the half is -1."""
        return 1.0 + float(np.trace(self.jacobian)) + float(np.linalg.det(self.jacobian))


def half(beta: float, n: int, rocks: bool) -> Half:
    """Half of the stable one of the two symmetric orbits, of the block (`rocks`) or of the pair."""
    omega, lasts, r = OMEGA, n * math.pi / OMEGA, BLOCK_R if rocks else PAIR_R
    if rocks:
        g, begins, ends = beta / (1.0 + omega**2), 0.0, 0.0
        grow, push = math.exp(lasts), -1.0
        values = np.array([[1.0, 1.0], [grow, 1.0 / grow]])
        slopes = np.array([[1.0, -1.0], [grow, -1.0 / grow]])
        flow = np.array([[math.cosh(lasts), math.sinh(lasts)], [math.sinh(lasts), math.cosh(lasts)]])
        steady, sign = 1.0, 1.0  # the block rests on its edge at 1; the impact keeps the way it goes
    else:
        g, begins, ends, push = beta / omega**2, -1.0, 1.0, 0.0
        values = np.array([[1.0, 0.0], [1.0, lasts]])
        slopes = np.array([[0.0, 1.0], [0.0, 1.0]])
        flow = np.array([[1.0, lasts], [0.0, 1.0]])
        steady, sign = 0.0, -1.0
    # x = steady - g cos(omega t) + A f1 + B f2 with (A, B) = fixed + moving c, c = cos(omega start)
    fixed = np.linalg.solve(values, [begins - steady, ends - steady])
    moving = np.linalg.solve(values, [g, -g])
    # The image of what leaves the next impact, -sign r v1, is what leaves this one.
    share = sign * r
    constant = slopes[0] @ fixed + share * (slopes[1] @ fixed)
    of_c = slopes[0] @ moving + share * (slopes[1] @ moving)
    of_s = g * omega * (1.0 - share)
    angle = math.atan2(of_s, of_c) - sign * math.acos(-constant / math.hypot(of_s, of_c))
    c, s = math.cos(angle), math.sin(angle)
    a = fixed + moving * c
    v, arrives = g * omega * s + slopes[0] @ a, -g * omega * s + slopes[1] @ a
    pull = beta * c + (begins if rocks else 0.0) + push
    at_end = -beta * c + (ends if rocks else 0.0) + push
    columns = []
    for moved in (-flow @ np.array([v, pull]), flow @ np.array([0.0, 1.0])):
        later = -moved[0] / arrives
        columns.append([later, -share * (moved[1] + at_end * later)])
    start = angle % (2.0 * math.pi) / omega
    turn = -1.0 if start < lasts else 1.0  # half a cycle, or a whole one, after zero
    passed = lasts if start < lasts else 2.0 * lasts
    t, at = passed - start, omega * passed
    own = [math.exp(t), math.exp(-t)] if rocks else [1.0, t]
    rates = [math.exp(t), -math.exp(-t)] if rocks else [0.0, 1.0]
    x, y = steady - g * math.cos(at) + a @ own, g * omega * math.sin(at) + a @ rates
    return Half(start, begins, float(v), (turn * float(x), turn * float(y)), np.array(columns).T)


def breaking(n: int, rocks: bool, low: float, high: float) -> float:
    """The value of beta at which the symmetry is lost."""
    return brentq(lambda beta: half(beta, n, rocks).breaks, low, high, xtol=1e-14)
