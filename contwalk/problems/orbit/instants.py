"""An orbit and a deviation of it at any instant: on the steps of its discretisation, and between them."""

from __future__ import annotations

import numpy as np

from contwalk import flow
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.shooting import arrived

# Parts of the period within which an instant is that of a step.
AT_STEP = 1e-14
# What lies between two steps is integrated this much more exactly than the steps are.
BETWEEN = 1e-3


class Instants:
    """An orbit of one leg with a deviation of it, at any instant.

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
