"""An orbit discretised anew: steps made for it, its section, and its sample on both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.problems.hybrid import cutting, margin_values
from contwalk.problems.hybrid.limited_orbit import Kind
from contwalk.problems.orbit.discretization import STAGES
from contwalk.problems.orbit.meshing import meshed, most_steps
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.shooting import Run
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.sample import Sample

# Residuals so many times above their level are no solution's.
MISSED = 3e4


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
    if len(z) != orbit.size + 1:
        fitting: Kind = orbit.fitting(z).adapted_to(z, weights, tolerance)
        return fitting
    inputs = [orbit.layout.inputs_of(segment, z) for segment in orbit.layout.segments]
    runs = [
        Run(orbit.passages[segment.leg], x, scalars, 2 * len(x))
        for segment, (x, scalars) in zip(orbit.layout.segments, inputs, strict=True)
    ]
    magnitudes = orbit.magnitudes_of(weights)
    asked = tolerance or orbit.discretization.walking
    most = orbit._most_steps or most_steps(orbit._mesh, asked)
    try:
        mesh = meshed(
            runs,
            orbit.line.constants,
            flow.ErrorControl(asked, magnitudes, most),
            orbit.discretization.integrator(asked),
            orbit.parts,
            alike=orbit.itinerary.has_halves(orbit.system),
        )
    except NotFinite:
        orbit.effort.spend(STAGES["radau9"] * most)
        raise
    orbit.effort.spend(2 * STAGES[mesh.method] * sum(len(times) for times in mesh.steps))
    if section is None:
        x, scalars = inputs[0]
        values = np.concatenate([scalars, orbit.line.constants])
        section = section_through(orbit, x, values, magnitudes[list(orbit.passages[0].states)])
    # An orbit that has shrunk to no time at all has the unit of those beside it.
    total = abs(orbit.duration(z)) or (1.0 if orbit._mesh is None else orbit._mesh.total)
    mesh = replace(mesh, total=total, reason=orbit.discretization.why(mesh.reason))
    problem = orbit.on(mesh, section)
    if tolerance is None:  # who walks on asks for the equations there next, and one pass serves both
        problem.linearize(z)
    # Its views need the steps, and the units of its equations need the views.
    problem._mesh = replace(problem.mesh, guards=margin_values.guard_scales(problem, z))
    return problem


def adapted(orbit: Kind, sample: Sample) -> tuple[Kind, Sample]:
    """The problem on steps made for a solution, and the solution's sample on it.

    Where a leg passes a saddle, what was a solution on the steps of the last orbit may be none on these:
    it is then corrected. At a branch point it stays on its own steps, where it is one: the equations tell
    neither where the point is nor which way the branch goes.
    """
    room, born = 2 * orbit.cuts <= cutting.room(orbit), sample.orientation == 0.0
    try:
        problem = orbit.adapted_to(sample.z, sample.weights)
    except NotFinite:  # on other steps the leg's own start no longer leads to its end
        if born:
            return orbit, sample
        found = cutting.recut(orbit, sample) if room else None
        if found is None:
            raise
        return found
    if problem.linearize(sample.z).excess_in(sample.weights) > MISSED:
        return (orbit, sample) if born else _corrected(problem, sample)
    if room and cutting.stretched(problem, sample.z):
        found = cutting.recut(problem, sample)
        if found is not None:
            return found
    tangent = problem.into_section(sample.z, sample.tangent)
    linearization = problem.linearize(sample.z)
    again = problem.examine(sample.z, tangent, sample.weights, linearization, sample.unstable, sample)
    orientation = 0.0 if born else again.orientation
    return problem, replace(again, orientation=orientation)


def _corrected(orbit: Kind, sample: Sample) -> tuple[Kind, Sample]:
    """A solution of other steps corrected on these, and steps made for what it has become."""
    normal = sample.tangent / sample.weights**2
    z = newton_on(orbit, sample.z, sample.weights, normal)
    problem = orbit.adapted_to(z, sample.weights)
    there = problem.linearize(z)
    tangent = there.tangent(normal, sample.weights)
    again = problem.examine(z, tangent, sample.weights, there, sample.unstable)
    return problem, replace(again, iterations=sample.iterations)
