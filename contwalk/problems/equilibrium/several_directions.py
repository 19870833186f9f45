"""Leaving a point at which several real eigenvalues vanish together, along all solutions of its equations.

N and P are the right and left null spaces of F_u, t0 = (h, 1) the tangent of the branch that leads there.
Others leave along N a + t0 with Q(a, a) + 2 M a = 0; where Q is zero, along N a with C(a, a, a)/6 = -l M a,
while the parameter moves by l |a|^2. M = P.D2F(N, t0), Q = P.D2F(N, N), C = P.(D3F + 3 D2F(N, g)), where g
solves F_u g = -D2F(N, N) (M. Golubitsky & D. G. Schaeffer, 1985). Solutions are looked for from many starts;
those that are not alone to the errors of the coefficients, as of a continuous symmetry, are none: they are
members of a family.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations_with_replacement, permutations

import numpy as np

from contwalk.numerics.linear import EPSILON, Factored, balanced
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import ROUNDINGS, SURE, Forms

# More eigenvalues than these have too many solutions to be looked for.
MOST = 4
# Starts of Newton's method on the sphere of k null vectors, 2^k times, and their sizes where these count.
STARTS, SIZES = 32, (0.5, 1.0, 2.0)
ITERATIONS, CONVERGED = 40, 1e-13
# An entry of F_u is zero if so many errors of the parameter, or such a part of it, make as much of it.
KNOWN, EXACT = 100.0, 1e-14
# What is zero of singular values, of coefficients, and of differences of directions, against the others.
NULL, NOTHING, SAME = 1e-9, 1e-9, 1e-6
# A solution is one of a family where its equations are as singular as this.
ALONE = 1e-6
TINY = 1e-300

Equations = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
Branches = tuple[Equations, Iterator[np.ndarray], Callable[[np.ndarray, np.ndarray], bool]]


@dataclass(frozen=True, eq=False)
class Leaving:
    """How a branch leaves.

    Parameters
    ----------
    tangent : ndarray, shape (N + 1,)
    reach : callable
        How far each unknown moves while the parameter changes by so much, shape (N + 1,).
    """

    tangent: np.ndarray
    reach: Callable[[float], np.ndarray]


@dataclass(frozen=True, eq=False)
class Directions:
    """What leaves a point: branches that are alone, and the dimension of families whose members are not.

    `standing`: the parameter stands still along the family, as far as the branching equations tell.
    """

    branches: list[Leaving]
    family: int = 0
    standing: bool = False


def leaving(
    problem: EquilibriumEquations, z: np.ndarray, error: float, parent: np.ndarray, multiplicity: int
) -> Directions | None:
    """What leaves a point besides the branch with the tangent `parent`; None where that is not known.

    z and the tangent have the shape (N + 1,); `error` is that of the parameter.
    """
    if not 2 <= multiplicity <= MOST or not abs(parent[-1]) > SAME * np.linalg.norm(parent):
        return None
    along = parent / parent[-1]
    space = _NullSpace.at(problem, z, error, along, multiplicity)
    branching = None if space is None else _Branching.along(space, along)
    if space is None or branching is None:
        return None
    moved = [_Branching.along(space.moved(sign), along) for sign in (1.0, -1.0)]
    beside = [each for each in moved if each is not None]
    return branching.found(abs(float(z[-1])) or 1.0, beside) if len(beside) == len(moved) else None


@dataclass(frozen=True, eq=False)
class _NullSpace:
    """Right and left null vectors of F_u, biorthonormal columns of shape (N, k), and F_u bordered by them."""

    problem: EquilibriumEquations
    z: np.ndarray
    right: np.ndarray
    left: np.ndarray
    units: np.ndarray  # of the unknowns, shape (N,)
    known: float  # what null vectors are known to in these units, against their lengths

    @cached_property
    def forms(self) -> Forms:
        """The derivatives at z."""
        return Forms(self.problem, self.z)

    @cached_property
    def bordered(self) -> Factored:
        """F_u bordered by the null vectors."""
        k = self.right.shape[1]
        matrix = self.problem.jacobian(self.z)[:, : len(self.right)]
        return Factored(np.block([[matrix, self.left], [self.right.T, np.zeros((k, k))]]))

    def moved(self, sign: float) -> _NullSpace:
        """The same by some roundings of the point and of the vectors, which tells how known all is."""
        signs = sign * np.cos(np.arange(1.0, len(self.z) + 1.0))  # no symmetry of a machine has these
        z = self.z + ROUNDINGS * EPSILON * np.abs(self.z) * signs
        units, turns = self.units[:, None], self.known * np.outer(signs[:-1], signs[: self.right.shape[1]])
        right = self.right + units * turns * np.linalg.norm(self.right / units, axis=0)
        left = self.left + turns / units * np.linalg.norm(self.left * units, axis=0)
        return replace(self, z=z, right=right, left=left)

    @classmethod
    def at(
        cls, problem: EquilibriumEquations, z: np.ndarray, error: float, along: np.ndarray, k: int
    ) -> _NullSpace | None:
        """That of a point on a branch with the tangent `along`, which has 1 in the parameter.

        None where it has another dimension than k, or eigenvalues are defective.
        """
        size, jacobian, forms = problem.size, problem.jacobian(z), Forms(problem, z)
        # What is nothing against what it becomes would mislead the balancing.
        becomes = np.column_stack([forms.second(unit, along) for unit in np.eye(size)])
        matrix = jacobian[:, :size].copy()
        matrix[np.abs(matrix) <= (KNOWN * error + EXACT * abs(z[-1])) * np.abs(becomes)] = 0.0
        pattern = sum(np.abs(each) / max(np.abs(each).max(), TINY) for each in (matrix, becomes))
        d = balanced(pattern)[1]
        u, sizes, v = np.linalg.svd(matrix / d[:, None] * d)
        if len(sizes) > k and not sizes[-k] <= NULL * sizes[-k - 1]:
            return None
        right, left = d[:, None] * v[-k:].T, u[:, -k:] / d[:, None]
        overlap = left.T @ right
        if not np.linalg.cond(overlap) < 1.0 / ALONE:
            return None
        left = left @ np.linalg.inv(overlap).T
        known = ROUNDINGS * EPSILON * sizes[0] / sizes[-k - 1] if len(sizes) > k else 0.0
        return cls(problem, z, right, left, d, known)

    def solved(self, side: np.ndarray) -> np.ndarray:
        """What F_u takes to a vector, but for its part in the left null space; both have the shape (N,)."""
        return self.bordered.solve(np.append(side, np.zeros(self.right.shape[1])))[: len(side)]

    def second(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """P.D2F(v, w), shape (k,)."""
        return self.left.T @ self.forms.second(v, w)


@dataclass(frozen=True, eq=False)
class _Branching:
    """The branching equations against the branch with the tangent t0: M, shape (k, k), Q, (k, k, k)."""

    space: _NullSpace
    t0: np.ndarray
    mixed: np.ndarray
    quadratic: np.ndarray

    @classmethod
    def along(cls, space: _NullSpace, parent: np.ndarray) -> _Branching | None:
        """Those of a branch whose tangent is near a given one, with 1 in the parameter."""
        columns = space.right.T
        quadratic = np.array([[space.second(a, b) for b in columns] for a in columns])
        bare = np.append(space.solved(-space.problem.jacobian(space.z)[:, -1]), 1.0)
        mixed = np.array([space.second(a, bare) for a in columns]).T
        rest = space.second(bare, bare)

        def equations(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            slope = np.tensordot(a, quadratic, 1).T
            return slope @ a + 2.0 * mixed @ a + rest, 2.0 * (slope + mixed)

        own = _newton(equations, space.left.T @ (parent - bare)[:-1])
        if own is None or not np.linalg.cond(equations(own)[1]) < 1.0 / ALONE:
            return None
        t0 = bare + np.append(space.right @ own, 0.0)
        mixed = mixed + np.tensordot(own, quadratic, 1).T
        if not np.linalg.cond(mixed) < 1.0 / ALONE:
            return None
        return cls(space, t0, mixed, quadratic)

    def found(self, far: float, beside: Sequence[_Branching]) -> Directions:
        """All that leaves, where the parameter has moved by `far`; `beside`: the same, moved by roundings."""
        unsure = max(np.abs(each.quadratic - self.quadratic).max() for each in beside)
        third = np.abs(self.mixed).max() * far * np.abs(self.cubic).max() / 6.0
        bends = np.abs(self.quadratic).max() > max(NOTHING * np.sqrt(third), SURE * unsure)
        equations, starts, same = self._transcritical() if bends else self._pitchforks()
        others = [each._transcritical()[0] if bends else each._pitchforks()[0] for each in beside]
        branches, family, standing = [], 0, False
        for u in solutions(equations, starts, same):
            matrix = equations(u)[1]
            apart = [np.abs(other(u)[1] - matrix) for other in others]
            errors = SURE * np.maximum.reduce(apart)
            if np.linalg.cond(matrix) < 1.0 / ALONE and Factored(matrix).regular(errors):
                branches.append(self._along_curve(u) if bends else self._pitchfork(u))
                continue
            sizes = np.linalg.svd(matrix, compute_uv=False)
            free = int(np.sum(sizes <= max(ALONE * sizes[0], np.linalg.norm(errors))))
            still = not bends and abs(u[-1]) <= np.linalg.norm(errors)
            family, standing = max((family, standing), (free + still, still))
        return Directions([each for each in branches if each is not None], family, standing)

    def _transcritical(self) -> Branches:
        """Equations of branches along N a + t0, starts, and what is the same."""
        size = np.abs(self.mixed).max() / max(np.abs(self.quadratic).max(), TINY)

        def equations(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            slope = np.tensordot(a, self.quadratic, 1).T
            return slope @ a + 2.0 * self.mixed @ a, 2.0 * (slope + self.mixed)

        k = len(self.mixed)
        starts = (sign * share * size * way for way in _ways(k) for share in SIZES for sign in (1.0, -1.0))
        return equations, starts, lambda a, b: bool(np.linalg.norm(a - b) < SAME * np.linalg.norm(b))

    def _along_curve(self, a: np.ndarray) -> Leaving | None:
        """The branch along N a + t0; None where that is the one that leads there."""
        if np.linalg.norm(a) <= SAME * np.abs(self.mixed).max() / np.abs(self.quadratic).max():
            return None
        tangent = self.t0 + np.append(self.space.right @ a, 0.0)
        far = np.abs(self.t0) + np.append(self._extent(float(np.linalg.norm(a))), 0.0)
        return Leaving(tangent, lambda change: far * change)

    def _pitchforks(self) -> Branches:
        """Those along N a, of length 1, while the parameter moves by l times its square, u = (a, l)."""
        cubic, k = self.cubic, len(self.mixed)

        def equations(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            a, speed = u[:-1], u[-1]
            slope = np.tensordot(a, np.tensordot(a, cubic, 1), 1).T
            rows = np.column_stack([0.5 * slope + speed * self.mixed, self.mixed @ a])
            values = slope @ a / 6.0 + speed * self.mixed @ a
            return np.append(values, 0.5 * (a @ a - 1.0)), np.vstack([rows, np.append(a, 0.0)])

        def start(way: np.ndarray) -> np.ndarray:
            slope = np.tensordot(way, np.tensordot(way, cubic, 1), 1).T @ way / 6.0
            along = self.mixed @ way
            return np.append(way, -(along @ slope) / (along @ along))

        def same(u: np.ndarray, v: np.ndarray) -> bool:
            return bool(abs(u[:-1] @ v[:-1]) > 1.0 - SAME)

        return equations, (start(way) for way in _ways(k)), same

    def _pitchfork(self, u: np.ndarray) -> Leaving:
        """The branch along N a."""
        direction, speed = self.space.right @ u[:-1], abs(float(u[-1]))
        lead = direction[int(np.argmax(np.abs(direction)))]
        far = self._extent(1.0 / np.sqrt(speed) if speed > 0.0 else 0.0)
        tangent = np.append(direction * np.sign(lead), 0.0)
        return Leaving(tangent, lambda change: np.append(far * np.sqrt(change), change))

    def _extent(self, length: float) -> np.ndarray:
        """How far each unknown moves in one direction or another with |a| of some length, shape (N,)."""
        return np.asarray(length * np.linalg.norm(self.space.right, axis=1))

    @cached_property
    def cubic(self) -> np.ndarray:
        """C, shape (k, k, k, k), the last index that of the equation."""
        space, columns = self.space, self.space.right.T
        k = len(columns)
        pairs = {
            (i, j): space.solved(-space.forms.second(columns[i], columns[j]))
            for i, j in combinations_with_replacement(range(k), 2)
        }
        cubic = np.zeros((k, k, k, k))
        for i, j, m in combinations_with_replacement(range(k), 3):
            total = space.forms.third(columns[i], columns[j], columns[m])
            for one, two in ((i, (j, m)), (j, (i, m)), (m, (i, j))):
                total = total + space.forms.second(columns[one], pairs[two])
            for place in set(permutations((i, j, m))):
                cubic[place] = space.left.T @ total
        return cubic


def _ways(k: int) -> Iterator[np.ndarray]:
    """Unit vectors of shape (k,) in many directions, no two opposite."""
    for i in range(STARTS * 2**k):
        # Roots of primes are incommensurate: their multiples fill the sphere.
        way = np.sin(2.0 * np.pi * (i + 0.5) * np.sqrt([2.0, 3.0, 5.0, 7.0])[:k])
        yield way / np.linalg.norm(way)


def solutions(
    equations: Equations, starts: Iterator[np.ndarray], same: Callable[[np.ndarray, np.ndarray], bool]
) -> list[np.ndarray]:
    """What Newton's method finds from some starts, each once, in their order; all of the shape (k,)."""
    found: list[np.ndarray] = []
    for start in starts:
        u = _newton(equations, start)
        if u is not None and not any(same(u, known) for known in found):
            found.append(u)
    return found


def _newton(equations: Equations, u: np.ndarray) -> np.ndarray | None:
    """The solution near a start, or of a family the nearest member; None where there is none."""
    for _ in range(ITERATIONS):
        values, matrix = equations(u)
        step = np.linalg.lstsq(matrix, values, rcond=ALONE**2)[0]
        u = u - step
        if not np.isfinite(u).all():
            return None
        if np.linalg.norm(step) <= CONVERGED * max(float(np.linalg.norm(u)), CONVERGED):
            return u
    return None
