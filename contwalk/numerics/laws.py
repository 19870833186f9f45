"""Laws by which a parameter converges along a coordinate without end, and what they leave of its way.

| law | lambda - lambda* |
|---|---|
| power | falls like x^-p |
| exponential | falls like exp(-kappa x) |
| swing | Re(c exp((-rho + i omega) x)) |
| inverse square | falls like 1 / (x - x0)^2 |

All are fitted to the slopes d lambda / dx at two values of the coordinate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# A way that is left like a higher power of the coordinate than this falls exponentially.
EXPONENTIAL = 8.0
# How far from a law the parameter may be; what it misses of the way that is known, as a part of what it
# misses of the rest.
LAWFUL, MISSED = 0.25, 10.0


@dataclass(frozen=True)
class Pair:
    """Two solutions of a family along a coordinate.

    Parameters
    ----------
    at : ndarray, shape (2,)
        The coordinate.
    values, slopes : ndarray, shape (2,)
        The parameter, and its derivative by the coordinate.
    """

    at: np.ndarray
    values: np.ndarray
    slopes: np.ndarray

    @property
    def apart(self) -> float:
        """How far the coordinate goes from one to the other."""
        return float(self.at[1] - self.at[0])

    @property
    def falls(self) -> bool:
        """Whether the second slope is a part of the first, and the parameter does not stand still."""
        return bool(self.slopes[0] * self.slopes[1] > 0.0 and abs(self.slopes[1]) < abs(self.slopes[0]))

    @property
    def rate(self) -> float:
        """At which the slope falls exponentially, per unit of the coordinate; infinite where it does not."""
        return float(np.log(self.slopes[0] / self.slopes[1])) / self.apart if self.falls else np.inf

    @property
    def straight(self) -> float:
        """How far beyond the second solution the slope is zero if it falls in a straight line."""
        return abs(self.apart * float(self.slopes[1] / (self.slopes[0] - self.slopes[1])))

    @property
    def left(self) -> float:
        """What is left of the parameter's way, by a power of the coordinate or exponentially."""
        x, slope = float(self.at[1]), float(self.slopes[1])
        with np.errstate(all="ignore"):  # a coordinate that passes zero has no power
            power = self.rate * self.apart / float(np.log(x / self.at[0])) - 1.0
        return slope * x / power if 0.0 < power < EXPONENTIAL else slope / self.rate


@dataclass(frozen=True)
class Limit:
    """What is left to the limit of the parameter, its error, and how far the parameter may still swing."""

    rest: float
    error: float
    swing: float


def falling(
    pair: Pair, rates: Sequence[float], low: float = 1.0 - LAWFUL, high: float = 1.0 + LAWFUL
) -> Limit | None:
    """lambda - lambda* falls like exp(-rate x), with one of some rates; the measured one, against that, lies
    between low and high.
    """
    if not pair.falls:
        return None
    rate = min(rates, key=lambda r: abs(np.log(pair.rate / r)))
    times = pair.rate / rate
    if not low < times < high:
        return None
    rest = float(pair.slopes[1]) / pair.rate
    return Limit(rest, (abs(times - 1.0) + LAWFUL) * abs(rest), abs(rest))


def swinging(pair: Pair, exponents: Sequence[complex]) -> Limit | None:
    """lambda - lambda* = Re(c exp(exponent x)): c from both slopes, and of some exponents the one that tells
    the way between both best.

    Between two solutions that are near to each other each of them tells the way. So the error covers what all
    say that agree with it, and there is no limit where they are too near for one of them.
    """
    found = [_swing(pair, exponent) for exponent in exponents]
    if any(x is None and abs(e.imag) * pair.apart < 1.0 for x, e in zip(found, exponents, strict=True)):
        return None
    lawful = [x for x in found if x is not None and x[0] <= LAWFUL]
    if not lawful:
        return None
    amplitude = min(lawful, key=lambda x: x[0])[1]
    error = max(abs(other) + abs(other.real - amplitude.real) for _, other in lawful)
    return Limit(-amplitude.real, error, max(abs(other) for _, other in lawful))


def _swing(pair: Pair, exponent: complex) -> tuple[float, complex] | None:
    """How far the law is from the way between both, as a part of its amplitude, and the amplitude."""
    back = np.exp(-exponent * pair.apart)
    if abs(back.imag) < 0.05 * abs(back):  # half a turn apart, or hardly apart: the phase is not told
        return None
    first, last = pair.slopes
    amplitude = complex(last, (last * back.real - first) / back.imag) / exponent
    predicted = amplitude.real - (amplitude * back).real
    off = abs(predicted - float(pair.values[1] - pair.values[0])) / max(abs(amplitude), abs(amplitude * back))
    return off, amplitude


def inverse_square(pair: Pair) -> tuple[Limit, float] | None:
    """lambda - lambda* falls like 1 / (x - x0)^2, and how many times x - x0 has become longer."""
    if not pair.falls:
        return None
    longer = float(pair.slopes[0] / pair.slopes[1]) ** (1.0 / 3.0)
    since = pair.apart * longer / (longer - 1.0)
    rest = 0.5 * float(pair.slopes[1]) * since
    # From the slopes at both ends the law predicts the way in between. What it misses of that, as a part of
    # it, is as the square of how much longer one lasts against what is missed of the rest.
    way = 0.5 * float(pair.slopes[0]) * since / longer - rest
    missed = abs(float(pair.values[1] - pair.values[0]) / way - 1.0)
    part = min(MISSED * missed / (longer - 1.0) ** 2, 0.5)
    return None if since > 2.0 * pair.at[1] else (Limit(rest, part * abs(rest), abs(rest)), longer)
