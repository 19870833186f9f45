"""How far each state moves on the cycle that is born at a Hopf point.

To first order only the states with a share in the critical vector move. Others follow with the square of the
amplitude, with its cube, or with the square of what follows with its square; and all of them move with the
equilibrium. So the cycle is solved for at one amplitude, harmonic by harmonic: with the linear part inverted,
each round of substitution adds an order.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import PluginError
from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.lyapunov import critical_space, lyapunov
from contwalk.system.variables import declared_scales

# Samples of a round, and harmonics that are solved for: some orders of a small cycle.
SAMPLES, HARMONICS = 32, 6
# Higher orders may be so large against the first one; else the amplitude is halved, so often at most.
MOST, HALVINGS = 0.5, 40
# What a state moves by less than this part of what the others could make of it is rounding.
NOISE = 1e3 * EPSILON
# A state that nothing moves counts as moving this part of what the one does that moves most.
FAINT = 1e-6


class CycleSizes:
    """The sizes of a cycle that is born, when the parameter has changed by a given amount.

    `right` is its critical vector, shape (n,), where there are several: it has a coefficient of its own.
    """

    def __init__(
        self, equilibrium: EquilibriumEquations, point: SpecialPoint, right: np.ndarray | None = None
    ) -> None:
        n, z = equilibrium.states, np.array(point.unknowns)
        self._equilibrium, self._z = equilibrium, z
        self._omega = float(point.coefficients["omega"])
        jacobian = equilibrium.jacobian(z)
        self._a = jacobian[:n, :n]
        self._space = critical_space(self._a, self._omega)
        chosen = self._space.right[:, 0] if right is None else right
        self.right = chosen / np.linalg.norm(chosen)
        self._square = _square_per_change(point) if right is None else self._own_square()
        self._first = 2.0 * np.abs(self.right)
        scales = declared_scales(equilibrium.system.states)
        units = np.where(np.isfinite(scales), scales, 1.0)
        self._faint = FAINT * float((self._first / units).max()) * units
        self._by_itself = self._first > self._faint
        if right is not None:  # what other pairs move stands still here, and could move as much
            self._faint = np.maximum(self._faint, 2.0 * np.linalg.norm(self._space.right, axis=1))
        self._shift = np.abs(equilibrium.solve_states(z, jacobian[:n, -1]))
        self._inverses = [self._inverse(k) for k in range(HARMONICS + 1)]

    def _own_square(self) -> float:
        """As `_square_per_change`, of the vector that was given."""
        found = lyapunov(self._equilibrium, self._z, self._omega, self.right)
        rate = abs(self._equilibrium.crossing_rate(self._z, self.right, found.left))
        known = abs(found.l1) > NOISE * found.size
        return rate / (self._omega * abs(found.l1)) if known else 0.0

    def _inverse(self, k: int) -> np.ndarray:
        """(i k omega - A)^-1; of the first harmonic, the amplitude stays as it is."""
        n = len(self._a)
        if k == 0:
            return -np.column_stack([self._equilibrium.solve_states(self._z, unit) for unit in np.eye(n)])
        matrix = 1j * k * self._omega * np.eye(n) - self._a
        if k > 1:
            return _inverse_of(matrix)
        rows = self._space.left
        columns = (self.right[:, None] if len(rows) == 1 else self._space.right) / self._first.max()
        rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
        corner = np.zeros((len(rows), len(rows)))
        return _inverse_of(np.block([[matrix, columns], [rows, corner]]))[:n, :n]

    def __call__(self, change: float) -> np.ndarray:
        """Half of what each state moves by, or what its mean does, shape (n,): positive."""
        wanted = np.sqrt(self._square * change) if self._square > 0.0 else self._farthest
        rho = wanted
        while (moved := self._moved(rho)) is None and rho > wanted * 0.5**HALVINGS:
            rho *= 0.5
        if self._square == 0.0:
            wanted = rho
        # What is found of a smaller amplitude follows with its square at least.
        higher = np.zeros(len(self._first)) if moved is None else moved * (wanted / rho) ** 2
        sizes = np.where(self._by_itself, wanted * self._first, higher + self._shift * change)
        still = 1e-12 * np.abs(self._z[: len(sizes)])
        least = np.maximum(wanted * self._faint, still)
        return np.where(sizes > 0.0, np.maximum(sizes, still), least)

    @cached_property
    def _farthest(self) -> float:
        """An amplitude beyond which orders do not fall; one half where they always do, or do not there."""
        amplitudes = 0.5 * 2.0 ** np.arange(HALVINGS)
        return next((rho for rho in amplitudes.tolist() if self._moved(2.0 * rho) is None), 0.5)

    def _moved(self, rho: float) -> np.ndarray | None:
        """What each state moves by on the cycle of an amplitude; None where the orders do not fall."""
        n = len(self._a)
        turn = np.exp(2j * np.pi * np.outer(np.arange(SAMPLES), np.arange(HARMONICS + 1)) / SAMPLES)
        first = np.zeros((HARMONICS + 1, n), dtype=complex)
        first[1] = 2.0 * rho * self.right
        harmonics = first.copy()
        for _ in range(n + 2):
            fields = self._fields((turn @ harmonics).real)
            if fields is None:
                return None
            # x = sum of Re(c_k exp(i k w t)) solves (i k w - A) c_k = (f(x) - A x)_k.
            bends = (
                np.fft.fft(fields - (turn @ harmonics).real @ self._a.T, axis=0)[: HARMONICS + 1] / SAMPLES
            )
            bends[1:] *= 2.0
            before = harmonics
            harmonics = first + np.array([m @ b for m, b in zip(self._inverses, bends, strict=True)])
            higher = np.abs(harmonics - first).sum(axis=0)
            if not np.all(higher[self._by_itself] <= MOST * rho * self._first.max()):
                return None
        size = 0.5 * np.ptp((turn @ harmonics).real, axis=0) + np.abs(harmonics[0])
        noise = NOISE * sum(np.abs(m) for m in self._inverses) @ (np.abs(self._a) @ size)
        # The others may run away while those of the first order stay as they are, in exact balance.
        settled = np.all(np.abs(harmonics - before).sum(axis=0) <= np.maximum(MOST * size, noise))
        return np.where(size > noise, size, 0.0) if settled else None

    def _fields(self, deviations: np.ndarray) -> np.ndarray | None:
        """The field at the Hopf point's state displaced, shape (s, n); None where it is not finite."""
        n, z, fields = len(self._a), self._z, []
        for deviation in deviations:
            moved = z.copy()
            moved[:n] += deviation
            try:
                with np.errstate(all="ignore"):
                    field = self._equilibrium.kernels.residual(*self._equilibrium.inputs(moved))[:n]
            except PluginError:
                return None
            if not np.isfinite(field).all():  # a path that fails gives one NaN for all components
                return None
            fields.append(field)
        return np.array(fields)


def _square_per_change(point: SpecialPoint) -> float:
    """rho^2 per change of the parameter: rate / (omega |l1|); 0 where the normal form does not tell: l1 is
    zero to its error, or has no value.
    """
    if point.criticality is None:
        return 0.0
    omega, l1, rate = (abs(float(point.coefficients[name])) for name in ("omega", "l1", "crossing_rate"))
    return rate / (omega * l1)


def _inverse_of(matrix: np.ndarray) -> np.ndarray:
    """The inverse, shape (n, n); of what a resonance of two pairs makes singular, the shortest solutions."""
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(matrix)
