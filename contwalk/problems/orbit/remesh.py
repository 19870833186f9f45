"""An orbit discretised anew: steps made for it, its section, its segments, and its sample on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.numerics.linear import unit_in
from contwalk.problems.orbit.cutting import begun_at, grown_cuts, halves, recutting
from contwalk.problems.orbit.discretization import STAGES
from contwalk.problems.orbit.discretized_orbit import Kind
from contwalk.problems.orbit.meshing import meshed, most_steps, runs_of
from contwalk.problems.orbit.orbit_section import own_reference, section_through, speeds_of
from contwalk.problems.orbit.section import Section, better_phase
from contwalk.problems.orbit.shooting import Mesh
from contwalk.problems.orbit.transport import TOO_MUCH, closed, moved, recut
from contwalk.problems.sample import Sample
from contwalk.problems.solving import newton_on

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
            alike=z[orbit.layout.durations] if orbit.itinerary.has_halves(orbit.system) else None,
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


# What solves for an orbit in other segments, or begun elsewhere; None where it cannot.
Closing = Callable[[Kind, Sample], tuple[Kind, Sample] | None]


def adapted(
    orbit: Kind, sample: Sample, closing: Closing[Kind] = closed, most: float = TOO_MUCH, watched: bool = True
) -> tuple[Kind, Sample]:
    """The problem with its section, steps and segments made anew at a solution, and its sample on it.

    The tangent moves along the flow into the new section; the branch stays where it is. What was a solution
    on the steps of the last orbit may be none on these, as where a leg passes a saddle: it is then corrected.
    At a branch point it stays on its own steps, where it is one: the equations tell neither where the point
    is nor which way the branch goes. `most` is how much deviations may grow over a segment of equal duration.
    Of what is not to be `watched` only place, tangent and weights are told.
    """
    problem, born, first = orbit, sample.orientation == 0.0, orbit.uneven and orbit.cuts > 1
    if first:  # what is cut anew stays on its own steps: on others it is no solution yet
        problem, sample = _recut(orbit, sample, recutting(orbit, sample.z, most), closing)
    if problem is orbit:
        try:
            problem = orbit.adapted_to(sample.z, sample.weights)
        except NotFinite:  # on other steps a segment's own start no longer leads to its end
            if born:
                return orbit, sample
            problem, sample = _recut(orbit, sample, halves(orbit), closing)
            if problem is orbit:
                raise
            return problem, sample
        missed = problem.linearize(sample.z).excess_in(sample.weights) > MISSED
        if missed and not orbit.in_closure:  # these are cut: where a field bends, other steps always miss
            return (orbit, sample) if born else _corrected(problem, sample)
    problem, sample = _begun_better(problem, sample, closing)
    if not first:
        problem, sample = _recut(problem, sample, recutting(problem, sample.z, most), closing)
    tangent = problem.into_section(sample.z, sample.tangent)
    if not watched:
        return problem, sample.varied(tangent=unit_in(tangent, sample.weights))
    # Both ends of the next step are seen on the same steps: what they tell differs by the branch alone.
    there = problem.linearize(sample.z)
    again = problem.examine(sample.z, tangent, sample.weights, there, sample.unstable, sample)
    return problem, again.varied(orientation=0.0) if born else again


def _recut(
    orbit: Kind, sample: Sample, cuts: np.ndarray | None, closing: Closing[Kind]
) -> tuple[Kind, Sample]:
    """The same solution in other segments, (m,) in each leg; as it is where that does not converge.

    Segments of equal duration have steps of their own. Where deviations grow on the way, those lead
    elsewhere, and what they miss may be too much for corrections: cut where it grows, the motion keeps its
    steps.
    """
    if cuts is None:
        return orbit, sample
    return (
        _in_segments(orbit, sample, cuts, closing)
        or _in_segments(orbit, sample, grown_cuts(orbit, sample.z), closing)
        or (orbit, sample)
    )


def _in_segments(
    orbit: Kind, sample: Sample, cuts: np.ndarray | None, closing: Closing[Kind]
) -> tuple[Kind, Sample] | None:
    """The same solution in segments that start at times (m,) of each leg; None where that fails."""
    try:
        return None if cuts is None else closing(*recut(orbit, sample, cuts))
    except (NotFinite, np.linalg.LinAlgError):
        return None


def _begun_better(orbit: Kind, sample: Sample, closing: Closing[Kind]) -> tuple[Kind, Sample]:
    """The same solution, begun where its section is well, if the phase is free: see `section`."""
    if not orbit.in_closure or orbit.forced or not orbit.moves(sample.z):
        return orbit, sample
    times, speeds = speeds_of(orbit, sample.z)
    begin = better_phase(times, speeds, np.concatenate([np.diff(steps) for steps in orbit.mesh.steps]))
    if begin is None:
        return orbit, sample
    later = moved(orbit, sample, begin, begun_at(orbit, sample.z, begin))
    return closing(*later) or (orbit, sample)


def _corrected(orbit: Kind, sample: Sample) -> tuple[Kind, Sample]:
    """A solution of other steps corrected on these, and steps made for what it has become."""
    normal = sample.tangent / sample.weights**2
    z = newton_on(orbit, sample.z, sample.weights, normal)
    problem = orbit.adapted_to(z, sample.weights)
    there = problem.linearize(z)
    again = problem.examine(z, there.tangent(normal, sample.weights), sample.weights, there, sample.unstable)
    return problem, replace(again, iterations=sample.iterations)
