"""The image of an orbit under symmetries: where on the orbit it begins, and on which steps it is solved.

A symmetry takes legs to legs, so the image of an orbit through events begins with the image of one of its
legs: states go through the map, durations with their legs. Where no event divides the orbit, the image may
begin any part of the period later. On steps that are alike in these parts it is a discretised orbit too, to
rounding: it is asked of the equations on the steps on which the orbit was solved for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.problems.images import Product
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.instants import Instants
from contwalk.problems.orbit.layout import Segment
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.system.declarations import ParameterValues

# Change of the parameter, in its weight, that tells how a symmetry moves with it.
MOVED = 1e-4


@dataclass(frozen=True)
class Beginning:
    """Where on an orbit its image begins.

    Parameters
    ----------
    leg : int
        The leg whose image is the first one.
    share : float
        The part of the period after that leg's start; zero where events divide the orbit.
    half : int
        Whether the image begins half a closure earlier in the time of a force, which is reversed then.
    """

    leg: int = 0
    share: float = 0.0
    half: int = 0


class OrbitImage:
    """The map that takes an orbit, with a deviation of it, to its image.

    Parameters
    ----------
    product : Product
        The symmetries that make it, affine maps of the state.
    linear : ndarray, shape (n, n)
        Their derivative.
    begins : Beginning
    """

    def __init__(self, product: Product, linear: np.ndarray, begins: Beginning) -> None:
        self._product, self._linear, self.begins = product, linear, begins
        self._known: tuple[DiscretizedOrbit, bytes, Instants] | None = None

    def state(self, x: np.ndarray, p: ParameterValues) -> np.ndarray:
        """Image of a state, shape (n,)."""
        return self._product.state(x, p)

    def moved(self, v: np.ndarray) -> np.ndarray:
        """Image of a change of the state, shape (n,)."""
        moved: np.ndarray = self._linear @ v
        return moved

    def metric(self, values: np.ndarray) -> np.ndarray:
        """Magnitudes of the image's states, of those of a state, shape (n,)."""
        return np.sqrt((self._linear * self._linear) @ (values * values))

    def of(
        self,
        there: DiscretizedOrbit,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        shift: float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Image of an orbit and of a deviation of it, each of shape (N + 1,), beginning later by a share."""
        layout, image, moved = there.layout, z.copy(), tangent.copy()
        p, by_parameter = self._parameters(there, z, weights)
        later = self.begins.share + shift
        for to, of in self._pairs(there):
            kept = list(there.passages[to.leg].states)
            if later:
                x, v = self._instants(there, z, tangent).at(later + of.begin)
            else:
                x, v = (there.passages[of.leg].full(given[of.states]) for given in (z, tangent))
            image[to.states] = self._product.state(x, p)[kept]
            moved[to.states] = (self._linear @ v + by_parameter(x) * tangent[-1])[kept]
        for given, result in ((z, image), (tangent, moved)):
            lasting = given[layout.durations]
            result[layout.durations] = np.roll(lasting, -self.begins.leg)
            if layout.start is not None:
                begins = given[layout.start] + lasting[: self.begins.leg].sum()
                result[layout.start] = begins - 0.5 * self.begins.half * lasting.sum()
        return image, moved

    def weights(self, there: DiscretizedOrbit, weights: np.ndarray) -> np.ndarray:
        """The metric of an image, of that of an orbit. Shape (N + 1,) each."""
        layout, result = there.layout, weights.copy()
        for to, of in self._pairs(there):
            full = there.passages[of.leg].full(weights[of.states])
            result[to.states] = self.metric(full)[list(there.passages[to.leg].states)]
        result[layout.durations] = np.roll(weights[layout.durations], -self.begins.leg)
        return result

    def problem(self, there: DiscretizedOrbit, image: np.ndarray) -> DiscretizedOrbit:
        """The problem for an image, shape (N + 1,): each segment on the steps of the one that it is the image
        of, a section where the image begins.
        """
        mesh, first = there.mesh, self.begins.leg
        places = {id(segment): i for i, segment in enumerate(there.layout.segments)}
        sources = [places[id(of)] for _, of in self._pairs(there)]
        mesh = replace(
            mesh,
            steps=tuple(mesh.steps[i] for i in sources),
            grown=tuple(mesh.grown[i] for i in sources) if mesh.grown else mesh.grown,
            guards=None if mesh.guards is None else np.roll(mesh.guards, -first),
            variation=self.metric(mesh.variation),
            magnitudes=self.metric(mesh.magnitudes),
        )
        x = there.first_state(image)
        return there.on(mesh, section_through(there, x, there.given(image), mesh.magnitudes))

    def _pairs(self, there: DiscretizedOrbit) -> Iterator[tuple[Segment, Segment]]:
        """Each segment of the image, and the one that it is the image of."""
        legs = there.layout.legs
        for i in range(legs):
            source = there.layout.segments_of((i + self.begins.leg) % legs)
            yield from zip(there.layout.segments_of(i), source, strict=True)

    def _instants(self, there: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> Instants:
        key = z.tobytes() + tangent.tobytes()
        if self._known is None or self._known[0] is not there or self._known[1] != key:
            self._known = there, key, Instants(there, z, tangent)
        return self._known[2]

    def _parameters(
        self, there: DiscretizedOrbit, z: np.ndarray, weights: np.ndarray
    ) -> tuple[ParameterValues, Callable[[np.ndarray], np.ndarray]]:
        """Parameters at z, and how the image of a state moves with the free one."""
        change = np.zeros(len(z))
        change[-1] = MOVED * weights[-1]
        low, p, high = (ParameterValues(**there.values_of(each)) for each in (z - change, z, z + change))

        def by_parameter(x: np.ndarray) -> np.ndarray:
            return (self._product.state(x, high) - self._product.state(x, low)) / (2.0 * change[-1])

        return p, by_parameter
