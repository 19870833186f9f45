"""Images of motions, and orders of symmetries."""

from __future__ import annotations

import numpy as np

from contwalk.problems.images import imaged
from contwalk.problems.mapping import mapped
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.system import Symmetry, System
from contwalk.system.declarations import ParameterValues

MOST_ORDER = 24


def closure_image(
    system: System, itinerary: Itinerary, states: np.ndarray, parameters: ParameterValues, number: int
) -> np.ndarray:
    """States (k, n) of one closure of the whole motion, from those of the integrated one, number 0."""
    if not itinerary.image:
        return states
    # S x(T) = x(0): the next closure is the inverse image
    power = (itinerary.power * (itinerary.order - number)) % itinerary.order
    return images_of(system.symmetry(itinerary.image), states, parameters, power)


def images_of(
    symmetry: Symmetry | None, states: np.ndarray, parameters: ParameterValues, power: int = 1
) -> np.ndarray:
    """Images of many states, shape (k, n): all at once where the map allows it."""
    for _ in range(power if symmetry is not None else 0):
        states = mapped(f"symmetry '{symmetry.name}'", symmetry.map, states, parameters)  # type: ignore[union-attr]
    return states


def order_of(symmetry: Symmetry, x: np.ndarray, parameters: ParameterValues) -> int | None:
    """The smallest q with S^q = identity, tried at a state; None if there is none up to `MOST_ORDER`.

    x has the shape (n,).
    """
    generic = x + (1.0 + np.abs(x)) * np.cos(np.arange(1.0, len(x) + 1.0))
    image = generic
    for q in range(1, MOST_ORDER + 1):
        image = imaged(symmetry, image, parameters)
        if np.allclose(image, generic, rtol=1e-10, atol=1e-12):
            return q
    return None
