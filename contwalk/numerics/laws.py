"""Laws by which a parameter converges along a coordinate without end, and what they leave of its way.

| law | lambda - lambda* |
|---|---|
| power | falls like x^-p |
| exponential | falls like exp(-kappa x) |

Both are fitted to the slopes d lambda / dx at two values of the coordinate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# A way that is left like a higher power of the coordinate than this falls exponentially.
EXPONENTIAL = 8.0


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
