"""What takes one half of a branch of orbits to the other, where they are images under a symmetry."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Generic, TypeVar

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.images import Product, point_of_image, row_of_image
from contwalk.problems.orbit import monodromy, normal_forms
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.stored_discretizations import StoredDiscretizations, vectors_of
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues

Own = TypeVar("Own", bound=OrbitData)
# An orbit, a deviation of it, and its metric, each of shape (N + 1,); a problem, an orbit and a deviation.
Given = tuple[np.ndarray, np.ndarray, np.ndarray]

# In the metric, an orbit that is kept comes back this exactly, and a deviation that is reversed: they are
# known to errors of the steps, times their growth.
KEPT, REVERSED = 1e-5, 1e-3
# Residuals this many times above their level are those of solutions, as of the corrector's. A located point
# was solved for on other steps than the finest ones, on which its image is looked at: it may miss them,
# and its image by so many times as much as deviations grow on the way.
SOLVED, AS_WELL = 20.0, 100.0
# Change of the parameter, in its weight, that tells how a symmetry moves with it.
MOVED = 1e-4


class MirrorOfOrbits(ABC, Generic[Own]):
    """The map from one half of a branch of whole orbits to the other.

    Parameters
    ----------
    problem : OrbitData
    product : Product
        The symmetries that make it, affine maps of the state.
    born : Sample
        The orbit that the branch leaves.
    """

    def __init__(self, problem: Own, product: Product, born: Sample) -> None:
        self._problem, self._product, self._born = problem, product, born
        p = ParameterValues(**problem.values_of(born.z))
        sizes = np.maximum(np.abs(problem.first_state(born.z)), problem.mesh.variation)
        self._linear = product.linear(sizes, p)
        self._stored = StoredDiscretizations(problem)
        self._samples: dict[bytes, Sample] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        return self._product.names

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself; empty, as it has not."""
        return ""

    # -- the map -----------------------------------------------------------------------------------------

    def keeps(self, there: Own, sample: Sample) -> bool:
        """Whether an orbit is its own image, and its deviation is reversed."""
        z, tangent = self._image(there, sample.z, sample.tangent, sample.weights)
        if float(np.max(np.abs(z - sample.z) / sample.weights)) > KEPT:
            return False
        apart = there.into_section(sample.z, tangent) + there.into_section(sample.z, sample.tangent)
        return float(np.linalg.norm(apart / sample.weights)) < REVERSED

    @abstractmethod
    def _image(
        self, there: Own, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Image of an orbit and of a deviation of it, each of shape (N + 1,)."""

    @abstractmethod
    def _weights(self, there: Own, weights: np.ndarray) -> np.ndarray:
        """The metric of an image."""

    @abstractmethod
    def _mirrored(self, there: Own, image: np.ndarray) -> Own:
        """The problem for an image, on the steps that those of the orbit are taken to."""

    def _begun(
        self, there: Own, given: Given, image: tuple[Own, np.ndarray, np.ndarray], last: np.void
    ) -> tuple[Own, np.ndarray, np.ndarray] | None:
        """Problem, image and deviation where a walk would have them begin; None where that is not found."""
        return image

    def _parameters(
        self, there: Own, z: np.ndarray, weights: np.ndarray
    ) -> tuple[ParameterValues, Callable[[np.ndarray], np.ndarray]]:
        """Parameters at z, and how the image of a state moves with the free one."""
        change = np.zeros(len(z))
        change[-1] = MOVED * weights[-1]
        low, p, high = (ParameterValues(**there.values_of(each)) for each in (z - change, z, z + change))

        def by_parameter(x: np.ndarray) -> np.ndarray:
            return (self._product.state(x, high) - self._product.state(x, low)) / (2.0 * change[-1])

        return p, by_parameter

    def _metric(self, values: np.ndarray) -> np.ndarray:
        """Magnitudes of the image's states, of those of a state."""
        return np.sqrt((self._linear * self._linear) @ (values * values))

    # -- what is stored ----------------------------------------------------------------------------------

    def row(self, row: np.void, before: np.void, last: np.void) -> np.ndarray | None:
        """The stored image of a stored orbit, shape (1,); None if it does not solve the equations.

        It is asked of the steps that the orbit was solved for on, those of the one before it; of its own, if
        it was cut or begun anew.
        """
        began, spent = time.perf_counter(), self._problem.evaluations
        z, weights, tangent = vectors_of(row)
        for there in self._stored.of_row(row, before, z, weights):
            image, moved = self._image(there, z, tangent, weights)
            own, metric = self._mirrored(there, image), self._weights(there, weights)
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

    @abstractmethod
    def _told(
        self, own: Own, image: np.ndarray, moved: np.ndarray, metric: np.ndarray, row: np.void
    ) -> tuple[Sample, dict[str, Any]]:
        """The sample of an image, and what its row tells: state, observables and admissibility."""

    def sample(self, row: np.void) -> Sample:
        """Place, metric and kinks of an image, as a sample."""
        z, weights, _ = vectors_of(row)
        return self._samples.get(
            row["unknowns"].tobytes(), replace(self._born, z=z, weights=weights, kinks=())
        )

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name."""
        return {}

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point: what is counted before it there is counted after it."""
        given = np.array(point.unknowns), np.array(point.tangent), vectors_of(row)[1]
        there = self._stored.finest(given[0], given[2])
        image, moved = self._image(there, *given)
        begun = self._begun(there, given, (self._mirrored(there, image), image, moved), last)
        assert begun is not None  # its row has been found
        own, image, moved = begun
        state = dict(zip(own.system.state_names, own.reported(image).tolist(), strict=True))
        odd = coefficients_of(own, point, image)
        return point_of_image(point, state, image, -moved, coefficients=odd, **self._limits(own, image))

    def _limits(self, own: Own, image: np.ndarray) -> dict[str, Any]:
        """What the record of an image tells of limits."""
        return {}


def coefficients_of(own: OrbitData, point: SpecialPoint, image: np.ndarray) -> dict[str, Any]:
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
