"""Orbits through events from what is stored of their branch."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies
from contwalk.problems.orbit.itinerary import named_itinerary
from contwalk.problems.restoring import Facts


def restored(facts: Facts) -> HybridOrbit:
    """The problem of a stored branch of orbits through events, not yet discretised."""
    system, stored = facts.system, facts.info.settings
    itinerary = named_itinerary(system, stored["legs"], stored.get("image", ""))
    kind = SoftOrbit if applies(system, itinerary) else HybridOrbit
    hybrid = kind(
        system,
        itinerary,
        facts.parameters,
        facts.free,
        facts.ends,
        pins=facts.pins,
        reference=facts.state,
        subharmonic=facts.info.subharmonic,
        discretization=facts.discretization,
    )
    return hybrid.varied(turns=np.array(stored["turns"], dtype=float), room=int(stored.get("room", 1)))
