"""The section that fixes the phase of an orbit without events, and tangents of branches in it."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit import equations, monodromy
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.section import Reference, Section, reference_of, section_at
from contwalk.problems.orbit.shooting import velocity

# An orbit that would go a smaller part of its magnitudes in one closure is a point: it has no section.
STILL = 1e-9
# Solutions of which the velocities are kept: several tests ask for them.
MOST_KEPT = 4


def section_through(
    orbit: DiscretizedOrbit, x: np.ndarray, values: np.ndarray, magnitudes: np.ndarray
) -> Section | None:
    """The section through a state at which the first leg starts, across the flow there; of an orbit that is
    a point, as at a Hopf point, the one it has. None where an event or a force fixes the phase.

    x and magnitudes have the shape (n,).
    """
    if orbit.forced or orbit.itinerary.eventful:
        return None
    own = velocity(orbit.passages[0], x, 0.0, values)
    if np.linalg.norm(own / magnitudes) <= STILL and orbit.section is not None:
        return orbit.section
    return section_at(x, own, magnitudes)


def into_section(orbit: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """A tangent moved along the flow until it lies in the section: the same change of the orbit.

    Itself where an event or a force fixes the phase, and where the orbit is a point: a cycle that is born.

    All have the shape (N + 1,).
    """
    if orbit.forced or orbit.itinerary.eventful or not orbit.moves(z):
        return tangent
    assert orbit.section is not None
    place, later = orbit.layout.states[0], _begun_later(orbit, z)
    if orbit.reference_orbit is None:
        normal = orbit.section.normal
        shift = -float(normal @ tangent[place]) / float(normal @ later[place])
    else:
        row = np.zeros(len(z))
        equations.phase(orbit, z, row)
        shift = -float(row @ tangent) / float(row @ later)
    return tangent + shift * later


def velocities(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """dx/dt where the segments of a closure start, in units of its duration, shape (m, n); NaN in a row of
    which one entry does not exist. z has the shape (N + 1,). They are kept: do not change them.
    """

    def made() -> np.ndarray:
        found = orbit.view(z)[0].rates_at(orbit.mesh.cuts, orbit.starts(z))
        found[~np.isfinite(found).all(axis=1)] = np.nan
        found.flags.writeable = False
        return found

    return orbit.known.at("velocities", z, MOST_KEPT, made)


def speeds_of(orbit: DiscretizedOrbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times 0..1 in the middle of the steps, and mean speeds over each, in units of the states' variation.

    z has the shape (N + 1,), both results (s,).
    """
    times, states = orbit.mesh.times, orbit.view(z)[0].nodes
    lengths = np.diff(times)
    moves = lengths > 0.0  # at the end of a segment the next one begins
    passed = np.linalg.norm(np.diff(states, axis=0)[moves] / orbit.mesh.variation, axis=1)
    return 0.5 * (times[1:] + times[:-1])[moves], passed / lengths[moves]


def own_reference(orbit: DiscretizedOrbit, z: np.ndarray) -> Reference:
    """The orbit of z, shape (N + 1,), as the reference of the integral phase condition."""
    (view,), begins = orbit.view(z), orbit.mesh.ends[:-1] + 1
    every = view.nodes, view.rates_at(orbit.mesh.times, view.nodes)
    points, rates = (np.split(x, begins) for x in every)
    return reference_of(orbit.mesh.steps, points, rates, orbit.mesh.variation)


def _begun_later(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """How the unknowns of an orbit change with the instant at which it begins. Both have the shape (N + 1,).

    Where legs end with events, these stay where they are: the first leg becomes shorter, the last one longer.
    """
    change, layout = np.zeros(len(z)), orbit.layout
    if orbit.in_closure:  # known of the motion already; in units of its duration
        found = velocities(orbit, z).ravel()
        change[: len(found)] = found
        return change
    for j, segment in enumerate(layout.segments_of(0)):
        change[segment.states] = monodromy.flow_direction(orbit, z, 0, j)
    if layout.legs > 1:
        change[layout.durations.start], change[layout.durations.stop - 1] = -1.0, 1.0
    return change
