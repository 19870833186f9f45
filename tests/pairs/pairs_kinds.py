"""All kinds of pairs, by name."""

from __future__ import annotations

import pairs_of_equilibria
import pairs_of_machines
import pairs_of_maps
import pairs_of_orbits
from pairs_form import Case, Draw

KINDS = (
    pairs_of_equilibria.EQUILIBRIA | pairs_of_maps.MAPS | pairs_of_orbits.ORBITS | pairs_of_machines.MACHINES
)
# Those of one function that passes zero twice: it may as well come as near and turn back.
DIPS = (
    *pairs_of_equilibria.DIPS,
    *pairs_of_maps.DIPS,
    *pairs_of_orbits.DIPS,
    *pairs_of_machines.DIPS,
)


def case(kind: str, seed: int, near_miss: bool = False) -> Case:
    """The pair of a kind that a seed draws."""
    return KINDS[kind](Draw(kind, seed, near_miss))
