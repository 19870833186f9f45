"""Quantities that are declared to be conserved, and are not along an orbit."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems import conserving
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Sample


def off_its_value(orbit: OrbitData, z: np.ndarray) -> str:
    """Name of a quantity that is not at its value on the orbit, though it is declared to be conserved.

    z has the shape (N + 1,).
    """
    if not orbit.system.conserved:
        return ""
    parameters, most = orbit.values_of(z), _state_errors(orbit, orbit.errors_at(z))
    found = (
        conserving.off(orbit.system, passage.leg.mode, passage.full(z[place]), parameters, most)
        for place, passage in orbit.places
    )
    return next(filter(None, found), "")


def not_conserved(orbit: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end of a branch beyond whose last orbit a quantity is not conserved."""
    name = off_its_value(orbit, b.z)
    if not name:
        return None
    return Outcome(
        "failed",
        "no_convergence",
        f"Beyond {orbit.line.described(float(a.z[-1]))}, '{name}' is not conserved: holding it at its value "
        "takes a force, and what closes with that is no periodic orbit of the machine. Correct its function "
        "in the plugin, or the equations, or remove it from conserved=(...).",
    )


def _state_errors(orbit: OrbitData, errors: np.ndarray) -> np.ndarray:
    """Of estimated errors of the equations, (N,), the sum over the ends of segments for each state, (n,)."""
    most = np.zeros(orbit.states)
    for segment in orbit.layout.segments:
        passage = orbit.passages[segment.leg]
        most[list(passage.following if segment.last else passage.states)] += errors[segment.ends]
    return most
