"""A solution with all that is stored of it, or watched along a branch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contwalk.problems.kink import Kink

# A relative margin this far below zero is zero still: on the steps of a branch it is not known better.
NO_MARGIN = 1e-7
# What an eigenvalue that is critical all along a branch may be off by rounding.
RESTS = 1e-12


def within(margins: np.ndarray) -> bool:
    """Whether no relative margin is negative beyond rounding; of shape (l,)."""
    return bool(np.all(margins >= -NO_MARGIN))


class Rates:
    """How fast stability measures change along a branch, each computed when it is first asked for.

    Parameters
    ----------
    count : int
    rate : callable
        Derivative of the measure of a number 0..count-1 by arclength, NaN where none is known.
    factor : float
        What all of them are multiplied by.
    of_values : callable, optional
        Derivatives of the eigenvalues of some numbers themselves, complex.
    values : ndarray, shape (count,), optional
        All of them, where these are known already: else each has its price.
    """

    def __init__(
        self,
        count: int,
        rate: Callable[[int], float],
        factor: float = 1.0,
        of_values: Callable[[np.ndarray], np.ndarray] | None = None,
        values: np.ndarray | None = None,
    ) -> None:
        self._count, self._rate, self._factor, self._of_values = count, rate, factor, of_values
        self.values = values

    @classmethod
    def known(cls, values: np.ndarray, of_values: np.ndarray | None = None) -> Rates:
        """Rates that are known already, of measures and of eigenvalues, each of shape (count,)."""
        known = None if of_values is None else of_values.__getitem__
        return cls(len(values), values.tolist().__getitem__, of_values=known, values=values)

    def of_values(self, which: np.ndarray) -> np.ndarray | None:
        """Derivatives by arclength of the eigenvalues `which`, shape (k,); None where none are known."""
        return None if self._of_values is None else self._factor * self._of_values(which)

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, which: int) -> float:
        if not 0 <= which < self._count:
            raise IndexError(which)
        return self._factor * self._rate(which)

    def scaled(self, factor: float) -> Rates:
        """Rates by another arclength."""
        values = None if self.values is None else factor * self.values
        return Rates(self._count, self._rate, self._factor * factor, self._of_values, values)


@dataclass(frozen=True)
class Sample:
    """A solution with all that is watched along a branch.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    tangent : ndarray, shape (N + 1,)
        Unit in the metric of `weights`, pointing the way the branch is walked.
    weights : ndarray, shape (N + 1,)
        Typical magnitudes; the metric is the Euclidean norm of z / weights.
    orientation : float
        Sign of det [DF; tangent]; changes at a simple branch point and nowhere else.
    eigenvalues, errors : ndarray, shape (m,)
        Spectrum, and its estimated errors.
    rates : Rates
        Of its stability measures along the branch.
    measures : ndarray, shape (m,)
        What must be negative for stability, in descending order (real parts; moduli minus one for orbits).
    unstable : int
    observables : ndarray, shape (o,)
    magnitudes : ndarray, shape (N + 1,)
        Typical magnitudes as z and the equations tell them, NaN where they do not.
    excess : float
        Residual in units of its rounding level.
    critical : float
        What a real eigenvalue is where it changes stability: 0, of orbits 1.
    spectrum_error : float, optional
        Estimated error of the leading eigenvalue, where `errors` are only what blurs its sign along the
        branch.
    spectrum_accuracy : float, optional
        The same for a solution that is known exactly: `spectrum_error` may have what z is not known to.
    sizes : ndarray, shape (N + 1,), optional
        What the weights of the metric grow with along the branch; |z| if not given.
    extent : ndarray, shape (2, n), optional
        Of orbits: least and largest value of each state over it.
    error : float
        Estimated error of z in the metric, from the errors of the equations.
    margins : ndarray
        What must stay positive for the motion to be the machine's, relative; those of `Limited.limits`.
    reported : ndarray, shape (n,), optional
        The state that stands for the solution, where it depends on the steps it was computed on.
    forbidden : bool
        Whether an event of the machine would happen on it, which these equations do not have.
    still : bool
        Whether the last eigenvalue, out of order, is that of the branch's own direction: zero all along it.
    kinks : tuple of Kink
        Where the field is smooth by pieces only along an orbit.
    along : bool
        Whether one of the eigenvalues is critical because the parameter stands still along the branch.
    resting : ndarray of complex
        Eigenvalues beside `eigenvalues` that are critical all along the branch.
    period, trivial_error : float
        Of orbits: duration of the closure in seconds, and |M f - f| / |f|.
    """

    z: np.ndarray
    tangent: np.ndarray
    weights: np.ndarray
    orientation: float
    eigenvalues: np.ndarray
    errors: np.ndarray
    rates: Rates
    measures: np.ndarray
    unstable: int
    observables: np.ndarray
    magnitudes: np.ndarray
    excess: float
    iterations: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    critical: float = 0.0
    period: float = float("nan")
    trivial_error: float = float("nan")
    spectrum_error: float | None = None
    spectrum_accuracy: float | None = None
    sizes: np.ndarray | None = None
    extent: np.ndarray | None = None
    error: float = float("nan")
    margins: np.ndarray = field(default_factory=lambda: np.zeros(0))
    reported: np.ndarray | None = None
    forbidden: bool = False
    still: bool = False
    along: bool = False
    kinks: tuple[Kink, ...] = ()
    resting: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=complex))

    def varied(self, **told: Any) -> Sample:
        """The same with some of what is told of it changed.

        `dataclasses.replace` asks for all by name, thirty attributes, and a point of a branch is made of
        three or four samples.
        """
        other = object.__new__(Sample)
        vars(other).update(vars(self), **told)
        if len(vars(other)) > len(vars(self)):
            raise TypeError(f"a sample tells nothing called {', '.join(told.keys() - vars(self).keys())}")
        return other

    @property
    def spectrum(self) -> np.ndarray:
        """All eigenvalues in their order."""
        if not (self.still or len(self.resting)):
            return self.eigenvalues
        values = np.concatenate([self.eigenvalues, self.resting])
        return values[np.lexsort((-values.imag, -self.beyond(values)))]

    def beyond(self, values: np.ndarray) -> np.ndarray:
        """How far eigenvalues, shape (m,), are beyond critical: real parts; of orbits, moduli less one."""
        return values.real if self.critical == 0.0 else np.abs(values) - self.critical

    @property
    def undecided(self) -> int:
        """How many eigenvalues are not known to the sign that tells their stability."""
        last = len(self.measures) - self.still
        lost = int(np.count_nonzero(~(np.abs(self.measures[:last]) > self.errors[:last])))
        return max(lost - self.along, 0)

    @property
    def stable(self) -> bool | None:
        """Whether no eigenvalue is unstable; None where it is not known of one, and no other one is."""
        if not self.undecided:
            return self.unstable + self.held_unstable == 0
        last = len(self.measures) - self.still
        certain = self.held_unstable or np.any(self.measures[:last] > self.errors[:last])
        return False if certain else None

    @property
    def held_unstable(self) -> int:
        """How many of the eigenvalues that the curve holds are unstable: one of both of neutral saddles."""
        return int(np.count_nonzero(self.beyond(self.resting) > RESTS))

    @property
    def leading(self) -> int:
        """Number of the first of the eigenvalues in their order."""
        return int(np.argmax(self.eigenvalues.real)) if self.still else 0

    @property
    def share(self) -> float:
        """The free parameter's component of the unit tangent, in the metric."""
        return float(self.tangent[-1] / self.weights[-1])

    @property
    def parameter(self) -> float:
        """Value of the free parameter."""
        return float(self.z[-1])

    def counted(self, unstable: int) -> Sample:
        """The same with a count that was told on other steps.

        An eigenvalue that these steps put on the other side is not known to its distance from it.
        """
        if unstable == self.unstable:
            return self
        other = (np.arange(len(self.measures)) < unstable) != (self.measures > 0.0)
        doubt = np.where(other, np.abs(self.measures), 0.0)
        known = max(self.spectrum_error or 0.0, float(np.max(doubt, initial=0.0)))
        return self.varied(unstable=unstable, errors=np.maximum(self.errors, doubt), spectrum_error=known)

    @property
    def admissible(self) -> bool:
        """Whether no margin is negative beyond rounding, and no event is passed over."""
        return not self.forbidden and within(self.margins)
