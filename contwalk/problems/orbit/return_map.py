"""The map of a section once round a smooth orbit, with its derivatives: the jet lift, segment by segment."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.numerics.spectrum import complement
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.lifts import JET, PLAIN, TANGENT
from contwalk.problems.orbit.normal_forms import SectionMap, units
from contwalk.problems.orbit.segmented_orbit import SegmentedOrbit
from contwalk.system.declarations import ParameterValues

# Samples of the critical deviation over a closure: evenly spaced, so that the mean converges fast.
SAMPLES = 256


class ReturnMap(SectionMap):
    """The map of the section (of the whole state space, for a forced system) once round a closed orbit.

    Vectors are coordinates xi of shape (r,): x = x_0 + basis xi.
    """

    def __init__(self, problem: SegmentedOrbit, z: np.ndarray) -> None:
        self.problem, self.z = problem, z
        n = problem.states
        magnitudes = problem.mesh.variation
        rows = []
        if not problem.forced:
            rows.append(problem.velocity(z) / magnitudes**2)
        for pin in problem.pins:
            assert problem.reference is not None
            row = np.zeros(n)
            if pin.pin is None:
                row[:] = neutrals.generator_at(pin, problem.reference, problem.parameters)
            else:
                row[problem.system.state_names.index(pin.pin)] = 1.0
            rows.append(row)
        self.conditions = np.array(rows).reshape(len(rows), n)
        scaled = self.conditions * magnitudes
        self.basis = complement(scaled.T) * magnitudes[:, None] if len(rows) else np.diag(magnitudes)
        self.coordinates = (self.basis / magnitudes[:, None]).T / magnitudes

    @cached_property
    def _by_scalars(self) -> np.ndarray:
        """Derivative of the end by period, drifts and free parameter, shape (n, k)."""
        problem, m, n = self.problem, self.problem.mesh.segments, self.problem.states
        jacobian = problem.linearize(self.z).jacobian
        factors = problem.factors(jacobian)
        total = np.zeros((n, len(problem.passage.columns)))
        for i in range(m):
            total = factors[i] @ total + jacobian[i * n : (i + 1) * n, m * n :]
        return total

    def _held(self, end: np.ndarray) -> np.ndarray:
        """Change of period and drifts that brings an end back into section and pins."""
        if not len(self.conditions):
            return np.zeros(0)
        own = self.conditions @ self._by_scalars[:, :-1]
        return -np.linalg.solve(own, self.conditions @ end)

    def curve(
        self, x1: np.ndarray, x2: np.ndarray | None = None, lam: float = 0.0, order: int = 3
    ) -> list[np.ndarray]:
        """First derivatives, up to `order`, of the image of the curve x_0 + s x1 + s^2 x2 / 2, lambda +
        s lam.
        """
        problem, n = self.problem, self.problem.states
        k = len(problem.passage.columns)
        directions = [np.zeros(k) for _ in range(3)]
        directions[0][-1] = lam
        start = [self.basis @ x1, np.zeros(n) if x2 is None else self.basis @ x2, np.zeros(n)]
        ends: list[np.ndarray] = []
        for j in range(order):
            end = self._jet(start, directions)[j]
            held = self._held(end)
            directions[j][: k - 1] = held
            ends.append(self.coordinates @ (end + self._by_scalars[:, : k - 1] @ held))
        return ends

    def _jet(self, start: list[np.ndarray], directions: list[np.ndarray]) -> list[np.ndarray]:
        """Derivatives 1, 2, 3 of the end along a curve of starts and scalars."""
        problem, n = self.problem, self.problem.states
        starts, scalars, pieces = problem.starts(self.z), problem.scalars(self.z), problem.segments
        jets = np.concatenate(start)
        for i in range(problem.mesh.segments):
            y = np.concatenate([starts[i], jets])
            jets = pieces[i].end(JET, y, scalars, *directions)[n:]
        return [jets[:n], jets[n : 2 * n], jets[2 * n :]]

    @cached_property
    def a(self) -> np.ndarray:
        """A, shape (r, r)."""
        problem = self.problem
        whole = np.eye(problem.states)
        for factor in problem.factors(problem.linearize(self.z).jacobian):
            whole = factor @ whole
        moved = whole @ self.basis
        for j in range(moved.shape[1]):
            moved[:, j] += self._by_scalars[:, :-1] @ self._held(moved[:, j])
        return self.coordinates @ moved

    @cached_property
    def by_parameter(self) -> np.ndarray:
        """Derivative of the map by the free parameter, shape (r,)."""
        end = self._by_scalars[:, -1]
        return self.coordinates @ (end + self._by_scalars[:, :-1] @ self._held(end))

    def size(self, q: np.ndarray) -> float:
        """Root mean square over the closure of the deviation that starts as q, across the flow."""
        parts = [q.real, q.imag] if np.iscomplexobj(q) else [q]
        return float(np.sqrt(sum(self._mean_square(self.basis @ part) for part in parts)))

    def _mean_square(self, v: np.ndarray) -> float:
        problem, n = self.problem, self.problem.states
        field, values = problem.passage.field(TANGENT), problem.given(self.z)
        c = field.constants(np.concatenate([values, np.zeros(len(problem.passage.columns))]))
        even = np.arange(SAMPLES) / SAMPLES
        sampled = []
        for steps, x in zip(problem.mesh.steps, problem.starts(self.z), strict=True):
            nodes = flow.along(field, c, steps, np.concatenate([x, v]), problem.mesh.method)
            inside = even[(even >= steps[0]) & (even < steps[-1])]
            sampled.append(flow.dense(field, c, steps, nodes, inside, problem.mesh.method))
            v = nodes[-1, n:]
        states = np.concatenate(sampled)
        # Half of a symmetric orbit covers more or less of it, depending on where it begins.
        parameters = ParameterValues(**problem.values_of(self.z))
        whole = np.concatenate(problem.closure.images(states[:, :n], parameters))
        scale = units(problem.system, whole, problem.mesh.magnitudes)
        deviations = states[:, n:] / scale
        if not problem.forced:
            plain = problem.passage.field(PLAIN)
            own = plain.constants(values)
            along = np.array([plain(t, x, own) for t, x in zip(even, states[:, :n], strict=True)]) / scale
            along /= np.linalg.norm(along, axis=1, keepdims=True)
            deviations -= np.sum(deviations * along, axis=1, keepdims=True) * along
        return float(np.mean(np.sum(deviations**2, axis=1)))
