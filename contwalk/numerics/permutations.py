"""Permutations: those that keep a matrix and a vector, their products, and their words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from contwalk.numerics.linear import EPSILON

# Entries are alike that differ by no more than this part of the largest one.
ALIKE = 1e-8
# No more permutations are found.
MOST = 120

Permutation = tuple[int, ...]


def automorphisms(matrix: np.ndarray, state: np.ndarray) -> Iterator[Permutation]:
    """Permutations with A[p, p] = A, shape (n, n), and x[p] = x, (n,), state by state; not the identity."""
    n, near = len(matrix), ALIKE * float(np.abs(matrix).max(initial=0.0))
    alike = np.abs(state[:, None] - state) <= ALIKE * np.abs(state[:, None]) + ALIKE * EPSILON
    open_ = list[Permutation]([()])
    for _ in range(MOST * n):  # of one that is found n states are tried at least
        if not open_:
            return
        begun = open_.pop()
        i = len(begun)
        if i == n:
            if begun != tuple(range(n)):
                yield begun
            continue
        own = [*begun, 0]
        for j in sorted(set(range(n)) - set(begun), reverse=True):
            own[i] = j
            row = np.abs(matrix[i, : i + 1] - matrix[j, own]).max()
            column = np.abs(matrix[: i + 1, i] - matrix[own, j]).max()
            if alike[i, j] and row <= near and column <= near:
                open_.append((*begun, j))


def as_cycles(p: Permutation, names: tuple[str, ...]) -> str:
    """As `a1 -> a2 -> a3 -> a1, m1 -> m2 -> m3 -> m1`: each state becomes the next one."""
    seen, words = set[int](), list[str]()
    for i in range(len(p)):
        cycle = [i]
        while p[cycle[-1]] != i:
            cycle.append(p[cycle[-1]])
        if len(cycle) > 1 and i not in seen:
            words.append(" -> ".join(names[k] for k in [*cycle, i]))
        seen.update(cycle)
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
