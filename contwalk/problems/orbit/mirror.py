"""Orbits whose branch leaves a symmetric one: each half is the image of the other under a symmetry.

Where a branch of whole orbits leaves one that is its own image under a symmetry S, along a deviation that S
reverses, the orbits on one side are the images of those on the other: y(t) = S x(t + share), or leg by leg
where events divide them.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.images import Product, point_of_image, products, refused_limit, row_of_image
from contwalk.problems.orbit import monodromy, normal_forms
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.image import Beginning, OrbitImage
from contwalk.problems.orbit.instants import Instants
from contwalk.problems.orbit.itinerary import Leg, has_image, image_of
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.observing import measured_along
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.problems.orbit.shooting import velocity
from contwalk.problems.orbit.stored_discretizations import StoredDiscretizations, vectors_of
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues

# A problem of orbits: of those that limits bound, margins are asked for as well.
Own = Any
# An orbit, a deviation of it, and its metric, each of shape (N + 1,).
Given = tuple[np.ndarray, np.ndarray, np.ndarray]

# In the metric, an orbit that is kept comes back this exactly, and a deviation that is reversed: they are
# known to errors of the steps, times their growth.
KEPT, REVERSED = 1e-5, 1e-3
# Residuals this many times above their level are those of solutions, as of the corrector's. A located point
# was solved for on other steps than the finest ones, on which its image is looked at: it may miss them,
# and its image by so many times as much as deviations grow on the way.
SOLVED, AS_WELL = 20.0, 100.0
# Parts of the period within which two instants are one, on the way to a section.
SAME_INSTANT = 1e-13
MOST_SHIFTS = 12


def mirror_of(problem: DiscretizedOrbit, sample: Sample) -> OrbitMirror | None:
    """What takes one half of a branch to the other, by the orbit that it leaves and the deviation there.

    None where no declared symmetry, or product of some, does; for orbits that close up to a symmetry, turn,
    pass soft transitions, or are held along neutral directions it is not looked for.
    """
    if not problem.system.symmetries or problem.itinerary.image or np.any(problem.turns):
        return None
    if problem.pins or not problem.moves(sample.z):
        return None
    there, p = None, ParameterValues(**problem.values_of(sample.z))
    for product in products(problem.system, problem.first_state(sample.z), p):
        for begins in beginnings_of(problem, product):
            there = there or problem.adapted_to(sample.z, sample.weights)
            mirror = OrbitMirror(problem, product, begins, sample)
            if mirror.keeps(there, sample) and mirror.carried(sample.z):
                return mirror
    return None


def beginnings_of(problem: DiscretizedOrbit, product: Product) -> Iterator[Beginning]:
    """Where an image under symmetries may begin: at a leg, of whose images it is made, or later by parts."""
    legs = problem.itinerary.legs
    if not problem.itinerary.eventful:
        # Steps of one leg are alike in so many parts; those of orbits that limits bound are not.
        parts = problem.parts if problem.in_closure else 0
        yield from (Beginning(share=part / parts) for part in range(parts))
        return
    if any(transition.role == "soft" for transition in problem.system.transitions):
        return  # that soft transitions are images of each other is not looked for
    for first in range(len(legs)):
        if _images(problem, product, legs[first:] + legs[:first]) == legs:
            yield from (Beginning(first, half=half) for half in ((0, 1) if problem.forced else (0,)))


def _images(problem: DiscretizedOrbit, product: Product, legs: tuple[Leg, ...]) -> tuple[Leg, ...] | None:
    """What a product of symmetries takes legs to; None where there is no such transition."""
    for symmetry in product.symmetries:
        if symmetry.role != "spatial" or not all(has_image(problem.system, symmetry, leg) for leg in legs):
            return None
        legs = tuple(image_of(problem.system, symmetry, leg) for leg in legs)
    return legs


class OrbitMirror:
    """The map from one half of a branch of whole orbits to the other.

    Parameters
    ----------
    problem : DiscretizedOrbit
    product : Product
        The symmetries that make it, affine maps of the state.
    begins : Beginning
        Where the image of an orbit begins.
    born : Sample
        The orbit that the branch leaves.
    """

    def __init__(self, problem: Own, product: Product, begins: Beginning, born: Sample) -> None:
        self._problem, self._product, self._born = problem, product, born
        p = ParameterValues(**problem.values_of(born.z))
        sizes = np.maximum(np.abs(problem.first_state(born.z)), problem.mesh.variation)
        self._map = OrbitImage(product, product.linear(sizes, p), begins)
        self._stored = StoredDiscretizations(problem)
        self._samples: dict[bytes, Sample] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        return self._product.names

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself: limits are told by names of events."""
        return refused_limit(self._problem, point)

    # -- whether it is one -------------------------------------------------------------------------------

    def keeps(self, there: DiscretizedOrbit, sample: Sample) -> bool:
        """Whether an orbit is its own image, and its deviation is reversed."""
        z, tangent = self._map.of(there, sample.z, sample.tangent, sample.weights)
        if float(np.max(np.abs(z - sample.z) / sample.weights)) > KEPT:
            return False
        apart = there.into_section(sample.z, tangent) + there.into_section(sample.z, sample.tangent)
        return float(np.linalg.norm(apart / sample.weights)) < REVERSED

    def carried(self, z: np.ndarray) -> bool:
        """Whether the field is carried, a part of the period later, at a state off the orbit.

        Legs through events are images as far as the symmetry is declared to take modes and events to each
        other. z has the shape (N + 1,).
        """
        problem = self._problem
        if problem.itinerary.eventful:
            return True
        p, values = ParameterValues(**problem.values_of(z)), problem.given(z)
        scale, at = problem.mesh.variation, 0.3
        x = problem.starts(z)[0] + 0.1 * scale * np.cos(np.arange(1.0, problem.states + 1.0))
        moved = self._map.moved(velocity(problem.passages[0], x, at + self._map.begins.share, values))
        there = velocity(problem.passages[0], self._map.state(x, p), at, values)
        return bool(np.linalg.norm((moved - there) / scale) <= 1e-8 * np.linalg.norm(moved / scale))

    # -- what is stored ----------------------------------------------------------------------------------

    def row(self, row: np.void, before: np.void, last: np.void) -> np.ndarray | None:
        """The stored image of a stored orbit, shape (1,); None if it does not solve the equations.

        It is asked of the steps that the orbit was solved for on, those of the one before it; of its own, if
        it was cut or begun anew.
        """
        began, spent = time.perf_counter(), self._problem.evaluations
        z, weights, tangent = vectors_of(row)
        for there in self._stored.of_row(row, before, z, weights):
            image, moved = self._map.of(there, z, tangent, weights)
            own, metric = self._map.problem(there, image), self._map.weights(there, weights)
            here = own.linearize(image)
            excess = here.excess_in(metric) if here.finite else np.inf
            missed = there.linearize(z).excess_in(weights) if row["special"] else 0.0
            if excess <= SOLVED + AS_WELL * missed:
                break
        else:
            return None
        trivial = monodromy.trivial_error(own, image, here.jacobian)
        begun = self._begun(there, (z, tangent, weights), (own, image, moved), last)
        if begun is None:
            return None
        own, image, moved = begun
        moved = -moved / np.linalg.norm(moved / metric)
        sample, told = self._told(own, image, moved, metric, row)
        found = row_of_image(
            row,
            image,
            moved,
            metric,
            trivial_error=trivial,
            residual=excess,
            rhs=self._problem.evaluations - spent,
            seconds=time.perf_counter() - began,
            **told,
        )
        self._samples[found["unknowns"].tobytes()] = sample
        return found

    def _in_section(
        self, there: DiscretizedOrbit, z: np.ndarray, own: DiscretizedOrbit, image: np.ndarray, last: np.void
    ) -> tuple[float, DiscretizedOrbit] | None:
        """How much later the image is in the section of the one before, and the problem with that section.

        None where no such instant is found.
        """
        known, n = vectors_of(last)[0], there.states
        values = there.given(image)
        cut = own.on(own.mesh, section_through(there, known[:n], values, own.mesh.magnitudes))
        assert cut.section is not None
        passed, p = Instants(there, z, np.zeros(len(z))), ParameterValues(**there.values_of(z))
        times, nodes = passed.nodes
        apart = (np.array([self._map.state(x, p) for x in nodes]) - known[:n]) / own.mesh.variation
        instant = first = float(times[int(np.argmin(np.linalg.norm(apart, axis=1)))])
        width = 2.0 * float(np.max(np.diff(times)))
        for _ in range(MOST_SHIFTS):
            x, _ = passed.at(instant)
            rate = self._map.moved(velocity(there.passages[0], x, instant % 1.0, values))
            step = cut.section.residual(self._map.state(x, p)) / float(cut.section.normal @ rate)
            instant -= step
            if not abs(instant - first) <= width:
                return None
            if abs(step) < SAME_INSTANT:
                return instant - self._map.begins.share, cut
        return None

    def _begun(
        self, there: Own, given: Given, image: tuple[Own, np.ndarray, np.ndarray], last: np.void
    ) -> tuple[Own, np.ndarray, np.ndarray] | None:
        """Problem, image and deviation where a walk would have them begin; None where that is not found.

        Where an event or a force fixes the phase there is nothing to choose.
        """
        if image[0].section is None:
            return image
        found = self._in_section(there, given[0], *image[:2], last)
        if found is None:
            return None
        shift, own = found
        z, moved = self._map.of(there, *given, shift)
        return own, z, own.into_section(z, moved)

    def _told(
        self, own: Own, image: np.ndarray, moved: np.ndarray, metric: np.ndarray, row: np.void
    ) -> tuple[Sample, dict[str, Any]]:
        """The sample of an image, and what its row tells: state, observables and admissibility."""
        if own.limited is not None:
            sample = own.examine(image, moved, metric, own.linearize(image), int(row["unstable"]))
            measured, admissible = [*sample.observables[:-1]], sample.admissible
        else:
            sample = replace(self._born, z=image, weights=metric, kinks=kinks_along(own, image))
            measured, admissible = measured_along(own, image), not self._forbidden(own, image)
        observables = [*measured, row["observables"][-1]]
        return sample, {"state": own.reported(image), "observables": observables, "admissible": admissible}

    def _forbidden(self, own: DiscretizedOrbit, image: np.ndarray) -> bool:
        """Whether a smooth orbit passes over events of its machine."""
        return own.system.has_events and passed_over(own.system, *own.motion_of(image), own.values_of(image))

    def sample(self, row: np.void) -> Sample:
        """Place, metric and kinks of an image, as a sample."""
        z, weights, _ = vectors_of(row)
        return self._samples.get(
            row["unknowns"].tobytes(), replace(self._born, z=z, weights=weights, kinks=())
        )

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name; of orbits without limits nothing."""
        if self._problem.limited is None:
            return {}
        z, weights, _ = vectors_of(row)
        by_name: Mapping[str, float] = self._problem.adapted_to(z, weights).margins(z).by_name
        return by_name

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point: what is counted before it there is counted after it."""
        given = np.array(point.unknowns), np.array(point.tangent), vectors_of(row)[1]
        there = self._stored.finest(given[0], given[2])
        image, moved = self._map.of(there, *given)
        begun = self._begun(there, given, (self._map.problem(there, image), image, moved), last)
        assert begun is not None  # its row has been found
        own, image, moved = begun
        state = dict(zip(own.system.state_names, own.reported(image).tolist(), strict=True))
        odd = coefficients_of(own, point, image)
        told: dict[str, Any] = {"coefficients": odd}
        if own.limited is not None:
            margins = own.margins(image)
            told |= {"admissible": margins.admissible, "margin": margins.by_name}
        return point_of_image(point, state, image, -moved, **told)


def coefficients_of(own: DiscretizedOrbit, point: SpecialPoint, image: np.ndarray) -> dict[str, Any]:
    """Coefficients of the normal form: odd ones have the sign of the critical vector at the image.

    The image has the shape (N + 1,).
    """
    given: dict[str, Any] = dict(point.coefficients)
    odd = {"LP": ("a", "b"), "BP": ("c11", "c22")}.get(point.label, ())
    if not all(isinstance(given.get(name), float) for name in odd) or not odd:
        return given
    return_map = own.return_map(image)
    found = (
        normal_forms.fold(return_map)
        if point.label == "LP"
        else normal_forms.branch_point(return_map, abs(float(image[-1])) or 1.0)
    )
    lead = max(odd, key=lambda name: abs(given[name]))
    if found[lead] * given[lead] < 0.0:
        given |= {name: -given[name] + 0.0 for name in odd}
    return given
