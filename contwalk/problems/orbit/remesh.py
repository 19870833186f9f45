"""An orbit discretised anew: steps made for it, and its section."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.problems.orbit.discretization import STAGES
from contwalk.problems.orbit.discretized_orbit import Kind
from contwalk.problems.orbit.meshing import meshed, most_steps, runs_of
from contwalk.problems.orbit.orbit_section import own_reference, section_through
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.shooting import Mesh


def adapted_to(
    orbit: Kind,
    z: np.ndarray,
    weights: np.ndarray,
    tolerance: float | None = None,
    section: Section | None = None,
) -> Kind:
    """The problem on steps for the orbit of z; an orbit that is a point yet tells no section of its own.

    z and weights have the shape (N + 1,).

    Raises
    ------
    NotFinite
        If the motion from z ends before the closure does.
    """
    orbit = orbit.fitting(z)
    asked = tolerance or orbit.discretization.walking
    if section is None:
        magnitudes = orbit.magnitudes_of(weights)[list(orbit.passages[0].states)]
        section = section_through(orbit, z[orbit.layout.states[0]], orbit.given(z), magnitudes)
    problem = orbit.on(mesh_for(orbit, z, weights, asked), section)
    # An orbit that is a point still has no velocities to compare with: its section holds the phase.
    integral = orbit.in_closure and orbit.discretization.phase == "integral"
    if integral and section is not None and problem.moves(z):
        problem.reference_orbit = own_reference(problem, z)
    if tolerance is None:  # who walks on asks for the equations there next, and one pass serves both
        problem.linearize(z)
    # Views of guards need the steps, and the units of the equations need the views.
    problem._mesh = replace(problem.mesh, guards=problem.largest_guards(z))
    return problem


def mesh_for(orbit: Kind, z: np.ndarray, weights: np.ndarray, tolerance: float) -> Mesh:
    """Steps for the orbit of z. z and weights have the shape (N + 1,)."""
    most = orbit.most_steps or most_steps(orbit._mesh, tolerance)
    try:
        mesh = meshed(
            runs_of(orbit, z),
            orbit.line.constants,
            flow.ErrorControl(tolerance, orbit.magnitudes_of(weights), most),
            orbit.discretization.integrator(tolerance),
            orbit.parts,
            closure=orbit.in_closure,
            alike=orbit.itinerary.has_halves(orbit.system),
        )
    except NotFinite:
        if orbit.itinerary.eventful:  # guesses of durations may send legs anywhere, for very many steps
            orbit.effort.spend(STAGES["radau9"] * most)
        raise
    orbit.effort.spend(2 * STAGES[mesh.method] * sum(len(times) for times in mesh.steps))
    return replace(mesh, total=_total(orbit, z), reason=orbit.discretization.why(mesh.reason))


def _total(orbit: Kind, z: np.ndarray) -> float:
    """The unit of durations; of an orbit that has shrunk to no time at all, that of those beside it."""
    if orbit.in_closure and orbit.forced:  # none is unknown
        return 1.0
    return abs(orbit.duration(z)) or (1.0 if orbit._mesh is None else orbit._mesh.total)
