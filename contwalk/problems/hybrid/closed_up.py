"""Whether the symmetry that an orbit closes up to is the machine's for other parameters too.

A part of an orbit is all of it where the rest is its image. Where a parameter moves that breaks the symmetry,
as the strength of a second harmonic does, what closes up to it is no orbit any more.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid.mirrors import Span, carries
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit


def spans_of(problem: DiscretizedOrbit, z: np.ndarray) -> list[Span]:
    """The legs of an orbit as they are passed. z has the shape (N + 1,)."""
    spans = []
    for stretch in problem.stretches(z):
        (begin, x), (end, y) = stretch.start, stretch.end
        spans.append(Span(stretch.view.piece.passage.leg, begin, x, end - begin, y))
    return spans


def broken_at(problem: DiscretizedOrbit, z: np.ndarray, values: Mapping[str, float]) -> str:
    """The symmetry that an orbit closes up to, and that other values of the parameters break; empty if none.

    z has the shape (N + 1,).
    """
    system, own, name = problem.system, problem.values_of(z), problem.itinerary.image
    if not name:
        return ""
    periods = problem.duration(z) / period_at(system, own) if problem.forced else 0.0
    symmetry, spans = system.symmetry(name), spans_of(problem, z)
    held = [
        carries(system, [each], symmetry, spans, periods, problem.mesh.variation) for each in (own, values)
    ]
    return name if held[0] and not held[1] else ""
