"""Orbits whose branch leaves a symmetric one: each half is the image of the other under a symmetry.

Where a branch of whole orbits leaves one that is its own image under a symmetry S, some part of the period
later, along a deviation that S reverses, the orbits on one side are y(t) = S x(t + share) of those on the
other. On steps that are alike in these parts, the image of a discretised orbit is one too, to rounding: it is
asked of the equations on the steps on which the orbit was solved for.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contwalk import flow
from contwalk.problems.images import Product, products
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.mirror_of_orbits import Given, MirrorOfOrbits
from contwalk.problems.orbit.observing import measured_along
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.problems.orbit.shooting import arrived, velocity
from contwalk.problems.orbit.stored_discretizations import vectors_of
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues

# Parts of the period within which two instants are one, on the way to a section and at the steps.
SAME_INSTANT, AT_STEP = 1e-13, 1e-14
MOST_SHIFTS = 12
# What lies between two steps is integrated this much more exactly than the steps are.
BETWEEN = 1e-3


def mirror_of(problem: DiscretizedOrbit, sample: Sample) -> OrbitMirror | None:
    """What takes one half of a branch to the other, by the orbit that it leaves and the deviation there.

    None where no declared symmetry, or product of some, does; for orbits that close up to a symmetry, turn,
    or are held along neutral directions it is not looked for.
    """
    if not problem.system.symmetries or problem.itinerary.image or np.any(problem.turns):
        return None
    if problem.pins or not problem.moves(sample.z):
        return None
    there = problem.adapted_to(sample.z, sample.weights)
    p = ParameterValues(**problem.values_of(sample.z))
    for product in products(problem.system, sample.z[: problem.states], p):
        for part in range(problem.parts):
            mirror = OrbitMirror(problem, product, part / problem.parts, sample)
            if mirror.keeps(there, sample) and mirror.carried(sample.z):
                return mirror
    return None


class OrbitMirror(MirrorOfOrbits[DiscretizedOrbit]):
    """The map from one half of a branch of whole orbits to the other.

    Parameters
    ----------
    problem, product, born
        See `MirrorOfOrbits`.
    share : float
        The part of the period by which the image begins later.
    """

    def __init__(self, problem: DiscretizedOrbit, product: Product, share: float, born: Sample) -> None:
        super().__init__(problem, product, born)
        self._share = share
        self._passed: tuple[DiscretizedOrbit, bytes, Passed] | None = None

    # -- the map -----------------------------------------------------------------------------------------

    def carried(self, z: np.ndarray) -> bool:
        """Whether the field is carried, a part of the period later, at a state off the orbit.

        z has the shape (N + 1,).
        """
        problem = self._problem
        p, values = (
            ParameterValues(**problem.values_of(z)),
            problem.given(z),
        )
        scale, at = problem.mesh.variation, 0.3
        x = problem.starts(z)[0] + 0.1 * scale * np.cos(np.arange(1.0, problem.states + 1.0))
        moved = self._linear @ velocity(problem.passages[0], x, at + self._share, values)
        there = velocity(problem.passages[0], self._product.state(x, p), at, values)
        return bool(np.linalg.norm((moved - there) / scale) <= 1e-8 * np.linalg.norm(moved / scale))

    def _image(
        self,
        there: DiscretizedOrbit,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        shift: float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Image of an orbit and of a deviation of it, each of shape (N + 1,), beginning later by a share."""
        n, m = there.states, there.mesh.segments
        parameters, by_parameter = self._parameters(there, z, weights)
        passed = self._passed_by(there, z, tangent)
        states, deviations = [], []
        for cut in there.mesh.cuts:
            x, v = passed.at(self._share + shift + cut)
            states.append(self._product.state(x, parameters))
            deviations.append(self._linear @ v + by_parameter(x) * tangent[-1])
        rest = m * n
        return np.concatenate([*states, z[rest:]]), np.concatenate([*deviations, tangent[rest:]])

    def _passed_by(self, there: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> Passed:
        key = z.tobytes() + tangent.tobytes()
        if self._passed is None or self._passed[0] is not there or self._passed[1] != key:
            self._passed = there, key, Passed(there, z, tangent)
        return self._passed[2]

    def _weights(self, there: DiscretizedOrbit, weights: np.ndarray) -> np.ndarray:
        n, m = there.states, there.mesh.segments
        return np.concatenate([np.tile(self._metric(weights[:n]), m), weights[m * n :]])

    def _mirrored(self, there: DiscretizedOrbit, image: np.ndarray) -> DiscretizedOrbit:
        """The problem on the same steps for an image, its section where the image begins."""
        mesh = there.mesh
        mesh = replace(mesh, variation=self._metric(mesh.variation), magnitudes=self._metric(mesh.magnitudes))
        values = there.given(image)
        return there.on(mesh, section_through(there, image[: there.states], values, mesh.magnitudes))

    def _in_section(
        self, there: DiscretizedOrbit, z: np.ndarray, own: DiscretizedOrbit, image: np.ndarray, last: np.void
    ) -> tuple[float, DiscretizedOrbit] | None:
        """How much later the image is in the section of the one before, and the problem with that section.

        None where no such instant is found. Of a forced system there is nothing to choose.
        """
        if there.forced:
            return 0.0, own
        known, n = vectors_of(last)[0], there.states
        values = there.given(image)
        cut = own.on(own.mesh, section_through(there, known[:n], values, own.mesh.magnitudes))
        assert cut.section is not None
        passed, p = Passed(there, z, np.zeros(len(z))), ParameterValues(**there.values_of(z))
        times, nodes = passed.nodes
        apart = (np.array([self._product.state(x, p) for x in nodes]) - known[:n]) / own.mesh.variation
        instant = first = float(times[int(np.argmin(np.linalg.norm(apart, axis=1)))])
        width = 2.0 * float(np.max(np.diff(times)))
        for _ in range(MOST_SHIFTS):
            x, _ = passed.at(instant)
            rate = self._linear @ velocity(there.passages[0], x, instant % 1.0, values)
            step = cut.section.residual(self._product.state(x, p)) / float(cut.section.normal @ rate)
            instant -= step
            if not abs(instant - first) <= width:
                return None
            if abs(step) < SAME_INSTANT:
                return instant - self._share, cut
        return None

    def _begun(
        self,
        there: DiscretizedOrbit,
        given: Given,
        image: tuple[DiscretizedOrbit, np.ndarray, np.ndarray],
        last: np.void,
    ) -> tuple[DiscretizedOrbit, np.ndarray, np.ndarray] | None:
        """The image that begins where a walk would have it, with its deviation and its problem."""
        found = self._in_section(there, given[0], *image[:2], last)
        if found is None or there.forced:
            return None if found is None else image
        shift, own = found
        z, moved = self._image(there, *given, shift)
        return own, z, own.into_section(z, moved)

    def _told(
        self, own: DiscretizedOrbit, image: np.ndarray, moved: np.ndarray, metric: np.ndarray, row: np.void
    ) -> tuple[Sample, dict[str, Any]]:
        passed = own.system.has_events and passed_over(
            own.system, *own.motion_of(image), own.values_of(image)
        )
        told = {
            "state": own.reported(image),
            "observables": [*measured_along(own, image), row["observables"][-1]],
            "admissible": not passed,
        }
        return replace(self._born, z=image, weights=metric, kinks=kinks_along(own, image)), told


class Passed:
    """An orbit with a deviation of it, at any instant: on the steps of its discretisation and between them.

    Parameters
    ----------
    problem : DiscretizedOrbit
    z, tangent : ndarray, shape (N + 1,)
    """

    def __init__(self, problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> None:
        self._problem, self._z, self._tangent = problem, z, tangent
        self._known: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    @property
    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and states of all steps, shapes (s,) and (s, n)."""
        return self._problem.mesh.times, self._problem.view(self._z)[0].nodes

    def at(self, instant: float) -> tuple[np.ndarray, np.ndarray]:
        """State and deviation at an instant in parts of the period, each of shape (n,)."""
        problem, instant = self._problem, instant % 1.0
        i = int(np.searchsorted(problem.mesh.cuts, instant + AT_STEP, side="right")) - 1
        steps = problem.mesh.steps[i]
        node = int(np.searchsorted(steps, instant + AT_STEP, side="right")) - 1
        states, deviations = self._segment(i)
        if abs(instant - steps[node]) <= AT_STEP:
            return states[node], deviations[node]
        return self._between(states[node], deviations[node], float(steps[node]), instant)

    def _segment(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """States and deviations at the steps of a segment, each of shape (s, n)."""
        if i not in self._known:
            problem, n = self._problem, self._problem.states
            driven = self._tangent[problem.layout.scalars]
            own = np.concatenate([self._tangent[i * n : (i + 1) * n], driven])
            if np.any(own):
                start, scalars = problem.starts(self._z)[i], problem.scalars(self._z)
                states, moved = problem.segments[i].along(start, scalars)
                self._known[i] = states, moved @ own
            else:
                last = int(problem.mesh.ends[i]) + 1
                states = self.nodes[1][last - len(problem.mesh.steps[i]) : last]
                self._known[i] = states, np.zeros_like(states)
        return self._known[i]

    def _between(
        self, x: np.ndarray, v: np.ndarray, begin: float, end: float
    ) -> tuple[np.ndarray, np.ndarray]:
        problem, mesh, n = self._problem, self._problem.mesh, self._problem.states
        values = problem.given(self._z)
        field, y, weights = problem.passages[0].field(PLAIN), x, mesh.variation
        if np.any(self._tangent):
            field, y = problem.passages[0].field(TANGENT), np.concatenate([x, v])
            values = np.concatenate([values, self._tangent[problem.layout.scalars]])
            size = max(float(np.linalg.norm(v / mesh.variation)), 1e-12)
            weights = np.concatenate([mesh.variation, size * mesh.variation])
        tolerance, c = max(BETWEEN * mesh.tolerance, FINEST), field.constants(values)
        path = arrived(flow.adaptive(field, c, begin, y, end, tolerance, weights, mesh.method))
        last = path.states[-1]
        return last[:n].copy(), last[n:].copy() if len(last) > n else np.zeros(n)
