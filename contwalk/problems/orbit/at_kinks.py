"""An orbit on steps that end where its field changes from one smooth piece to the next.

A step that holds such a place carries deviations by both pieces in shares that its stages happen to have: the
motion is right to the tolerance of the steps, its derivative to the root of that. So derivatives are computed
on steps of which none holds one. A step ends a little before the place and another one begins a little after
it: right there roundings would say which piece a stage belongs to.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from contwalk.numerics.distinct import distinct
from contwalk.problems import kinks
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit

# Half the length of what lies between two such steps, of a leg: some hundred roundings of the instant.
BESIDE = 1e-11
# Ends of further steps around such a place, so long before and after it, of a leg: late stages of an
# explicit step are known far less well than its end, and those of a long one may lie past the place. Where a
# solution is corrected on these steps the place moves: into a short one.
AROUND = np.array([3e-3, 1e-4, 3e-6])
# Length of it from which its effect is told, in units of that.
WIDER = 3.0
# Times that instants are told anew on steps that end where they were told before. Each time they are off by
# the square of what they were, so that a few do; one that is passed at no speed is known less well.
PASSES = 6
# Solutions of which such steps are kept: several parts of a point ask for them.
MOST_KEPT = 3

AnyOrbit = TypeVar("AnyOrbit", bound=DiscretizedOrbit)


def ending_at_kinks(orbit: AnyOrbit, z: np.ndarray, beside: float = BESIDE) -> AnyOrbit:
    """The same orbit on steps that end beside the kinks that the motion of z meets; itself if there are none.

    z has the shape (N + 1,).
    """
    if all(passage.switching is None for passage in orbit.passages):
        return orbit
    return orbit.known.at(f"at kinks {beside}", z, MOST_KEPT, lambda: _ending_at_kinks(orbit, z, beside))


def _ending_at_kinks(orbit: AnyOrbit, z: np.ndarray, beside: float) -> AnyOrbit:
    there, before = orbit, None
    for _ in range(PASSES):
        instants = _instants(there, z)
        if not any(len(own) for own in instants):
            return there
        if before is not None and _settled(instants, before, 0.5 * beside):
            return there
        there, before = _on_steps(orbit, instants, beside), instants
    return there


def _settled(instants: list[np.ndarray], before: list[np.ndarray], within: float) -> bool:
    """Whether instants, (k,) of each leg, are those that steps were made for."""
    pairs = zip(instants, before, strict=True)
    return all(len(a) == len(b) and np.all(np.abs(a - b) < within) for a, b in pairs)


def _instants(orbit: DiscretizedOrbit, z: np.ndarray) -> list[np.ndarray]:
    """When the motion of z changes from one piece of its field to another, 0..1 of each leg, (k,) each."""
    return [
        np.concatenate([np.zeros(0), *(kinks.bends(course) for course in view.course())])
        for view in orbit.view(z)
    ]


def _on_steps(orbit: AnyOrbit, instants: list[np.ndarray], beside: float) -> AnyOrbit:
    """The same orbit with steps that end beside instants, (k,) of each leg."""
    steps = []
    for segment, own in zip(orbit.layout.segments, orbit.mesh.steps, strict=True):
        length = 1.0 if orbit.in_closure else segment.end - segment.begin
        since = 0.0 if orbit.in_closure else segment.begin
        steps.append(_split(own, (instants[segment.leg] - since) / length, beside / length))
    mesh = replace(orbit.mesh, steps=tuple(steps))
    return orbit.varied(_mesh=mesh, on_own_steps=True)


def _split(steps: np.ndarray, instants: np.ndarray, beside: float) -> np.ndarray:
    """Steps, (s + 1,), cut to both sides of instants within them, (k,)."""
    first, last = steps[0] + 2.0 * beside, steps[-1] - 2.0 * beside
    own = instants[(instants > first) & (instants < last)]
    around = (own[:, None] + np.concatenate([-AROUND, AROUND])).ravel()
    others = np.concatenate([steps[1:-1], around[(around > first) & (around < last)]])
    near = np.abs(others[:, None] - own).min(axis=1, initial=np.inf)
    kept = others[near > 2.0 * beside]
    return distinct(np.concatenate([steps[:1], kept, own - beside, own + beside, steps[-1:]]))
