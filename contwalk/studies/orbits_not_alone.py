"""The outcomes of starts whose orbits are not alone, or do not conserve what they should."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.correction import Correction
from contwalk.diagram import not_begun
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.legs_without_length import collapsed as collapsed_event
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.signatures import folded
from contwalk.studies.families import ONE_OF_A_FAMILY, Places, family_at, is_one_of_a_family, member_near


def not_alone(problem: HybridOrbit | PeriodicOrbit, z: np.ndarray, failure: Correction) -> Outcome | None:
    """The outcome where orbits near a start z come in a family; None where something else keeps it.

    `failure` is the correction that failed at z, shape (N + 1,).
    """
    if failure.reason != "no_convergence":
        return None
    found = outcome_of_family(problem, z)
    return found or (one_of_a_family_near(problem, z) if isinstance(problem, HybridOrbit) else None)


def one_of_a_family_near(problem: HybridOrbit, z: np.ndarray) -> Outcome | None:
    """The outcome of a start that comes back on none of its returns, where orbits near it come in a family.

    z has the shape (N + 1,); None where none of a family is found near it.
    """
    try:
        with problem.effort.of_start(problem.cost):
            member = member_near(problem, z)
    except (StartError, PluginError, NotFinite, np.linalg.LinAlgError):
        return None
    if member is None or collapsed_event(problem, member) or not is_one_of_a_family(problem, member):
        return None
    return outcome_of_family(problem, member)


def outcome_of_family(problem: HybridOrbit | PeriodicOrbit, z: np.ndarray) -> Outcome | None:
    """The outcome of a start whose neighbours are orbits at the same parameters; None where they are not.

    z has the shape (N + 1,).
    """
    if isinstance(problem, HybridOrbit):
        places, itinerary = (
            _hybrid_places(problem),
            f" (itinerary: {folded(problem.itinerary.signature(problem.system)) or 'no events'})",
        )
    else:
        places, itinerary = _smooth_places(problem), ""
    found = family_at(problem, z, places)
    if found is None:
        return None
    return not_begun.refused(found.sentence + itinerary, found.remedy)


def not_conserved(name: str) -> Outcome:
    """The outcome of an orbit along which something that is declared to be conserved is not."""
    return not_begun.refused(
        f"'{name}' is not conserved along the first orbit, at these parameters.",
        "Correct its function in the plugin, or the equations, change the parameters that make it lose or "
        "gain, or remove it from conserved=(...).",
    )


def one_of_many() -> Outcome:
    """The outcome of an orbit beside which there are others, where nothing tells why."""
    return not_begun.refused(
        "Other orbits lie beside the first one, at the same parameters.", ONE_OF_A_FAMILY
    )


def _smooth_places(problem: PeriodicOrbit) -> Places:
    """States at the starts of segments, and the equations of the last segment's end."""
    n, m, names = problem.states, problem.mesh.segments, problem.system.state_names
    unknowns = {i: names[i % n] for i in range(m * n)}
    return Places(unknowns, {(m - 1) * n + i: name for i, name in enumerate(names)})


def _hybrid_places(problem: HybridOrbit) -> Places:
    """States at the starts of legs, and the equations of the last leg's end."""
    names, layout = problem.system.state_names, problem.layout
    unknowns = {
        place: names[state]
        for own, passage in zip(layout.states, problem.passages, strict=True)
        for place, state in zip(range(own.start, own.stop), passage.states, strict=True)
    }
    last, first = layout.matches[-1], problem.passages[0].states
    return Places(unknowns, {last.start + k: names[state] for k, state in enumerate(first)})
