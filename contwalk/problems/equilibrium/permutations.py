"""Permutations of the states under which a field is unchanged: symmetries that nobody declared, by test."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.permutations import Permutation, automorphisms
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# So many places are asked, this part of the states away.
PLACES, AWAY = 3, 0.1


def permutations_at(problem: EquilibriumEquations, z: np.ndarray) -> list[Permutation]:
    """Those that keep an equilibrium z, shape (N + 1,), and take the field to itself; not the identity.

    State i of the image is state number p[i]. The field is asked at states beside z, at its parameters.
    """
    n = problem.states
    matrix = problem.jacobian(z)[:n, :n]
    return [p for p in automorphisms(matrix, z[:n]) if _keeps(problem, z, p)]


def _keeps(problem: EquilibriumEquations, z: np.ndarray, p: Permutation) -> bool:
    """Whether the field of permuted states is the permuted field, to rounding."""
    n, order = problem.states, list(p)
    for k in range(1, PLACES + 1):
        moved = z.copy()
        moved[:n] += AWAY * np.cos(np.arange(1.0, n + 1.0) * k) * (np.abs(z[:n]) + (z[:n] == 0.0))
        turned = moved.copy()
        turned[:n] = moved[order]
        try:
            here, there = problem.linearize(moved), problem.linearize(turned)
            apart = np.abs(there.residual[:n] - here.residual[order])
        except (NotFinite, PluginError):
            return False
        if not np.all(apart <= here.levels[0][order] + there.levels[0][:n]):
            return False
    return True
