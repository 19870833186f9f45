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


def squared(
    equations: OrbitEquations, at: Evaluation, q: np.ndarray, value: complex, known: float = 0.02
) -> Told:
    """The mean square, over the closure and across the flow, of the deviation that starts as q, (n,).

    Of complex q, of both its parts together. After an event it is counted at so long after the event: under a
    force, where nothing is taken out along the flow, a deviation that is late has gone on less far. The error
    is what half as many instants make of the integral, or `known` of it, to which records know it: they count
    it at some instants.

    Parameters
    ----------
    value : complex
        The multiplier of q.
    """
    half = _halves(equations, at)
    through = _Through(equations, at, half)
    _, late = through.once(q, 0.0)
    means, _ = through.once(q, late / value)
    whole, rough = means
    return Told(whole, max(abs(whole - rough), known * abs(whole)))


def _halves(equations: OrbitEquations, at: Evaluation, images: int = 64) -> np.ndarray:
    """Halves of the ranges of all states over the whole orbit, its images included, shape (n,).

    Of a state that rests there, or that not every mode has, its size. An orbit that closes up to a symmetry
    has so many `images` at most.
    """
    functions, p = equations.functions, equations.functions.parameters.at(equations.free)
    system, found = functions.system, list[np.ndarray]()
    for leg in at.legs:
        own = list(system.states_of(leg.mode))
        for piece in leg.pieces:
            still = np.zeros_like(piece.states)
            for begin, end, _ in _steps(equations, piece, p, still):
                inside = np.full((len(QUARTERS), len(system.states)), np.nan)
                inside[:, own] = [_between(begin, end, share)[1] for share in QUARTERS]
                found += list(inside)
    states, mode = np.array(found), at.legs[0].mode
    seen = [states]
    if equations.image and not np.isnan(states).any():
        image = functions.jump(None, mode, mode, equations.image, equations.power)
        for _ in range(images):
            states = np.array([image(0.0, x, p)[0] for x in states])
            level = EPSILON**0.5 * float(np.max(np.abs(states)))
            if np.allclose(states, seen[0], rtol=0.0, atol=level):
                break
            seen.append(states)
    half, sizes = 0.5 * np.ptp(np.vstack(seen), axis=0), equations.scale
    return np.where(half > EPSILON**0.5 * sizes, half, sizes)


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
