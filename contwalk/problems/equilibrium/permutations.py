"""Permutations of the states under which a field is unchanged: symmetries that nobody declared, by test."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# Entries are alike that differ by no more than this part of the largest one: the field is asked afterwards.
ALIKE = 1e-8
# So many places are asked, this part of the states away; no more permutations are found than the last one.
PLACES, AWAY, MOST = 3, 0.1, 120

Permutation = tuple[int, ...]


def permutations_at(problem: EquilibriumEquations, z: np.ndarray) -> list[Permutation]:
    """Those that keep an equilibrium z, shape (N + 1,), and take the field to itself; not the identity.

    State i of the image is state number p[i]. The field is asked at states beside z, at its parameters.
    """
    n = problem.states
    matrix = problem.jacobian(z)[:n, :n]
    found = [p for p in _automorphisms(matrix, z[:n]) if p != tuple(range(n))]
    return [p for p in found if _keeps(problem, z, p)]


def _automorphisms(matrix: np.ndarray, state: np.ndarray) -> Iterator[Permutation]:
    """Permutations with A[p, p] = A, shape (n, n), and x[p] = x, state by state."""
    n, near = len(matrix), ALIKE * float(np.abs(matrix).max(initial=0.0))
    alike = np.abs(state[:, None] - state) <= ALIKE * np.abs(state[:, None]) + ALIKE * EPSILON
    open_ = list[Permutation]([()])
    for _ in range(MOST * n):  # of one that is found n states are tried at least
        if not open_:
            return
        begun = open_.pop()
        i = len(begun)
        if i == n:
            yield begun
            continue
        own = [*begun, 0]
        for j in sorted(set(range(n)) - set(begun), reverse=True):
            own[i] = j
            row = np.abs(matrix[i, : i + 1] - matrix[j, own]).max()
            column = np.abs(matrix[: i + 1, i] - matrix[own, j]).max()
            if alike[i, j] and row <= near and column <= near:
                open_.append((*begun, j))


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


def as_cycles(p: Permutation, names: tuple[str, ...]) -> str:
    """As `a1 -> a2 -> a3 -> a1, m1 -> m2 -> m3 -> m1`: each state becomes the next one."""
    told, words = set[int](), list[str]()
    for i in range(len(p)):
        cycle = [i]
        while p[cycle[-1]] != i:
            cycle.append(p[cycle[-1]])
        if len(cycle) > 1 and i not in told:
            words.append(" -> ".join(names[k] for k in [*cycle, i]))
        told.update(cycle)
    return ", ".join(words)


def generating(found: Sequence[Permutation]) -> list[Permutation]:
    """Some of these permutations, of which all the others are products."""
    chosen, known = list[Permutation](), set[Permutation]()
    for p in sorted(found):
        if p in known:
            continue
        chosen.append(p)
        fresh = {tuple(range(len(p))), *known}
        while fresh:  # times each of the chosen ones, until nothing is new
            known |= fresh
            fresh = {tuple(q[i] for i in each) for q in fresh for each in chosen} - known
    return chosen
