"""Equilibria: f(x, p) = 0 in the states of a mode, with pinned directions held."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.numerics.linear import EPSILON
from contwalk.system import System
from contwalk.verification.equations import Equations, Evaluation, basis, pin_rows, without
from contwalk.verification.finding import CannotTell
from contwalk.verification.functions import Functions, Parameters


class EquilibriumEquations(Equations):
    """Those of one stored equilibrium.

    Parameters
    ----------
    system : System
    info : BranchInfo
    state, free : ndarray, shapes (n,) of all states, and (k,)
    """

    unit = False

    def __init__(self, system: System, info: BranchInfo, state: np.ndarray, free: np.ndarray) -> None:
        self.functions, self.info = Functions(system, Parameters(system, info)), info
        self.mode = str(info.settings.get("mode") or system.modes[0].name)
        own = state[list(system.states_of(self.mode))]
        self.z, self.size = np.concatenate([own, free]), len(own)
        self.sizes = np.maximum(np.abs(self.z), 1e-300)

    def at(self, z: np.ndarray, relative: float) -> Evaluation:
        """The equations at z, shape (N + k,)."""
        n, p = self.size, self.functions.parameters.at(z[self.size :])
        f, moved = self.functions.field(self.mode)(0.0, z[:n], p)
        held, rows, directions = pin_rows(self.functions, self.info, self.mode, self.z[:n], z[:n], p)
        matrix = moved[:, 1 : 1 + n]
        lefts, rights = _sides(matrix, directions)
        return Evaluation(
            z,
            np.concatenate([f, held]),
            np.vstack([moved[:, 1:], rows]),
            without(matrix, lefts, rights),
            relative,
        )

    def rounded(self, at: Evaluation) -> np.ndarray:
        """By how much rounding may change the residuals at a place, shape (m,).

        Terms that cancel are rounded more than their sum says: residuals at places some roundings beside, but
        for what the derivatives make of these, tell.
        """
        changes = []
        for number in range(1, 9):
            z = at.z * (1.0 + number * EPSILON * np.cos(number * np.arange(1.0, len(at.z) + 1.0)))
            changes.append(self.at(z, 0.0).residual - at.residual - at.jacobian @ (z - at.z))
        return np.asarray(np.max(np.abs(changes), axis=0))

    def across(self, z: np.ndarray) -> np.ndarray:
        """Orthonormal directions, shape (n, r), across what is pinned at z, shape (N + k,).

        Raises
        ------
        CannotTell
            If the pinned directions are others beside the place: then no plane is across all of them.
        """
        n, p = self.size, self.functions.parameters.at(z[self.size :])
        system, pins = self.functions.system, self.info.settings.get("pins", ())
        _, moved = self.functions.field(self.mode)(0.0, z[:n], p)
        for pin in system.neutral:
            if (
                pin.name in pins
                and self.functions.generator(pin, self.mode)(0.0, z[:n], p)[1][:, 1 : 1 + n].any()
            ):
                raise CannotTell("Directions that are held are bent: no plane is across them.")
        _, _, directions = pin_rows(self.functions, self.info, self.mode, self.z[:n], z[:n], p)
        lefts, rights = _sides(moved[:, 1 : 1 + n], directions)
        return basis(np.array(lefts).reshape(-1, n), rights)

    def fixed(self, z: np.ndarray, across: np.ndarray) -> np.ndarray:
        """Directions across what is pinned, (n, r), so far along it that what fixes it stays fixed.

        z has the shape (N + k,).
        """
        n, p = self.size, self.functions.parameters.at(z[self.size :])
        _, rows, directions = pin_rows(self.functions, self.info, self.mode, self.z[:n], z[:n], p)
        if not len(rows):
            return across
        along = np.array(directions).T
        return np.asarray(across - along @ np.linalg.solve(rows[:, :n] @ along, rows[:, :n] @ across))


def _sides(matrix: np.ndarray, directions: Sequence[np.ndarray]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Of pinned directions, (n,), those that are left vectors of a matrix, (n, n), and the others."""
    lefts = [v for v in directions if np.linalg.norm(v @ matrix) < np.linalg.norm(matrix @ v)]
    return lefts, [v for v in directions if not any(v is left for left in lefts)]
