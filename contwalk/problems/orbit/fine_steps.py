"""Orbits on the fine steps on which special points are looked at, from solutions alone."""

from __future__ import annotations

import numpy as np

from contwalk import flow
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, Kind
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.meshing import runs_of
from contwalk.problems.orbit.shooting import AT_REST
from contwalk.system.variables import declared_scales

# Size of a state that starts show nothing of, against the largest; tolerance of steps for magnitudes only.
UNSEEN, ROUGH = 1e-2, 1e-7
# Even steps of a segment for magnitudes of states that are zero wherever one starts, but for rounding: below
# this part of them.
PILOT, NOTHING = (16, 32), 1e-9
# A state below this is zero in any unit.
NO_UNIT = 1e-30


def discretized(problem: Kind, z: np.ndarray, parent: DiscretizedOrbit | None = None) -> Kind:
    """The problem on fine steps for a stored solution, which may have other segments.

    A solution at rest may be a rounding of zero, which is no scale. What its states are measured in is known
    where the problem, or the parent that it is an orbit of, has been walked along.

    z has the shape (N + 1,).
    """
    problem = problem.fitting(z)
    if parent is not None:
        return _discretized(problem, z, parent)
    # All that is looked for beside a special point begins with it.
    return problem.known.at("discretized", z, 1, lambda: _discretized(problem, z, None))


def _discretized(problem: Kind, z: np.ndarray, parent: DiscretizedOrbit | None) -> Kind:
    """As `discretized`, of a problem with the segments of z, shape (N + 1,)."""
    reached = np.zeros(problem.states)
    for place, passage in problem.places:
        own = list(passage.states)
        reached[own] = np.maximum(reached[own], np.abs(z[place]))
    between = _between(problem, z)
    if float(reached.max()) < NOTHING * float(between.max()):  # a mass that rests wherever a segment starts
        reached = between
    mesh = problem._mesh or (None if parent is None else parent._mesh)
    typical, least = (np.ones(problem.states), NO_UNIT) if mesh is None else (mesh.magnitudes, AT_REST)
    if np.all(reached <= least * typical):
        reached = typical
    # What is zero at the starts of segments is not zero on them; of some states the plugin tells how large.
    scales = declared_scales(problem.system.states)
    reached = np.maximum(reached, np.where(np.isfinite(scales), scales, UNSEEN * float(reached.max())))
    rough = problem.adapted_to(z, problem.weighted(reached), max(problem.discretization.walking, ROUGH))
    return rough.adapted_to(z, filled_magnitudes(rough, z), problem.discretization.locating)


def _between(problem: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """How large each state becomes on the segments, roughly; zero where a few even steps do not tell."""
    found = []
    for count in PILOT:
        reached = np.zeros(problem.states)
        for run in runs_of(problem, z):
            field, times = run.passage.field(PLAIN), np.linspace(run.begin, run.end, count + 1)
            c = field.constants(np.concatenate([run.scalars, problem.line.constants]))
            states = flow.along(field, c, times, run.x, "dop853")
            if not np.isfinite(states).all():
                return np.zeros(problem.states)
            own = list(run.passage.states)
            reached[own] = np.maximum(reached[own], np.abs(states).max(axis=0))
        found.append(reached)
    rough, finer = found
    alike = np.all(np.abs(rough - finer) <= 0.1 * finer.max())
    return finer if alike else np.zeros(problem.states)
