"""Leaving a point at which several real eigenvalues vanish together, along all solutions of its equations.

N and P are the right and left null spaces of F_u, t0 = (h, 1) the tangent of the branch that leads there.
Others leave along N a + t0 with Q(a, a) + 2 M a = 0; where Q is zero, along N a with C(a, a, a)/6 = -l M a,
while the parameter moves by l |a|^2. M = P.D2F(N, t0), Q = P.D2F(N, N), C = P.(D3F + 3 D2F(N, g)), where g
solves F_u g = -D2F(N, N) (M. Golubitsky & D. G. Schaeffer, 1985). Solutions are looked for from many starts;
those that are not alone, as of a continuous symmetry, are none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement, permutations

import numpy as np

from contwalk.numerics.linear import Factored, balanced
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import Forms

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


def leaving(
    problem: EquilibriumEquations, z: np.ndarray, error: float, parent: np.ndarray, multiplicity: int
) -> list[Leaving] | None:
    """The branches that leave a point besides that with the tangent `parent`; None where they are not known.

    z and the tangent have the shape (N + 1,); `error` is that of the parameter.
    """
    if not 2 <= multiplicity <= MOST or not abs(parent[-1]) > SAME * np.linalg.norm(parent):
        return None
    along = parent / parent[-1]
    space = _NullSpace.at(problem, z, error, along, multiplicity)
    branching = None if space is None else _Branching.along(space, along)
    if branching is None:
        return None
    far = abs(float(z[-1])) or 1.0
    found = branching.transcritical() if branching.bends(far) else branching.pitchforks()
    return list(found)


@dataclass(frozen=True, eq=False)
class _NullSpace:
    """Right and left null vectors of F_u, biorthonormal columns of shape (N, k), and F_u bordered by them."""

    forms: Forms
    right: np.ndarray
    left: np.ndarray
    bordered: Factored
    column: np.ndarray  # F_lambda

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
        border = np.block([[matrix, left], [right.T, np.zeros((k, k))]])
        return cls(forms, right, left, Factored(border), jacobian[:, -1])

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
        bare = np.append(space.solved(-space.column), 1.0)
        mixed = np.array([space.second(a, bare) for a in columns]).T
        rest = space.second(bare, bare)

        def equations(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            slope = np.tensordot(a, quadratic, 1).T
            return slope @ a + 2.0 * mixed @ a + rest, 2.0 * (slope + mixed)

        own = _newton(equations, space.left.T @ (parent - bare)[:-1])
        if own is None:
            return None
        t0 = bare + np.append(space.right @ own, 0.0)
        mixed = mixed + np.tensordot(own, quadratic, 1).T
        if not np.linalg.cond(mixed) < 1.0 / ALONE:
            return None
        return cls(space, t0, mixed, quadratic)

    def bends(self, far: float) -> bool:
        """Whether Q is not nothing, beside C, where the parameter has moved by as much as `far`."""
        beside = np.abs(self.mixed).max() * far * np.abs(self._cubic()).max() / 6.0
        return bool(np.abs(self.quadratic).max() > NOTHING * np.sqrt(beside))

    def transcritical(self) -> Iterator[Leaving]:
        """Branches along N a + t0."""
        size = np.abs(self.mixed).max() / np.abs(self.quadratic).max()

        def equations(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            slope = np.tensordot(a, self.quadratic, 1).T
            return slope @ a + 2.0 * self.mixed @ a, 2.0 * (slope + self.mixed)

        k = len(self.mixed)
        starts = (sign * share * size * way for way in _ways(k) for share in SIZES for sign in (1.0, -1.0))
        for a in _solutions(equations, starts, lambda a, b: np.linalg.norm(a - b) < SAME * np.linalg.norm(b)):
            if np.linalg.norm(a) > SAME * size:
                tangent = self.t0 + np.append(self.space.right @ a, 0.0)
                far = np.abs(self.t0) + np.append(self._extent(float(np.linalg.norm(a))), 0.0)
                yield Leaving(tangent, lambda change, far=far: far * change)  # type: ignore[misc]

    def pitchforks(self) -> Iterator[Leaving]:
        """Branches along N a, of length 1, while the parameter moves by l times its square."""
        cubic, k = self._cubic(), len(self.mixed)

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

        for u in _solutions(equations, (start(way) for way in _ways(k)), same):
            direction, speed = self.space.right @ u[:-1], abs(float(u[-1]))
            lead = direction[int(np.argmax(np.abs(direction)))]
            tangent = np.append(direction * np.sign(lead), 0.0)
            far = self._extent(1.0 / np.sqrt(speed) if speed > 0.0 else 0.0)

            def reach(change: float, far: np.ndarray = far) -> np.ndarray:
                return np.append(far * np.sqrt(change), change)

            yield Leaving(tangent, reach)

    def _extent(self, length: float) -> np.ndarray:
        """How far each unknown moves in one direction or another with |a| of some length, shape (N,)."""
        return np.asarray(length * np.linalg.norm(self.space.right, axis=1))

    def _cubic(self) -> np.ndarray:
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


def _solutions(
    equations: Equations, starts: Iterator[np.ndarray], same: Callable[[np.ndarray, np.ndarray], bool]
) -> list[np.ndarray]:
    """What Newton's method finds from some starts, each once, in the order of the starts."""
    found: list[np.ndarray] = []
    for start in starts:
        u = _newton(equations, start)
        if u is not None and not any(same(u, known) for known in found):
            found.append(u)
    return found


def _newton(equations: Equations, u: np.ndarray) -> np.ndarray | None:
    """A solution that is alone; None where there is none near the start."""
    for _ in range(ITERATIONS):
        values, matrix = equations(u)
        if not np.linalg.cond(matrix) < 1.0 / ALONE**2:
            return None
        step = np.linalg.solve(matrix, values)
        u = u - step
        if not np.isfinite(u).all():
            return None
        if np.linalg.norm(step) <= CONVERGED * max(float(np.linalg.norm(u)), CONVERGED):
            return u if np.linalg.cond(equations(u)[1]) < 1.0 / ALONE else None
    return None
