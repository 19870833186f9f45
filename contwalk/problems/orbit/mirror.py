"""Orbits whose branch leaves a symmetric one: each half is the image of the other under a symmetry.

Where a branch of whole orbits leaves one that is its own image under a symmetry S, some part of the period
later, along a deviation that S reverses, the orbits on one side are y(t) = S x(t + share) of those on the
other. On steps that are alike in these parts, the image of a discretised orbit is one too, to rounding: it is
asked of the equations on the steps on which the orbit was solved for.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk import flow
from contwalk.branch import SpecialPoint
from contwalk.problems.images import Product, point_of_image, products, row_of_image
from contwalk.problems.orbit import monodromy, normal_forms
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.sampling import measured_along
from contwalk.problems.orbit.segmented_orbit import SegmentedOrbit, section_through
from contwalk.problems.orbit.shooting import arrived, velocity
from contwalk.problems.orbit.stored_discretizations import StoredDiscretizations, vectors_of
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues

# In the metric, an orbit that is kept comes back this exactly, and a deviation that is reversed: they are
# known to errors of the steps, times their growth.
KEPT, REVERSED = 1e-5, 1e-3
# Residuals this many times above their level are those of solutions, as of the corrector's. A located point
# was solved for on other steps than the finest ones, on which its image is looked at: it may miss them,
# and its image by so many times as much as deviations grow on the way.
SOLVED, AS_WELL = 20.0, 100.0
# Parts of the period within which two instants are one, on the way to a section and at the steps.
SAME_INSTANT, AT_STEP = 1e-13, 1e-14
MOST_SHIFTS = 12
# What lies between two steps is integrated this much more exactly than the steps are.
BETWEEN = 1e-3
# Change of the parameter, in its weight, that tells how a symmetry moves with it.
MOVED = 1e-4


def mirror_of(problem: SegmentedOrbit, sample: Sample) -> OrbitMirror | None:
    """What takes one half of a branch to the other, by the orbit that it leaves and the deviation there.

    None where no declared symmetry, or product of some, does; for orbits that close up to a symmetry, turn,
    or are held along neutral directions it is not looked for.
    """
    closure = problem.closure
    if not problem.system.symmetries or closure.symmetry is not None or np.any(closure.turns):
        return None
    if problem.pins or problem.uneven or not problem.moves(sample.z):
        return None
    there = problem.adapted_to(sample.z, sample.weights)
    p = ParameterValues(**problem.values_of(sample.z))
    for product in products(problem.system, sample.z[: problem.states], p):
        for part in range(problem.parts):
            mirror = OrbitMirror(problem, product, part / problem.parts, sample)
            if mirror.keeps(there, sample) and mirror.carried(sample.z):
                return mirror
    return None


class OrbitMirror:
    """The map from one half of a branch of whole orbits to the other.

    Parameters
    ----------
    problem : SegmentedOrbit
    product : Product
        The symmetries that make it, affine maps of the state.
    share : float
        The part of the period by which the image begins later.
    born : Sample
        The orbit that the branch leaves.
    """

    def __init__(self, problem: SegmentedOrbit, product: Product, share: float, born: Sample) -> None:
        self._problem, self._product, self._share, self._born = problem, product, share, born
        x, p = born.z[: problem.states], ParameterValues(**problem.values_of(born.z))
        sizes = np.maximum(np.abs(x), problem.mesh.variation)
        self._linear = product.linear(sizes, p)
        self._stored = StoredDiscretizations(problem)
        self._passed: tuple[SegmentedOrbit, bytes, Passed] | None = None
        self._samples: dict[bytes, Sample] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        return self._product.names

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself; empty, as it has not."""
        return ""

    # -- the map -----------------------------------------------------------------------------------------

    def keeps(self, there: SegmentedOrbit, sample: Sample) -> bool:
        """Whether an orbit is its own image, and its deviation is reversed."""
        z, tangent = self._image(there, sample.z, sample.tangent, sample.weights)
        if float(np.max(np.abs(z - sample.z) / sample.weights)) > KEPT:
            return False
        apart = there.into_section(sample.z, tangent) + there.into_section(sample.z, sample.tangent)
        return float(np.linalg.norm(apart / sample.weights)) < REVERSED

    def carried(self, z: np.ndarray) -> bool:
        """Whether the field is carried, a part of the period later, at a state off the orbit."""
        problem = self._problem
        p, values = (
            ParameterValues(**problem.values_of(z)),
            np.concatenate([problem.scalars(z), problem.line.constants]),
        )
        scale, at = problem.mesh.variation, 0.3
        x = problem.starts(z)[0] + 0.1 * scale * np.cos(np.arange(1.0, problem.states + 1.0))
        moved = self._linear @ velocity(problem.passage, x, at + self._share, values)
        there = velocity(problem.passage, self._product.state(x, p), at, values)
        return bool(np.linalg.norm((moved - there) / scale) <= 1e-8 * np.linalg.norm(moved / scale))

    def _image(
        self,
        there: SegmentedOrbit,
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
        for j in range(m):
            x, v = passed.at(self._share + shift + j / m)
            states.append(self._product.state(x, parameters))
            deviations.append(self._linear @ v + by_parameter(x) * tangent[-1])
        rest = m * n
        return np.concatenate([*states, z[rest:]]), np.concatenate([*deviations, tangent[rest:]])

    def _passed_by(self, there: SegmentedOrbit, z: np.ndarray, tangent: np.ndarray) -> Passed:
        key = z.tobytes() + tangent.tobytes()
        if self._passed is None or self._passed[0] is not there or self._passed[1] != key:
            self._passed = there, key, Passed(there, z, tangent)
        return self._passed[2]

    def _in_section(
        self, there: SegmentedOrbit, z: np.ndarray, image: np.ndarray, last: np.void
    ) -> tuple[float, SegmentedOrbit] | None:
        """How much later the image is in the section of the one before, and the problem with that section.

        None where no such instant is found. Of a forced system there is nothing to choose.
        """
        own = self._mirrored(there, image)
        if there.forced:
            return 0.0, own
        known, n = vectors_of(last)[0], there.states
        values = np.concatenate([there.scalars(image), there.line.constants])
        cut = own.on(own.mesh, section_through(there, known[:n], values, own.mesh.magnitudes))
        assert cut.section is not None
        passed, p = Passed(there, z, np.zeros(len(z))), ParameterValues(**there.values_of(z))
        times, nodes = passed.nodes
        apart = (np.array([self._product.state(x, p) for x in nodes]) - known[:n]) / own.mesh.variation
        instant = first = float(times[int(np.argmin(np.linalg.norm(apart, axis=1)))])
        width = 2.0 * float(np.max(np.diff(times)))
        for _ in range(MOST_SHIFTS):
            x, _ = passed.at(instant)
            rate = self._linear @ velocity(there.passage, x, instant % 1.0, values)
            step = cut.section.residual(self._product.state(x, p)) / float(cut.section.normal @ rate)
            instant -= step
            if not abs(instant - first) <= width:
                return None
            if abs(step) < SAME_INSTANT:
                return instant - self._share, cut
        return None

    def _parameters(
        self, there: SegmentedOrbit, z: np.ndarray, weights: np.ndarray
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

    def _weights(self, there: SegmentedOrbit, weights: np.ndarray) -> np.ndarray:
        n, m = there.states, there.mesh.segments
        return np.concatenate([np.tile(self._metric(weights[:n]), m), weights[m * n :]])

    def _mirrored(self, there: SegmentedOrbit, image: np.ndarray) -> SegmentedOrbit:
        """The problem on the same steps for an image, its section where the image begins."""
        mesh = there.mesh
        mesh = replace(mesh, variation=self._metric(mesh.variation), magnitudes=self._metric(mesh.magnitudes))
        values = np.concatenate([there.scalars(image), there.line.constants])
        return there.on(mesh, section_through(there, image[: there.states], values, mesh.magnitudes))

    # -- what is stored ----------------------------------------------------------------------------------

    def _begun(
        self, there: SegmentedOrbit, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray, last: np.void
    ) -> tuple[SegmentedOrbit, np.ndarray, np.ndarray] | None:
        """The image that begins where a walk would have it, with its deviation and its problem."""
        image, moved = self._image(there, z, tangent, weights)
        found = self._in_section(there, z, image, last)
        if found is None:
            return None
        shift, own = found
        if not there.forced:
            image, moved = self._image(there, z, tangent, weights, shift)
            moved = own.into_section(image, moved)
        return own, image, moved

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
            residual = own.linearize(image)
            excess = residual.excess_in(metric) if residual.finite else np.inf
            missed = there.linearize(z).excess_in(weights) if row["special"] else 0.0
            if excess <= SOLVED + AS_WELL * missed:
                break
        else:
            return None
        trivial = monodromy.trivial_error(own, image, residual.jacobian)
        begun = self._begun(there, z, tangent, weights, last)
        if begun is None:
            return None
        own, image, moved = begun
        acting = bool(own.system.acting)
        passed = acting and passed_over(own.system, *own.motion_of(image), own.values_of(image))
        found = row_of_image(
            row,
            image,
            -moved / np.linalg.norm(moved / metric),
            metric,
            state=own.reported(image),
            observables=[*measured_along(own, image), row["observables"][-1]],
            admissible=not passed,
            trivial_error=trivial,
            residual=excess,
            rhs=self._problem.evaluations - spent,
            seconds=time.perf_counter() - began,
        )
        kinks = kinks_along(own, image)
        self._samples[found["unknowns"].tobytes()] = replace(self._born, z=image, weights=metric, kinks=kinks)
        return found

    def sample(self, row: np.void) -> Sample:
        """Place, metric and kinks of an image, as a sample that tells no more."""
        z, weights, _ = vectors_of(row)
        return self._samples.get(
            row["unknowns"].tobytes(), replace(self._born, z=z, weights=weights, kinks=())
        )

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name: nothing."""
        return {}

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point: what is counted before it there is counted after it."""
        z, tangent = np.array(point.unknowns), np.array(point.tangent)
        weights = vectors_of(row)[1]
        there = self._stored.finest(z, weights)
        begun = self._begun(there, z, tangent, weights, last)
        assert begun is not None  # its row has been found
        own, image, moved = begun
        state = own.reported(image)
        return point_of_image(
            point,
            dict(zip(own.system.state_names, state.tolist(), strict=True)),
            image,
            -moved,
            coefficients=coefficients_of(own, point, image),
        )


class Passed:
    """An orbit with a deviation of it, at any instant: on the steps of its discretisation and between them.

    Parameters
    ----------
    problem : SegmentedOrbit
    z, tangent : ndarray, shape (N + 1,)
    """

    def __init__(self, problem: SegmentedOrbit, z: np.ndarray, tangent: np.ndarray) -> None:
        self._problem, self._z, self._tangent = problem, z, tangent
        self._known: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    @property
    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and states of all steps, shapes (s,) and (s, n)."""
        return self._problem.mesh.times, self._problem.solution(self._z).nodes

    def at(self, instant: float) -> tuple[np.ndarray, np.ndarray]:
        """State and deviation at an instant in parts of the period, each of shape (n,)."""
        problem, m = self._problem, self._problem.mesh.segments
        instant = instant % 1.0
        i = min(int((instant + AT_STEP) * m), m - 1)
        steps = problem.mesh.steps[i]
        node = int(np.searchsorted(steps, instant + AT_STEP, side="right")) - 1
        states, deviations = self._segment(i)
        if abs(instant - steps[node]) <= AT_STEP:
            return states[node], deviations[node]
        return self._between(states[node], deviations[node], float(steps[node]), instant)

    def _segment(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """States and deviations at the steps of a segment, each of shape (s, n)."""
        if i not in self._known:
            problem, n, m = self._problem, self._problem.states, self._problem.mesh.segments
            own = np.concatenate([self._tangent[i * n : (i + 1) * n], self._tangent[m * n :]])
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
        field, y, weights = problem.passage.field(PLAIN), x, mesh.variation
        if np.any(self._tangent):
            field, y = problem.passage.field(TANGENT), np.concatenate([x, v])
            values = np.concatenate([values, self._tangent[problem.mesh.segments * n :]])
            size = max(float(np.linalg.norm(v / mesh.variation)), 1e-12)
            weights = np.concatenate([mesh.variation, size * mesh.variation])
        tolerance, c = max(BETWEEN * mesh.tolerance, FINEST), field.constants(values)
        path = arrived(flow.adaptive(field, c, begin, y, end, tolerance, weights, mesh.method))
        last = path.states[-1]
        return last[:n].copy(), last[n:].copy() if len(last) > n else np.zeros(n)


def coefficients_of(own: OrbitData, point: SpecialPoint, image: np.ndarray) -> dict[str, Any]:
    """Coefficients of the normal form: odd ones have the sign of the critical vector at the image."""
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
