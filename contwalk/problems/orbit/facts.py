"""What is true of a whole branch of orbits, as it is stored with it."""

from __future__ import annotations

from typing import Any

from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit import reporting
from contwalk.problems.orbit.cutting import room, size_with_room
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.itinerary import stored_leg


def branch_facts(orbit: DiscretizedOrbit, observables: tuple[str, ...]) -> dict[str, Any]:
    """Fields of `BranchInfo` for a branch that begins with an orbit."""
    facts: dict[str, Any] = {} if orbit.in_closure else {"signature": orbit.itinerary.signature(orbit.system)}
    return facts | {
        "problem": orbit.kind,
        "observables": observables,
        "unknowns": size_with_room(orbit),
        "spectrum": max(orbit.spectrum_size, 1),
        "closure": orbit.whole[0],
        "subharmonic": orbit.subharmonic,
        "settings": {
            **neutrals.kept(orbit.pins, orbit.line, orbit.states),
            "fold": orbit.whole[1],
            "turns": orbit.turns.tolist(),
            "reported": reporting.place(orbit),
            **(_of_closure(orbit) if orbit.in_closure else _of_legs(orbit)),
        },
    }


def _of_closure(orbit: DiscretizedOrbit) -> dict[str, Any]:
    return {
        "segments": orbit.mesh.segments,
        **_scheme(orbit),
        "parts": orbit.parts,
        "power": orbit.itinerary.power,
    }


def _scheme(orbit: DiscretizedOrbit) -> dict[str, Any]:
    """How times of cuts are chosen, where they are or may come to be."""
    asked = orbit.discretization
    if asked.evenly_first:
        return {"scheme": asked.scheme, "evenly_first": True}
    return {"scheme": "auto" if asked.scheme == "grown" else asked.scheme} if orbit.uneven else {}


def _of_legs(orbit: DiscretizedOrbit) -> dict[str, Any]:
    legs = [stored_leg(leg) for leg in orbit.itinerary.legs]
    return {"legs": legs, "image": orbit.itinerary.image, "room": room(orbit)}
