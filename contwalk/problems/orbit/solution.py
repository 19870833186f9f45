"""What is integrated of one motion on the steps of a discretisation, each part once.

Whoever looks along an orbit (magnitudes, observables, extremes, the slowest place, the phase) looks at the
same states. A linearization has passed through those at the steps already, bitwise.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.data_class import dataclass
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.passage import Passage
from contwalk.problems.orbit.shooting import Mesh


class Solution:
    """A motion over one closure; a solution of the equations, or nearly one.

    Parameters
    ----------
    passage : Passage
    mesh : Mesh
    values : ndarray
        Scalars and fixed parameters.
    starts : ndarray, shape (m, n)
        States at the starts of the segments.
    """

    def __init__(self, passage: Passage, mesh: Mesh, values: np.ndarray, starts: np.ndarray) -> None:
        self._field, self._mesh, self._starts = passage.field(PLAIN), mesh, starts
        self._c = self._field.constants(values)

    @cached_property
    def nodes(self) -> np.ndarray:
        """States at the steps of all segments, `Mesh.times`, shape (s, n)."""
        field, c, mesh = self._field, self._c, self._mesh
        runs = zip(mesh.steps, self._starts, strict=True)
        return np.concatenate([flow.along(field, c, steps, x, mesh.method) for steps, x in runs])

    @cached_property
    def curve(self) -> Curve:
        """The motion, to be looked at anywhere."""
        field, c, mesh = self._field, self._c, self._mesh
        at = flow.interpolation(field, c, mesh.times, self.nodes, mesh.method)
        return Curve(mesh.times, self.nodes, at, lambda t, x: field.along(t, x, c))

    @cached_property
    def velocities(self) -> np.ndarray:
        """`velocities_at` the segments' own starts. Shape (m, n)."""
        return self.velocities_at(self._starts)

    def velocities_at(self, states: np.ndarray) -> np.ndarray:
        """dx/dt where segments start, in units of the closure's duration, shape (m, n); NaN in a row of
        which one entry does not exist.
        """
        found = self._field.along(self._mesh.cuts, states, self._c)
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found


@dataclass(frozen=True, eq=False)
class Curve:
    """An integrated motion over a closure, in times 0..1.

    Parameters
    ----------
    times : ndarray, shape (s,)
        As `Mesh.times`.
    nodes : ndarray, shape (s, n)
        The states there.
    at : callable
        States (k, n) at times (k,) in growing order, exact as the integrator's own interpolation is. Where
        two segments meet, that of the later one.
    rates : callable
        Rates at times (k,) and states (k, n) there.
    """

    times: np.ndarray
    nodes: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]
    rates: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def sampled(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, shape (k, n), at least `number` of them evenly spread, and the steps' own."""
        even = np.linspace(0.0, 1.0, number + 1)
        return self._with(even[even != self.times[np.searchsorted(self.times, even)]])

    def divided(self, parts: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, shape (k, n): the steps' own, and instants that part each step evenly."""
        lengths = np.diff(self.times)
        inner = self.times[:-1, None] + lengths[:, None] * (np.arange(1, parts) / parts)
        return self._with(inner[lengths > 0.0].ravel())

    def _with(self, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The steps' own times and states, and those at further times, in growing order."""
        times, nodes = np.concatenate([self.times, inner]), np.concatenate([self.nodes, self.at(inner)])
        order = np.argsort(times, kind="stable")
        return times[order], nodes[order]
