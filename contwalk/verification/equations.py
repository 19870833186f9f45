"""What a record says in equations: F(z) = 0 of its solution, with derivatives and spectrum.

z holds the unknowns and, last, the free parameters. There may be more equations than unknowns, as where a
direction is pinned: a solution satisfies all of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.numerics.linear import EPSILON
from contwalk.verification.finding import CannotTell
from contwalk.verification.functions import Functions


@dataclass(frozen=True)
class Evaluation:
    """The equations at a place.

    Parameters
    ----------
    z : ndarray, shape (N + k,)
    residual, jacobian : ndarray, shapes (m,) and (m, N + k)
    matrix : ndarray, shape (r, r)
        Its eigenvalues are the spectrum, without the trivial and the neutral ones.
    relative : float
        The tolerance of the motions.
    trivial : float
        How far the trivial multiplier is from one, |M f - f| / |f|; zero of equilibria.
    legs : sequence
        What was passed on the way, of orbits.
    """

    z: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    matrix: np.ndarray
    relative: float
    trivial: float = 0.0
    legs: Sequence[Any] = field(default_factory=tuple)

    @property
    def spectrum(self) -> np.ndarray:
        """Eigenvalues of the matrix, shape (r,)."""
        if not np.isfinite(self.matrix).all():
            raise CannotTell("The motion only touches an event there: multipliers do not exist.")
        return np.linalg.eigvals(self.matrix)


class Equations(ABC):
    """Those of one record.

    Attributes
    ----------
    z : ndarray, shape (N + k,)
        The record's own place.
    size : int
        N.
    unit : bool
        Whether the spectrum is one of multipliers.
    sizes : ndarray, shape (N + k,)
        Magnitudes of what stands in z.
    """

    functions: Functions
    z: np.ndarray
    size: int
    unit: bool
    sizes: np.ndarray

    @abstractmethod
    def at(self, z: np.ndarray, relative: float) -> Evaluation:
        """The equations at z, shape (N + k,), by a motion of a relative tolerance."""

    def rounded(self, at: Evaluation) -> np.ndarray:
        """By how much rounding may change the residuals at a place, shape (m,)."""
        return np.asarray(EPSILON * (np.abs(at.jacobian) @ np.abs(at.z)))

    @property
    def rank(self) -> int:
        """How many of the equations are independent near the place."""
        return self.size

    @property
    def free(self) -> np.ndarray:
        """The record's free parameters, shape (k,)."""
        return self.z[self.size :]


def along_pins(
    functions: Functions, info: BranchInfo, mode: str, x: np.ndarray, p: np.ndarray
) -> list[tuple[np.ndarray, bool]]:
    """Held directions at a state of a mode, shape (n,) each, and whether they are others beside it."""
    system, n, found = functions.system, len(x), []
    declared, undeclared = (
        {pin.name: pin for pin in system.neutral},
        iter(info.settings.get("undeclared", ())),
    )
    for name in info.settings.get("pins", ()):
        if name in declared:
            direction, moved = functions.generator(declared[name], mode)(0.0, x, p)
            found.append((direction, bool(moved[:, 1 : 1 + n].any())))
        elif name in system.conserved_names:
            found.append((np.zeros(n), True))  # of which there is no drift
        else:
            found.append((np.array(next(undeclared), dtype=float)[list(system.states_of(mode))], False))
    return found


def pin_rows(
    functions: Functions, info: BranchInfo, mode: str, first: np.ndarray, x: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """What holds pinned directions: residuals (j,), derivatives by states and free parameters (j, n + k), and
    the directions (n,).

    Parameters
    ----------
    first, x : ndarray, shape (n,)
        The record's state in the mode, which is held, and the one that is looked at.
    """
    system, n, k = functions.system, len(x), functions.parameters.slopes.shape[1]
    declared = {pin.name: pin for pin in system.neutral}
    undeclared = iter(info.settings.get("undeclared", ()))
    residuals, rows, directions = [], [], []
    for name in info.settings.get("pins", ()):
        row, states = np.zeros(n + k), list(system.states_of(mode))
        if name in system.conserved_names:
            continue
        if name in declared:
            pin, along = declared[name], functions.generator(declared[name], mode)
            held = along(0.0, first, p)[0]
            directions.append(along(0.0, x, p)[0])  # it may bend
            if pin.pin is not None and pin.value is not None:
                at, value = (
                    states.index(system.state_names.index(pin.pin)),
                    system.parameter_names.index(pin.value),
                )
                row[at], row[n:] = 1.0, -functions.parameters.slopes[value]
                residuals.append(x[at] - p[value])
                rows.append(row)
                continue
        else:
            held = np.array(next(undeclared), dtype=float)[states]
            directions.append(held)
        row[:n] = held
        residuals.append(held @ (x - first))
        rows.append(row)
    return np.array(residuals), np.array(rows).reshape(-1, n + k), directions


def without(matrix: np.ndarray, lefts: Sequence[np.ndarray], rights: Sequence[np.ndarray]) -> np.ndarray:
    """A matrix, (n, n), on what known left vectors let free, but for known right vectors: shape (r, r)."""
    kept = basis(np.array(lefts).reshape(-1, len(matrix)), rights)
    return np.asarray(kept.T @ matrix @ kept)


def basis(lefts: np.ndarray, rights: Sequence[np.ndarray]) -> np.ndarray:
    """Orthonormal directions, shape (n, r), that left vectors, (j, n), let free, but for right vectors."""
    kept = _beside(lefts)
    own = np.array([kept.T @ right for right in rights]).reshape(-1, kept.shape[1])
    return np.asarray(kept @ _beside(own))


def _beside(rows: np.ndarray) -> np.ndarray:
    """An orthonormal basis of what is at a right angle to some rows, (j, n), as columns."""
    if not len(rows):
        return np.eye(rows.shape[1])
    _, values, basis = np.linalg.svd(rows)
    rank = int(np.sum(values > 1e-9 * max(values[0], 1e-300)))
    return np.asarray(basis[rank:].T)
