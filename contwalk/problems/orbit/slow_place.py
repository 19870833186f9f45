"""Where an orbit is slow, and the equilibria that it may pass there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.passage import Passage

# Samples of an orbit among which its slowest place is looked for, beside the integrator's own steps.
AROUND = 256
# Newton's method for an equilibrium.
ITERATIONS, CONVERGED = 20, 1e-9
# What is left of the least speed where a state stands still.
STANDING = 1e-3


@dataclass(frozen=True)
class SlowPlace:
    """A place where an orbit is slower than beside it, and the field around.

    Parameters
    ----------
    names : tuple of str
        Of the states that exist there.
    speed, fastest : float
        Speed there and where the orbit is fastest, in ranges of the states per second.
    state, scale : ndarray, shape (k,)
        The state there, and half the range of each.
    path : ndarray, shape (p, k)
        The states around it on the orbit.
    velocity, jacobian : callable
        The field in seconds, shape (k,), and its derivative, shape (k, k).
    family : callable
        The field at a state and a value of the free parameter, shape (k,), and its derivatives by both, shape
        (k, k + 1).
    """

    names: tuple[str, ...]
    speed: float
    fastest: float
    state: np.ndarray
    scale: np.ndarray
    path: np.ndarray
    velocity: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray]
    family: Callable[[np.ndarray, float], tuple[np.ndarray, np.ndarray]]

    @property
    def slowness(self) -> float:
        """Speed there against the largest."""
        return self.speed / max(self.fastest, 1e-300)

    def described(self, rest: np.ndarray) -> str:
        """The states of an equilibrium, shape (k,), in words; rounding beside the orbit's range is zero."""
        told = np.where(np.abs(rest) < CONVERGED * self.scale, 0.0, rest)
        return ", ".join(f"{name} = {x:.5g}" for name, x in zip(self.names, told, strict=True))

    def equilibrium(self, near: np.ndarray | None = None) -> np.ndarray | None:
        """The equilibrium nearby, or near another state, by Newton's method; None where there is none.

        All have the shape (k,).
        """
        start = self.state if near is None else near
        x = self._standing(lambda x: (self.velocity(x), self.jacobian(x)), start, self.scale)
        return x if x is not None and self.distance(x) < 1.0 else None

    def meeting(self, value: float, size: float) -> float | None:
        """The value of the free parameter, near one, at which two equilibria meet where the orbit is slowest;
        None where there is none.

        The nearest point of the curve of equilibria in state and parameter (Gauss-Newton, the parameter in
        units of `size`): just beside a saddle-node no move of the state brings the field nearer to zero, so
        the parameter makes it, up to the square of how far it is.
        """
        start, units = np.append(self.state, value), np.append(self.scale, size)
        x = self._standing(lambda x: self.family(x[:-1], float(x[-1])), start, units)
        if x is None or not self.distance(x[:-1]) < 1.0:
            return None
        left = float(np.linalg.norm(self.family(x[:-1], float(x[-1]))[0] / self.scale))
        return float(x[-1]) if left <= STANDING * self.speed else None

    def _standing(
        self,
        field: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
        start: np.ndarray,
        units: np.ndarray,
    ) -> np.ndarray | None:
        """Where a field, which comes with its derivatives, is zero near a start; None where steps grow.

        The start and its units have the shape (u,), of states or of states and parameter.
        """
        x = start.copy()
        for _ in range(ITERATIONS):
            f, j = field(x)
            if not (np.all(np.isfinite(f)) and np.all(np.isfinite(j))):
                return None
            scaled = j * units / self.scale[:, None]
            # What no motion changes stays as it is: of equilibria in a row, the one that the orbit comes to.
            left, sizes, _ = np.linalg.svd(scaled)
            kept = left[:, sizes <= len(x) * EPSILON * sizes[0]].T @ np.eye(len(f), len(x))
            rates = np.append(f / self.scale, np.zeros(len(kept)))
            step = np.linalg.lstsq(np.vstack([scaled, kept]), rates, rcond=1e-12)[0]
            x = x - step * units
            length = float(np.linalg.norm(step))
            if length < CONVERGED:
                return x
            if length > 2.0:
                return None
        return None

    def distance(self, x: np.ndarray) -> float:
        """Of a state from the orbit, in units of its range. x has the shape (k,)."""
        return float(np.linalg.norm((self.path - x) / self.scale, axis=1).min())


def slow_places_on(
    passage: Passage,
    values: np.ndarray,
    duration: float,
    times: np.ndarray,
    path: np.ndarray,
    scale: np.ndarray,
    names: tuple[str, ...],
) -> list[SlowPlace]:
    """The places on a path where its speed is least, the slowest first.

    The passage's field is in units of a duration, at times in 0..1; `values` are what it depends on, its
    scalars first.

    `scale` has the shape (k,), times (s,), the path (s, k).
    """
    n, field = len(scale), passage.field(PLAIN)
    c = field.constants(values)
    speeds = np.linalg.norm(field.along(times, path, c) / scale, axis=1) / duration
    around = np.concatenate([[np.inf], speeds, [np.inf]])
    least = np.flatnonzero((speeds <= around[:-2]) & (speeds < around[2:]))

    def family(x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        # The free parameter is the last of the scalars.
        free = np.eye(len(passage.columns))[-1]
        there = np.where(np.append(free, np.zeros(len(values) - len(free))), value, values)
        tangent = passage.field(TANGENT)
        moved = tangent(0.0, np.append(x, np.zeros(n)), tangent.constants(np.append(there, free)))
        by_state = field.jacobian(0.0, x, field.constants(there))[:, :n]
        return moved[:n] / duration, np.column_stack([by_state, moved[n:]]) / duration

    return [
        SlowPlace(
            names,
            float(speeds[k]),
            float(speeds.max()),
            path[k],
            scale,
            path,
            lambda x: field(0.0, x, c) / duration,
            lambda x: field.jacobian(0.0, x, c)[:, :n] / duration,
            family,
        )
        for k in least[np.argsort(speeds[least], kind="stable")]
    ]
