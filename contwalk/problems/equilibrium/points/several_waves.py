"""The waves that are born at a Hopf point at which several pairs of eigenvalues pass together.

Any vector q = Q a of the critical space is an eigenvector, and cycles are born along those that solve

    l M a + G(a, a, a*) = i t a,    |a| = 1,

while the parameter moves by l |x|^2 and the frequency by t |x|^2: M = P.(dA/dlambda) Q, and G is the cubic
part of the normal form of all pairs (M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapter XVI;
coefficients as in Yu. A. Kuznetsov, 2004, eq. 5.34). Solutions are looked for from many starts; those that
are not alone but for their phase, to the errors of the coefficients, are members of families.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from contwalk.numerics.linear import EPSILON, Factored
from contwalk.numerics.permutations import Permutation
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import ROUNDINGS, SURE, Forms
from contwalk.problems.equilibrium.permutations import permutations_at
from contwalk.problems.equilibrium.points.lyapunov import SAME, CriticalSpace, critical_space
from contwalk.problems.equilibrium.points.symmetric_vectors import symmetric_vectors
from contwalk.problems.equilibrium.several_directions import ALONE, CONVERGED, MOST, STARTS, solutions
from contwalk.problems.images import to_declare


@dataclass(frozen=True, eq=False)
class Waves:
    """Of `pairs` that pass together, the critical vectors of the waves that are born.

    Parameters
    ----------
    pairs : int
    vectors : list of ndarray, shape (n,)
        Complex, of length 1, in any phase.
    hidden : int
        How many more a symmetry tells whose direction the normal form does not, to the third order.
    family : int
        Dimension of families of waves, beside their phase, whose members are not told apart.
    permutations : list of tuples of int
        Those of the states under which the field is unchanged, if nothing is declared that turns the waves.
    """

    pairs: int
    vectors: list[np.ndarray]
    hidden: int = 0
    family: int = 0
    permutations: list[Permutation] = field(default_factory=list)

    def sentence(self, names: tuple[str, ...], kinds: Sequence[str | None]) -> str:
        """What is told of them, of the criticality of each, and what could be declared.

        `names` are those of the states.
        """
        count = len(self.vectors)
        followed = f"{count} wave{' is' if count == 1 else 's are'} followed"
        each = [
            f"{kinds.count(kind)} {kind or 'vertical to the third order'}" for kind in dict.fromkeys(kinds)
        ]
        followed += f" ({', '.join(each)})" if len(each) > 1 or None in kinds else ""
        told = [f"{self.pairs} pairs of eigenvalues pass together: {followed}"]
        if self.hidden or self.family:
            told.append(
                "others lie in a family as far as terms up to the third order tell, and are not followed"
            )
        if self.permutations:
            told.append(to_declare(self.permutations, names, "waves"))
        return "; ".join(told)


def waves_at(problem: EquilibriumEquations, z: np.ndarray, omega: float) -> Waves | None:
    """The waves at a Hopf point z, shape (N + 1,); None where one pair passes alone.

    They are those that a symmetry tells, to all orders, or where none does, those of the normal form.
    """
    n = problem.states
    a = problem.jacobian(z)[:n, :n]
    space = critical_space(a, omega)
    pairs = space.right.shape[1]
    if pairs < 2:
        return None
    turned = symmetric_vectors(problem, z, space.right)
    if turned or pairs > MOST:
        return Waves(pairs, turned)
    orders = permutations_at(problem, z)
    turned = symmetric_vectors(problem, z, space.right, orders)
    space = _in_own_units(problem, z, space, omega)
    here, *beside = (_Amplitudes.at(problem, each, moved, omega) for each, moved in _moved(z, a, space))
    if turned:
        vectors = [q for q in turned if _alone(here, beside, here.of(space, q)) is None]
        return Waves(pairs, vectors, len(turned) - len(vectors), permutations=orders)
    starts = np.random.default_rng(pairs).normal(size=(STARTS * 2**pairs, 2 * pairs))
    vectors, family = list[np.ndarray](), 0
    for u in solutions(here.equations, map(here.start, starts), _same):
        members = _alone(here, beside, u)
        if members is None:
            shares = _complex(u[:-2])
            q = space.right @ np.where(np.abs(shares) <= CONVERGED, 0.0, shares)
            vectors.append(q / np.linalg.norm(q))
        else:
            family = max(family, members)
    return Waves(pairs, vectors, family=family, permutations=orders)


def _alone(here: _Amplitudes, beside: Sequence[_Amplitudes], u: np.ndarray) -> int | None:
    """Dimension of the family that a solution, shape (2 k + 2,), is a member of; None where it is alone."""
    matrix = here.with_phase(u)
    errors = SURE * np.maximum.reduce([np.abs(each.with_phase(u) - matrix) for each in beside])
    factored = Factored(matrix)
    if factored.condition() < 1.0 / ALONE and factored.regular(errors):
        return None
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(sizes <= max(ALONE * sizes[0], np.linalg.norm(errors))))


def _in_own_units(
    problem: EquilibriumEquations, z: np.ndarray, space: CriticalSpace, omega: float
) -> CriticalSpace:
    """The same space by vectors each of which has a state of its own, so long that cubic terms are like M."""
    rows = list[int]()
    rest = space.right.copy()
    for _ in range(rest.shape[1]):  # as by Gauss's elimination
        i, j = np.unravel_index(int(np.argmax(np.abs(rest))), rest.shape)
        rows.append(int(i))
        rest = rest - np.outer(rest[:, j], rest[i] / rest[i, j])
    own = space.right[rows]
    alone = CriticalSpace(space.right @ np.linalg.inv(own), own @ space.left)
    found = _Amplitudes.at(problem, z, alone, omega)
    sizes = np.array([np.abs(found.cubic[i, i, i]).max() for i in range(len(own))])
    lengths = np.sqrt(np.abs(found.mixed).max() / np.where(sizes > 0.0, sizes, sizes.max() or 1.0))
    return CriticalSpace(alone.right * lengths, alone.left / lengths[:, None])


def _moved(z: np.ndarray, a: np.ndarray, space: CriticalSpace) -> list[tuple[np.ndarray, CriticalSpace]]:
    """A Hopf point with its critical vectors, and twice the same by some roundings of all of them."""
    sizes = np.linalg.norm(space.left, axis=1) * np.linalg.norm(space.right, axis=0)
    known = ROUNDINGS * EPSILON * float(sizes.max())
    found = [(z, space)]
    for sign in (1.0, -1.0):
        signs = sign * np.cos(np.arange(1.0, len(z) + 1.0))  # no symmetry of a machine has these
        turns = known * np.outer(signs[: len(a)], signs[: space.right.shape[1]])
        right = space.right + turns * np.linalg.norm(space.right, axis=1, keepdims=True)
        left = space.left + turns.T * np.linalg.norm(space.left, axis=0, keepdims=True)
        found.append((z + ROUNDINGS * EPSILON * np.abs(z) * signs, CriticalSpace(right, left)))
    return found


@dataclass(frozen=True, eq=False)
class _Amplitudes:
    """The equations of u = (Re a, Im a, l, t), shape (2 k + 2,): M, shape (k, k), and G, (k, k, k, k)."""

    mixed: np.ndarray
    cubic: np.ndarray  # its last index is that of the equation, the one before that of a*

    @classmethod
    def at(
        cls, problem: EquilibriumEquations, z: np.ndarray, space: CriticalSpace, omega: float
    ) -> _Amplitudes:
        """Those of a Hopf point z, shape (N + 1,)."""
        n, forms, jacobian = problem.states, Forms(problem, z), problem.jacobian(z)
        along = Factored(jacobian[:, : problem.size]).solve(-jacobian[:, -1])
        rate = problem.kernels.rate_of_matrix(*problem.inputs(z), [*along.tolist(), 1.0])
        q, k = space.right.T, space.right.shape[1]
        twice = 2j * omega * np.eye(n) - jacobian[:n, :n]
        mean = [[problem.solve_states(z, -forms.second(u, v.conj())[:n]) for v in q] for u in q]
        double = [[np.linalg.solve(twice, forms.second(u, v)[:n]) for v in q] for u in q]
        cubic = np.zeros((k, k, k, k), dtype=complex)
        for i, j, m in product(range(k), repeat=3):
            total = forms.third(q[i], q[j], q[m].conj()) + forms.second(q[m].conj(), double[i][j])
            total = total + forms.second(q[i], mean[j][m]) + forms.second(q[j], mean[i][m])
            cubic[i, j, m] = 0.5 * space.left @ total[:n]
        return cls(space.left @ rate @ space.right, cubic)

    def equations(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values, shape (2 k + 1,), and derivatives: phases are left to what solves them."""
        a, (side, turn) = _complex(u[:-2]), u[-2:]
        both = np.einsum("i,ijmo->jmo", a, self.cubic)
        by_own = 2.0 * np.einsum("jmo,m->oj", both, a.conj()) + side * self.mixed - 1j * turn * np.eye(len(a))
        by_conjugate = np.einsum("jmo,j->om", both, a)
        values = by_conjugate @ a.conj() + (side * self.mixed - 1j * turn * np.eye(len(a))) @ a
        columns = np.column_stack(
            [by_own + by_conjugate, 1j * (by_own - by_conjugate), self.mixed @ a, -1j * a]
        )
        norm = np.concatenate([a.real, a.imag, [0.0, 0.0]])
        rows = np.vstack([columns.real, columns.imag, norm])
        return np.concatenate([values.real, values.imag, [0.5 * (np.vdot(a, a).real - 1.0)]]), rows

    def with_phase(self, u: np.ndarray) -> np.ndarray:
        """The derivatives and a row that holds the phase, shape (2 k + 2, 2 k + 2)."""
        a = _complex(u[:-2])
        return np.vstack([self.equations(u)[1], np.concatenate([-a.imag, a.real, [0.0, 0.0]])])

    def of(self, space: CriticalSpace, q: np.ndarray) -> np.ndarray:
        """u along a critical vector, shape (n,)."""
        a = space.left @ q
        return self.start(np.concatenate([a.real, a.imag]))

    def start(self, way: np.ndarray) -> np.ndarray:
        """u along a direction, shape (2 k,), with the l and t that fit it best."""
        u = np.append(way / np.linalg.norm(way), [0.0, 0.0])
        values, rows = self.equations(u)
        u[-2:] = -np.linalg.lstsq(rows[:-1, -2:], values[:-1], rcond=None)[0]
        return u


def _complex(parts: np.ndarray) -> np.ndarray:
    """Numbers, shape (k,), of their real and imaginary parts, shape (2 k,)."""
    half = len(parts) // 2
    return parts[:half] + 1j * parts[half:]


def _same(u: np.ndarray, v: np.ndarray) -> bool:
    """Whether two waves differ by their phase alone."""
    return bool(abs(np.vdot(_complex(u[:-2]), _complex(v[:-2]))) > 1.0 - SAME)
