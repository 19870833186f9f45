"""How an orbit closes: onto itself, or onto its image under a declared symmetry.

An orbit x closes up to the symmetry S of order q after the q-th part of its period: S x(T) = x(0). Its
motion over the whole period consists of q images of that piece, so that a q-th of it needs to be
integrated (the thesis's equation 44 is the case q = 2). Angles may turn: `turns` says by how many of its
own periods each state grows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.problems.images import imaged
from contwalk.problems.mapping import mapped
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

MOST_FOLD = 24


@dataclass(frozen=True, eq=False)
class Closure:
    """The map that takes the end of the integrated piece to its beginning.

    Parameters
    ----------
    turns : ndarray, shape (n,)
        What a state has grown by, in its own units, when the orbit closes.
    symmetry : Symmetry, optional
        The symmetry up to which it closes; `power` of it is applied.
    fold : int
        The integrated piece is this part of the period.
    """

    turns: np.ndarray
    symmetry: Symmetry | None = None
    power: int = 1
    fold: int = 1

    @property
    def name(self) -> str:
        """`full`, or the symmetry's name."""
        return "full" if self.symmetry is None else self.symmetry.name

    def images(self, x: np.ndarray, parameters: ParameterValues) -> list[np.ndarray]:
        """Pieces of the whole motion in the order of time, from the integrated one, each of shape (k, n)."""
        return [self.image(x, parameters, j) for j in range(self.fold)]

    def image(self, x: np.ndarray, parameters: ParameterValues, number: int) -> np.ndarray:
        """One piece of the whole motion, from the integrated one, which is number 0."""
        # S x(T) = x(0): the next piece is the inverse image
        return images_of(self.symmetry, x, parameters, (self.power * (self.fold - number)) % self.fold)


def images_of(
    symmetry: Symmetry | None, states: np.ndarray, parameters: ParameterValues, power: int = 1
) -> np.ndarray:
    """Images of many states, shape (k, n): all at once where the map allows it."""
    for _ in range(power if symmetry is not None else 0):
        states = mapped(f"symmetry '{symmetry.name}'", symmetry.map, states, parameters)  # type: ignore[union-attr]
    return states


def order_of(symmetry: Symmetry, x: np.ndarray, parameters: ParameterValues) -> int | None:
    """The smallest q with S^q = identity, tried at a state; None if there is none up to `MOST_FOLD`."""
    generic = x + (1.0 + np.abs(x)) * np.cos(np.arange(1.0, len(x) + 1.0))
    image = generic
    for q in range(1, MOST_FOLD + 1):
        image = imaged(symmetry, image, parameters)
        if np.allclose(image, generic, rtol=1e-10, atol=1e-12):
            return q
    return None
