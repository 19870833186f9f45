"""Smooth orbits from what is stored of their branch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.restoring import Facts, declared
from contwalk.system import System


def restored(facts: Facts) -> PeriodicOrbit:
    """The problem of a stored branch of smooth orbits, not yet discretised."""
    info, stored = facts.info, facts.info.settings
    orbit = PeriodicOrbit(
        facts.system,
        facts.parameters,
        facts.free,
        facts.ends,
        pins=facts.pins,
        reference=facts.state,
        subharmonic=info.subharmonic,
        # What stands among the unknowns is the branch's own, whatever a run asks of its orbits.
        discretization=_as_stored(
            facts.discretization or Discretization(),
            str(stored.get("scheme", "shooting")),
            bool(stored.get("evenly_first")),
        ),
    )
    image = _image(facts.system, info)
    turns = np.array(stored.get("turns") or np.zeros(len(info.states)), dtype=float)
    if not image and not np.any(turns):
        return orbit
    closed = orbit.closing(turns, image, int(stored.get("power", 1)), int(stored.get("fold", 1)))
    return closed.varied(parts=int(stored.get("parts", 1)))


def _as_stored(asked: Discretization, scheme: str, evenly_first: bool) -> Discretization:
    """What a run asks of its orbits, and the discretisation that a branch was stored with."""
    if scheme == "auto":
        return replace(asked, scheme=scheme if evenly_first else "grown", segments=None)
    return replace(asked, scheme=scheme)


def _image(system: System, info: BranchInfo) -> str:
    """Name of the symmetry up to which the orbits of a branch close; empty if there is none."""
    if info.closure in (None, "full"):
        return ""
    return declared("symmetry", str(info.closure), {s.name: s for s in system.symmetries}).name
