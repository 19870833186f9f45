"""How far states move along a branch of orbits, beside how far they move over each orbit.

The metric measures a state in half its range over an orbit. A slow state of a burster hardly moves over one,
though along the branch it goes a thousand times as far: arclength would be its alone, and a branch would
never get anywhere. It weighs as the way that it has gone, as far as other states weigh so too.
"""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.sample import Sample

# The part of its way that a state weighs as: with the whole of it, steps through the explosion of a cycle
# that is carried from one Hopf point to another are too long.
OF_THE_WAY = 0.25
# Orbits whose extents are kept.
MOST_KEPT = 4
# A state that moves less than this part of its size over an orbit tells nothing of how orbits weigh.
STANDS = 1e-13


def states_along(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """States at the steps of all legs, shape (k, n). z has the shape (N + 1,)."""
    found = [view.full(view.nodes) for view in orbit.view(z)]
    return found[0] if len(found) == 1 else np.concatenate(found)


def extent_along(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """Least and largest value of each state at the steps of all legs, shape (2, n).

    z has the shape (N + 1,). It is kept, as the metric and each row ask for it: do not change it.
    """

    def made() -> np.ndarray:
        states = states_along(orbit, z)
        return np.stack([states.min(axis=0), states.max(axis=0)])

    return orbit.known.at("extent", z, MOST_KEPT, made)


def sizes_since(orbit: OrbitData, sample: Sample, begun: Sample) -> np.ndarray:
    """What weights of the metric grow with, shape (N + 1,), of an orbit on a branch that began elsewhere.

    A state's is half its range over the orbit, or a quarter of how far the middle of that range has moved
    since the beginning. Where these ways of all states are longer than what any moves over an orbit, as of
    small cycles, they are shortened alike, so that one state at least weighs as over its orbit: else
    arclength would not tell what becomes of the cycles. A force that is weak makes small ripples: what
    becomes of those is how far they have moved; nor need states move that a clock samples.
    """
    assert sample.sizes is not None
    if sample.extent is None or begun.extent is None:
        return sample.sizes
    half, moved = _moves(sample.extent, begun.extent)
    tells = half > STANDS * np.abs(sample.extent).max(axis=0)
    share = OF_THE_WAY
    if not orbit.forced:
        if not np.any(tells):
            return sample.sizes
        with np.errstate(divide="ignore"):
            share = min(float((half[tells] / moved[tells]).max()), OF_THE_WAY)
    declared = np.array([state.scale is not None for state in orbit.system.states])
    along, result = orbit.weighted(np.where(declared, 0.0, share * moved)), sample.sizes.copy()
    for place, _ in orbit.places:
        result[place] = np.maximum(result[place], along[place])
    return result


def _moves(extent: np.ndarray, begun: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half the range of each state, and how far its middle is from that of another orbit, (n,) each."""
    (least, largest), (first_least, first_largest) = extent, begun
    return 0.5 * (largest - least), 0.5 * np.abs(least + largest - first_least - first_largest)
