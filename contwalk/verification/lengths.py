"""How long a critical vector is, as records count it: over the orbit, in halves of the states' ranges."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.verification.equations import Evaluation
from contwalk.verification.normal_forms import Told
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import EPSILON, Passage, soft

# Where a step is looked at, and twelve times the weights of Simpson's rule over its quarters and its halves.
QUARTERS = np.linspace(0.0, 1.0, 5)
SIMPSON = np.array([[1.0, 4.0, 2.0, 4.0, 1.0], [2.0, 0.0, 8.0, 0.0, 2.0]])
# The end of a step: time, state, deviation, and the rates of both.
_End = tuple[float, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def squared(equations: OrbitEquations, at: Evaluation, q: np.ndarray, value: complex) -> Told:
    """The mean square, over the closure and across the flow, of the deviation that starts as q, (n,).

    Of complex q, of both its parts together. After an event it is counted at so long after the event: under a
    force, where nothing is taken out along the flow, a deviation that is late has gone on less far. The error
    is what fewer instants make of the integral, and of the ranges: records know both by some instants.

    Parameters
    ----------
    value : complex
        The multiplier of q.
    """
    half, coarse = _halves(equations, at)
    through = _Through(equations, at, half)
    _, late = through.once(q, 0.0)
    (whole, rough), _ = through.once(q, late / value)
    (other, _), _ = _Through(equations, at, coarse).once(q, late / value)
    return Told(whole, abs(whole - rough) + abs(whole - other))


def _halves(equations: OrbitEquations, at: Evaluation) -> tuple[np.ndarray, np.ndarray]:
    """Halves of the ranges of all states over the whole orbit, its images included, shape (n,): where they
    turn inside of steps, and at quarters of steps alone.

    A state is zero in modes that do not have it. Of one that rests its declared scale, or its size; of one
    that is zero as well, the largest half of all.
    """
    p, found, quarters = equations.functions.parameters.at(equations.free), list[np.ndarray](), list[int]()
    system = equations.functions.system
    for leg in at.legs:
        own = list(system.states_of(leg.mode))
        for piece in leg.pieces:
            still = np.zeros_like(piece.states)
            for begin, end, _ in _steps(equations, piece, p, still):
                shares = np.concatenate([QUARTERS, _turning(begin, end)])
                inside = np.zeros((len(shares), len(system.states)))
                inside[:, own] = [_between(begin, end, share)[1] for share in shares]
                quarters += range(len(found), len(found) + len(QUARTERS))
                found += list(inside)
    states = np.array(found)
    fine, coarse = (_units(equations, _seen(equations, at, each)) for each in (states, states[quarters]))
    return fine, coarse


def _turning(begin: _End, end: _End) -> np.ndarray:
    """At which shares of a step its cubics have a state turn, shape (j,)."""
    lasts, moved = end[0] - begin[0], end[1] - begin[1]
    first, last = lasts * begin[3], lasts * end[3]
    a, b, c = 3.0 * (first + last - 2.0 * moved), 2.0 * (3.0 * moved - 2.0 * first - last), first
    with np.errstate(all="ignore"):
        root = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        shares = np.concatenate([root / a, c / root])
    return np.asarray(shares[(shares > 0.0) & (shares < 1.0)])


def _seen(equations: OrbitEquations, at: Evaluation, states: np.ndarray, images: int = 64) -> np.ndarray:
    """States of one closure, (m, n), with those of its images, so many at most."""
    system, p = equations.functions.system, equations.functions.parameters.at(equations.free)
    if not equations.image or any(len(system.states_of(leg.mode)) < len(system.states) for leg in at.legs):
        return states
    found, mode = [states], at.legs[0].mode
    image = equations.functions.jump(None, mode, mode, equations.image, equations.power)
    level = EPSILON**0.5 * float(np.max(np.abs(states)))
    for _ in range(images):
        states = np.array([image(0.0, x, p)[0] for x in states])
        if np.allclose(states, found[0], rtol=0.0, atol=level):
            break
        found.append(states)
    return np.vstack(found)


def _units(equations: OrbitEquations, states: np.ndarray) -> np.ndarray:
    """Half the range of each of some states, (m, n), or its size where it rests: shape (n,)."""
    half, sizes, system = 0.5 * np.ptp(states, axis=0), equations.scale, equations.functions.system
    declared = np.array([state.scale or 0.0 for state in system.states])
    at_rest = np.where(declared > 0.0, declared, sizes)
    at_rest = np.where(at_rest > 0.0, at_rest, half.max())
    return np.where(half > EPSILON**0.5 * sizes, half, at_rest)


class _Through:
    """Deviations of one orbit, leg by leg."""

    def __init__(self, equations: OrbitEquations, at: Evaluation, half: np.ndarray) -> None:
        self.equations, self.at, self.half = equations, at, half
        self.p = equations.functions.parameters.at(equations.free)
        self.total = sum(leg.duration for leg in at.legs)

    def once(self, own: np.ndarray, late: complex) -> tuple[tuple[float, float], complex]:
        """Its mean square by Simpson's rule over quarters and over halves of steps, and how late it comes to
        the last event.

        `own`, (n,), starts so `late`.
        """
        sums = np.zeros(2)
        for leg in self.at.legs:
            for piece in leg.pieces:
                deviations = piece.tangents[:, :, 1 : 1 + len(own)] @ own
                before = piece.modes[0] if piece.modes else leg.mode
                for begin, end, mode in _steps(self.equations, piece, self.p, deviations):
                    late = late if mode == before else self._late(before, mode, begin)
                    before = mode
                    each = [self._square(mode, *_between(begin, end, share), late) for share in QUARTERS]
                    sums += (end[0] - begin[0]) * (SIMPSON @ each) / 12.0
                own = piece.derivative[:, 1 : 1 + len(own)] @ own
            late = late if leg.late is None else complex(leg.late @ own)
            own = leg.jump @ own + leg.shift * late
        return (float(sums[0] / self.total), float(sums[1] / self.total)), late

    def _late(self, before: str, mode: str, at: _End) -> complex:
        """How late what deviates comes to the soft transition between two modes."""
        functions, (t, x, deviation, *_) = self.equations.functions, at
        found = [each for each in soft(functions, before) if each.target == mode]
        slope = functions.guard(found[0])(t, x, self.p)[1][0]
        by_x = slope[1 : 1 + len(x)]
        rate = slope[0] + by_x @ functions.field(before)(t, x, self.p)[0]
        return complex(-(by_x @ deviation) / rate)

    def _square(self, mode: str, t: float, x: np.ndarray, deviation: np.ndarray, late: complex) -> float:
        half = self.half[list(self.equations.functions.system.states_of(mode))]
        flow = self.equations.functions.field(mode)(t, x, self.p)[0] / half
        deviation = deviation / half + late * flow
        if not self.equations.forced:
            deviation = deviation - flow * (flow @ deviation) / (flow @ flow)
        return float(np.vdot(deviation, deviation).real)


def _steps(
    equations: OrbitEquations, piece: Passage, p: np.ndarray, deviations: np.ndarray
) -> Iterator[tuple[_End, _End, str]]:
    """Both ends of each step with deviations, (s, n), and its mode."""

    def end(k: int) -> _End:
        t, x, deviation = float(piece.times[k]), piece.states[k], deviations[k]
        flow, moved = equations.functions.field(mode)(t, x, p)
        return t, x, deviation, flow, moved[:, 1 : 1 + len(x)] @ deviation

    for k, mode in enumerate(piece.modes):
        yield end(k), end(k + 1), mode


def _between(begin: _End, end: _End, share: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Time, state and deviation inside of a step, by the cubic through both ends and their rates."""
    lasts, s = end[0] - begin[0], share
    values = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s**2 * (3.0 - 2.0 * s)
    rates = lasts * s * (1.0 - s) ** 2, -lasts * s**2 * (1.0 - s)
    x = values[0] * begin[1] + values[1] * end[1] + rates[0] * begin[3] + rates[1] * end[3]
    deviation = values[0] * begin[2] + values[1] * end[2] + rates[0] * begin[4] + rates[1] * end[4]
    return begin[0] + s * lasts, np.asarray(x), np.asarray(deviation)
