"""Modes of a closed orbit: what a small deviation becomes that a closure only multiplies.

A deviation is that of a neighbouring motion at the same time. A closure's derivative takes the start v of a
mode to mu v, and to a part along the orbit (the neighbour is ahead, or late) and along pinned directions
(it is somewhere else).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.numerics.spectrum import complement

# A multiplier this small is zero but for errors: what starts so is forgotten within the closure.
NOTHING = 1e-6
# How far a state is moved for the derivative of a map of which only values are known, in its own units.
APART = 1e-4


@dataclass(frozen=True, eq=False)
class Mode:
    """A mode.

    Parameters
    ----------
    multiplier : complex
    start : ndarray, shape (n,)
        Deviation at the start of the orbit at that time, complex where the multiplier is.
    neutral : ndarray, shape (n, k)
        Directions that may be added while it goes round: the flow's own, and pinned ones.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states.
    """

    multiplier: complex
    start: np.ndarray
    neutral: np.ndarray
    magnitudes: np.ndarray

    def times(self, factor: complex) -> Mode:
        """The same mode, larger and in another phase."""
        return replace(self, start=self.start * factor)

    def after(self, closures: int, carried: np.ndarray) -> np.ndarray:
        """The deviation after so many closures, from what the last one has made of the one before.

        The part across the neutral directions is known: what rounding has brought of faster modes is left
        out.

        Shape (n,).
        """
        known = (self.multiplier**closures * self.start).real
        along = self.neutral / self.magnitudes[:, None]
        shares = np.linalg.lstsq(along, (carried - known) / self.magnitudes, rcond=None)[0]
        return known + self.neutral @ shares


def eigenvector(product: np.ndarray, neutral: np.ndarray, magnitudes: np.ndarray, number: int) -> np.ndarray:
    """A vector that a closure's derivative multiplies by its multiplier, but for neutral directions.

    Parameters
    ----------
    product : ndarray, shape (n, n)
    neutral : ndarray, shape (n, k)
        Directions whose multipliers are left out.
    magnitudes : ndarray, shape (n,)
        The vector is orthogonal to the neutral directions in these units.
    number : int
        1 for the multiplier of the largest modulus.
    """
    scaled = product / magnitudes[:, None] * magnitudes
    basis = np.eye(len(scaled))
    if neutral.shape[1]:
        basis = complement(neutral / magnitudes[:, None])
    values, right = np.linalg.eig(basis.T @ scaled @ basis)
    chosen = np.lexsort((-values.imag, -np.abs(values)))[number - 1]
    return magnitudes * (basis @ right[:, chosen])


def chosen_multiplier(values: np.ndarray, number: int) -> complex:
    """The multiplier of a mode.

    Values have the shape (m,).

    Raises
    ------
    ContwalkError
        If there is none of this number, or it is not finite.
    """
    if not 1 <= number <= len(values):
        count = len(values)
        if not count:
            raise ContwalkError("The orbit has no multipliers.", "Name an orbit of a larger system.")
        many = "1 multiplier" if count == 1 else f"{count} multipliers"
        remedy = "Name mode 1." if count == 1 else f"Name one of the modes 1 to {count}."
        raise ContwalkError(f"There is no mode {number}: the orbit has {many}.", remedy)
    value = complex(values[number - 1])
    if not np.isfinite(value):
        raise ContwalkError(
            f"Mode {number} has an infinite multiplier: a small deviation is not small after a closure.",
            "Name a point beside it, or another mode.",
        )
    return value


def linear_part(
    map_: Callable[[np.ndarray], np.ndarray], states: np.ndarray, deviations: np.ndarray, scale: np.ndarray
) -> np.ndarray:
    """What a map of states makes of small deviations from them, each of shape (k, n), by differences."""
    largest = float(np.max(np.abs(deviations) / scale, initial=0.0))
    if largest == 0.0:
        return deviations
    step = APART / largest
    return (map_(states + step * deviations) - map_(states - step * deviations)) / (2.0 * step)
