"""Counts of unstable directions where doubles do not tell them: solutions and eigenvalues in 100 digits."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
from random_independent import Machine

DIGITS = 100
# Differences by this part of a state are off by as much again. One that is below the least is moved as that.
ASIDE, LEAST = mpmath.mpf(10) ** -30, mpmath.mpf(10) ** -25
# An eigenvalue this small against the largest one is what a conserved sum leaves of zero.
NOTHING = mpmath.mpf(10) ** -25
# Nearer to critical than this, against its own size, the stored row's own rounding may decide.
DOUBTFUL = mpmath.mpf(10) ** -9
# How many rows of a branch are looked at.
ROWS = 12


def _field(machine: Machine, x: list[Any], p: SimpleNamespace) -> list[Any]:
    dx = [mpmath.mpf(0)] * len(x)
    machine.exact["flow"](mpmath.mpf(0), x, p, dx)
    return dx


def _jacobian(machine: Machine, x: list[Any], p: SimpleNamespace) -> mpmath.matrix:
    n, here = len(x), _field(machine, x, p)
    found = mpmath.matrix(n, n)
    for j in range(n):
        step = ASIDE * max(abs(x[j]), LEAST)
        there = _field(machine, [*x[:j], x[j] + step, *x[j + 1 :]], p)
        for i in range(n):
            found[i, j] = (there[i] - here[i]) / step
    return found


def _eigenvalues(matrix: mpmath.matrix) -> list[Any]:
    """Eigenvalues; QR steps that do not converge on equal ones are done on the matrix in a drawn frame."""
    n = matrix.rows
    for seed in range(5):
        frame = np.eye(n) + (np.random.default_rng(seed).uniform(-0.4, 0.4, (n, n)) / n if seed else 0.0)
        frame = mpmath.matrix(frame.tolist())
        with contextlib.suppress(RuntimeError, ZeroDivisionError):
            return list(mpmath.eig(mpmath.inverse(frame) * matrix * frame, left=False, right=False))
    raise RuntimeError("QR steps do not converge")


def counted(
    machine: Machine, state: np.ndarray, parameters: Mapping[str, float], summed: bool
) -> tuple[int, int]:
    """Fewest and most unstable directions of the equilibrium at a state; `summed`: its sum is conserved."""
    with mpmath.workdps(DIGITS):
        p = SimpleNamespace(**{k: mpmath.mpf(float(v)) for k, v in parameters.items()})
        x = [mpmath.mpf(float(v)) for v in state]
        for _ in range(4):
            matrix, left = _jacobian(machine, x, p), mpmath.matrix(_field(machine, x, p))
            if summed:  # the equations are one fewer than they look: the sum stays as it is
                matrix[len(x) - 1, :] = mpmath.ones(1, len(x))
                left[len(x) - 1] = 0
            with contextlib.suppress(ZeroDivisionError):  # right where several waves are born
                x = [v - moved for v, moved in zip(x, mpmath.lu_solve(matrix, left), strict=True)]
        values = _eigenvalues(_jacobian(machine, x, p))
        largest = max(abs(v) for v in values)
        own = [v for v in values if not (summed and abs(v) <= NOTHING * largest)]
        sure = sum(mpmath.re(v) > DOUBTFUL * abs(v) for v in own)
        return int(sure), int(sum(mpmath.re(v) >= -DOUBTFUL * abs(v) for v in own))


def miscounted(machine: Machine, rows: np.ndarray, each: list[dict[str, float]]) -> Iterator[str]:
    """A sentence on each of some rows of equilibria whose stored count is another one."""
    summed = machine.recipe.family == "graded"
    regular = np.flatnonzero(~rows["special"])
    for i in regular[np.unique(np.linspace(0, len(regular) - 1, ROWS).astype(int))] if len(regular) else ():
        least, most = counted(machine, rows["state"][i], each[i], summed)
        doubt = int(rows["undecided"][i])  # how many are told not to be known
        if not least - doubt <= rows["unstable"][i] <= most + doubt:
            yield f"{rows['unstable'][i]} stored, {least} to {most} in {DIGITS} digits, row {i}"
