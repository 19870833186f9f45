"""An orbit discretised anew: steps made for it, its section, and its sample on both."""

from __future__ import annotations

from dataclasses import replace

from contwalk.errors import NotFinite
from contwalk.problems.hybrid import cutting
from contwalk.problems.hybrid.limited_orbit import Kind
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.sample import Sample

# Residuals so many times above their level are no solution's.
MISSED = 3e4


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
