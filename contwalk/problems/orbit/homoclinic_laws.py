"""By which law the parameter of a family converges as its period grows, from two neighbouring orbits.

The table of `homoclinic` says which equilibrium has which law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.problem import Sample

# An equilibrium this near to the orbit, in units of its range, is so near that it is hidden.
AT_REST = 1e-3
# What a law misses of the way that is known, as a part of what it misses of the rest.
REST = 10.0
# How far from the law of its equilibrium the parameter may be, and from it where nothing else is seen.
LAWFUL, ABOUT = 0.25, 4.0
# A saddle is left far faster than it is come to, if it is so many times.
FAR_FASTER = 10.0


@dataclass(frozen=True)
class Limit:
    """What is left to the limit of the parameter, its error, and how far the parameter may still swing."""

    rest: float
    error: float
    swing: float


# Whether the orbit before, by its slow places, obeys the law by which a limit was found.
Obeyed = Callable[[list[SlowPlace]], bool]


def coming(
    jacobian: np.ndarray, samples: tuple[Sample, Sample], slopes: np.ndarray
) -> tuple[Limit, float] | None:
    """The limit of orbits on their way to a saddle that they leave fast, and the rate at which they come.

    What repels them on the way does so less than the saddle itself: the parameter falls at a rate that grows
    to the saddle's own. The jacobian has the shape (n, n), the slopes d lambda / dT (2,).
    """
    values = np.linalg.eigvals(jacobian)
    repelling, drawing = values[values.real > 0.0], values[values.real < 0.0]
    if not len(repelling) or not len(drawing) or slopes[0] * slopes[1] <= 0.0:
        return None
    out, into = repelling[np.argmin(repelling.real)], drawing[np.argmax(drawing.real)]
    if out.imag or into.imag or -into.real >= out.real:
        return None
    measured = float(np.log(slopes[0] / slopes[1])) / (samples[1].period - samples[0].period)
    if not 1.0 / ABOUT < measured / float(out.real) < 1.0 + LAWFUL:
        return None
    rest = float(slopes[1]) / measured
    off = abs(measured / float(out.real) - 1.0)
    return Limit(rest, (off + LAWFUL) * abs(rest), abs(rest)), -float(into.real)


def drawn(
    jacobian: np.ndarray, samples: tuple[Sample, Sample], slopes: np.ndarray
) -> tuple[Limit, float] | None:
    """The limit of orbits without events on their way to a saddle that they leave far faster than they come,
    and the rate at which they come.

    Along what repels them so fast the parameter stands still, however they came. What is left of how they
    came is small, and its square may be more: the parameter falls at the rate at which they come, or faster,
    and later at this rate. The jacobian has the shape (n, n), the slopes d lambda / dT (2,).
    """
    values = np.linalg.eigvals(jacobian)
    repelling, drawing = values[values.real > 0.0], values[values.real < 0.0]
    if not len(repelling) or not len(drawing) or slopes[0] * slopes[1] <= 0.0:
        return None
    out, into = repelling[np.argmin(repelling.real)], drawing[np.argmax(drawing.real)]
    rate = -float(into.real)
    if out.imag or into.imag or FAR_FASTER * rate >= out.real:
        return None
    measured = float(np.log(slopes[0] / slopes[1])) / (samples[1].period - samples[0].period)
    if not 1.0 - LAWFUL < measured / rate < ABOUT:
        return None
    rest = float(slopes[1]) / measured
    return Limit(rest, (abs(measured / rate - 1.0) + LAWFUL) * abs(rest), abs(rest)), rate


def passing(
    jacobian: np.ndarray,
    distance: float,
    samples: tuple[Sample, Sample],
    slopes: np.ndarray,
    eventful: bool = False,
    passes: int = 1,
) -> Limit | None:
    """The limit of orbits that pass an equilibrium, or several alike in a round, by its leading eigenvalue.

    A reset may put the state beside the equilibrium, or an event take it away from there, and forget how it
    came: then either of the leading ones may tell, and there may be one only. A pair swings about a
    saddle-focus only: what is drawn in by a focus on all sides does not leave it, and what a reset puts
    beside one that repels all leaves it the faster, the further away it begins. A round past several alike,
    as images of each other are, grows by a part of the period at each: whether it does, the way between both
    orbits tells. The jacobian has the shape (n, n), the slopes d lambda / dT (2,).
    """
    values = np.linalg.eigvals(jacobian)
    repelling, drawing = values[values.real > 0.0], values[values.real < 0.0]
    leading = [repelling[np.argmin(repelling.real)]] if len(repelling) else []
    leading += [drawing[np.argmax(drawing.real)]] if len(drawing) else []
    leading.sort(key=lambda v: abs(v.real))
    saddle = len(leading) == 2
    if not eventful:
        leading = leading[:1] if saddle else []
    for value in leading:
        if saddle and abs(value.imag) > 1e-9 * abs(value):
            exponent = complex(-abs(value.real), abs(value.imag))
            found = swinging([exponent / m for m in sorted({1, passes})], samples, slopes)
        else:
            rates = [float(abs(value.real)) / m for m in sorted({1, passes})]
            found = falling(rates, samples, slopes, distance < AT_REST)
        if found is not None:
            return found
    return None


def falling(
    rates: Sequence[float], samples: tuple[Sample, Sample], slopes: np.ndarray, at_rest: bool
) -> Limit | None:
    """lambda - lambda_h falls like exp(-rate T) with one of some rates; of a cycle past several equilibria,
    with another one.

    The slopes d lambda / dT have the shape (2,).
    """
    if slopes[0] * slopes[1] <= 0.0:
        return None
    measured = float(np.log(slopes[0] / slopes[1])) / (samples[1].period - samples[0].period)
    if measured <= 0.0:
        return None
    rate = min(rates, key=lambda r: abs(np.log(measured / r)))
    off = abs(measured / rate - 1.0)
    lawful = off < LAWFUL
    if not lawful and not (at_rest and 1.0 / ABOUT < measured / rate < ABOUT):
        return None
    rest = float(slopes[1]) / measured
    return Limit(rest, abs(rest - float(slopes[1]) / rate) + (off + LAWFUL) * abs(rest), abs(rest))


def swinging(
    exponents: Sequence[complex], samples: tuple[Sample, Sample], slopes: np.ndarray
) -> Limit | None:
    """lambda - lambda_h = Re(c exp(exponent T)): c from the slopes at two periods, shape (2,), and of some
    exponents the one that tells the way between both best.

    Between two orbits of nearly the same period each of them tells the way. So the error covers what all say
    that agree with it, and there is no limit where the orbits are too near to each other for one of them.
    """
    apart = samples[1].period - samples[0].period
    found = [_swing(exponent, samples, slopes) for exponent in exponents]
    if any(x is None and abs(e.imag) * apart < 1.0 for x, e in zip(found, exponents, strict=True)):
        return None
    lawful = [x for x in found if x is not None and x[0] <= LAWFUL]
    if not lawful:
        return None
    amplitude = min(lawful, key=lambda x: x[0])[1]
    error = max(abs(other) + abs(other.real - amplitude.real) for _, other in lawful)
    return Limit(-amplitude.real, error, max(abs(other) for _, other in lawful))


def _swing(
    exponent: complex, samples: tuple[Sample, Sample], slopes: np.ndarray
) -> tuple[float, complex] | None:
    """How far the law is from the way between two orbits, as a part of its amplitude, and the amplitude."""
    a, b = samples
    back = np.exp(-exponent * (b.period - a.period))
    if abs(back.imag) < 0.05 * abs(back):  # half a turn apart, or hardly apart: the phase is not told
        return None
    slope = complex(slopes[1], (slopes[1] * back.real - slopes[0]) / back.imag)
    amplitude = slope / exponent
    predicted = amplitude.real - (amplitude * back).real
    off = abs(predicted - float(b.z[-1] - a.z[-1])) / max(abs(amplitude), abs(amplitude * back))
    return off, amplitude


def gone(after: SlowPlace, samples: tuple[Sample, Sample], slopes: np.ndarray) -> tuple[Limit | None, Obeyed]:
    """A saddle-node that has gone: lambda - lambda_h and the least speed fall like 1 / (T - T_0)^2.

    The slopes d lambda / dT have the shape (2,).
    """
    ratio = float(slopes[0] / slopes[1]) if slopes[1] else 0.0
    if not ratio > 1.0:
        return None, lambda _: False
    a, b = (s.period for s in samples)
    longer = ratio ** (1.0 / 3.0)  # (b - T_0) / (a - T_0)
    since = (b - a) * longer / (longer - 1.0)  # b - T_0

    def slower(before: list[SlowPlace]) -> bool:
        times = before[0].speed / max(after.speed, 1e-300)
        return times > 1.0 and bool(abs(np.log(times) / np.log(longer) - 2.0) <= 0.5)

    rest = 0.5 * float(slopes[1]) * since
    # From the slopes at both ends the law predicts the way in between. What it misses of that, as a part of
    # it, is as the square of how much longer one lasts against what is missed of the rest.
    way = 0.5 * float(slopes[0]) * since / longer - rest
    missed = abs(float(samples[1].z[-1] - samples[0].z[-1]) / way - 1.0)
    part = min(REST * missed / (longer - 1.0) ** 2, 0.5)
    return (None if since > 2.0 * b else Limit(rest, part * abs(rest), abs(rest))), slower
