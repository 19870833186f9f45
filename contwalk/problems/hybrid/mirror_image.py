"""Orbits with events whose branch leaves a symmetric one: each half is the image of the other.

A symmetry takes legs to legs. Where the legs of a whole orbit, some of them later, are the images of its own,
and the orbit that its branch leaves is its own image so, the orbits on one side of the branch are the images
of those on the other: states through the map, durations exchanged with their legs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.limits import LABELS as LIMITS
from contwalk.problems.images import Product, products
from contwalk.problems.orbit.itinerary import Leg, has_image, image_of
from contwalk.problems.orbit.mirror_of_orbits import MirrorOfOrbits
from contwalk.problems.orbit.stored_discretizations import vectors_of
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues


def mirror_of(problem: LimitedOrbit, sample: Sample) -> HybridMirror | None:
    """What takes one half of a branch to the other, by the orbit that it leaves and the deviation there.

    None where no declared symmetry, or product of some, does; for orbits that close up to a symmetry, turn,
    meet no event, or are held along neutral directions it is not looked for.
    """
    itinerary = problem.itinerary
    if any(transition.role == "soft" for transition in problem.system.transitions):
        return None  # that soft transitions are images of each other is not looked for
    if itinerary.image or not itinerary.eventful or problem.pins or np.any(problem.turns):
        return None
    there, p = None, ParameterValues(**problem.values_of(sample.z))
    for product in products(problem.system, problem.first_state(sample.z), p):
        for first in range(len(itinerary)):
            if _images(problem, product, itinerary.legs[first:] + itinerary.legs[:first]) != itinerary.legs:
                continue
            there = there or problem.adapted_to(sample.z, sample.weights)
            for half in (0, 1) if problem.forced else (0,):
                mirror = HybridMirror(problem, product, first, half, sample)
                if mirror.keeps(there, sample):
                    return mirror
    return None


def _images(problem: LimitedOrbit, product: Product, legs: tuple[Leg, ...]) -> tuple[Leg, ...] | None:
    """What a product of symmetries takes legs to; None where there is no such transition."""
    for symmetry in product.symmetries:
        if symmetry.role != "spatial" or not all(has_image(problem.system, symmetry, leg) for leg in legs):
            return None
        legs = tuple(image_of(problem.system, symmetry, leg) for leg in legs)
    return legs


class HybridMirror(MirrorOfOrbits[LimitedOrbit]):
    """The map from one half of a branch of whole orbits with events to the other.

    Parameters
    ----------
    problem, product, born
        See `MirrorOfOrbits`.
    first : int
        The leg whose image is the first one.
    half : int
        Whether the image begins half a closure earlier than that leg, as where the force is reversed then.
    """

    def __init__(self, problem: LimitedOrbit, product: Product, first: int, half: int, born: Sample) -> None:
        super().__init__(problem, product, born)
        self._first, self._half = first, half

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself: limits are told by names of events."""
        return f"a limit ({point.label}) has to be located" if point.label in LIMITS else ""

    # -- the map -----------------------------------------------------------------------------------------

    def _pairs(self, there: LimitedOrbit) -> Iterator[tuple[int, int]]:
        """Each segment of the image, and the one that it is the image of, by their numbers."""
        layout, legs = there.layout, there.layout.legs
        begins = np.concatenate([[0], np.cumsum(layout.cuts)])
        for i in range(legs):
            source = (i + self._first) % legs
            for j in range(layout.cuts[i]):
                yield int(begins[i]) + j, int(begins[source]) + j

    def _image(
        self, there: LimitedOrbit, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Image of an orbit and of a deviation of it, each of shape (N + 1,)."""
        layout, image, moved = there.layout, z.copy(), tangent.copy()
        p, by_parameter = self._parameters(there, z, weights)
        for own, source in self._pairs(there):
            to, of = layout.segments[own], layout.segments[source]
            kept = list(there.passages[to.leg].states)
            x, v = (there.passages[of.leg].full(given[of.states]) for given in (z, tangent))
            image[to.states] = self._product.state(x, p)[kept]
            moved[to.states] = (self._linear @ v + by_parameter(x) * tangent[-1])[kept]
        for given, result in ((z, image), (tangent, moved)):
            lasting = given[layout.durations]
            result[layout.durations] = np.roll(lasting, -self._first)
            if layout.start is not None:
                begins = given[layout.start] + lasting[: self._first].sum()
                result[layout.start] = begins - 0.5 * self._half * lasting.sum()
        return image, moved

    def _weights(self, there: LimitedOrbit, weights: np.ndarray) -> np.ndarray:
        layout, result = there.layout, weights.copy()
        for own, source in self._pairs(there):
            to, of = layout.segments[own], layout.segments[source]
            full = there.passages[of.leg].full(weights[of.states])
            result[to.states] = self._metric(full)[list(there.passages[to.leg].states)]
        result[layout.durations] = np.roll(weights[layout.durations], -self._first)
        return result

    def _mirrored(self, there: LimitedOrbit, image: np.ndarray) -> LimitedOrbit:
        """The problem for images: each leg on the steps of the one that it is the image of."""
        mesh, pairs = there.mesh, list(self._pairs(there))
        mesh = replace(
            mesh,
            steps=tuple(mesh.steps[source] for _, source in pairs),
            grown=tuple(mesh.grown[source] for _, source in pairs) if mesh.grown else mesh.grown,
            guards=None if mesh.guards is None else np.roll(mesh.guards, -self._first),
            variation=self._metric(mesh.variation),
            magnitudes=self._metric(mesh.magnitudes),
        )
        return there.on(mesh, there.section)

    # -- what is stored ----------------------------------------------------------------------------------

    def _told(
        self, own: LimitedOrbit, image: np.ndarray, moved: np.ndarray, metric: np.ndarray, row: np.void
    ) -> tuple[Sample, dict[str, Any]]:
        sample = own.examine(image, moved, metric, own.linearize(image), int(row["unstable"]))
        told = {
            "state": own.reported(image),
            "observables": [*sample.observables[:-1], row["observables"][-1]],
            "admissible": sample.admissible,
        }
        return sample, told

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name."""
        z, weights, _ = vectors_of(row)
        return self._problem.adapted_to(z, weights).margins(z).by_name

    def _limits(self, own: LimitedOrbit, image: np.ndarray) -> dict[str, Any]:
        margins = own.margins(image)
        return {"admissible": margins.admissible, "margin": margins.by_name}
