"""The instant at which a motion begins in a mode: memory in which compiled code finds it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.events.guard import EPSILON, Guard
from contwalk.flow.hybrid.guard_taylor_records import GuardTaylorCoefficients, Instant

_STANDING = Entry("contwalk.flow.hybrid.guard_taylor_kernel", "standing", "q", "qqqddd")


def warmup() -> None:
    """Compile what does not depend on the machine, or find it compiled."""
    _ = _STANDING.address


class GuardTaylor:
    """Memory of instants of a mode at given parameters.

    Parameters
    ----------
    field : CompiledField
    c, p : ndarray
        The field's constants, and the parameters that they were made from.
    given : mapping, optional
        Addresses of the state, velocity, noise and weights of an `Instant` that a caller fills in; they are
        owned otherwise.
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, p: np.ndarray, given: Mapping[str, int] | None = None
    ) -> None:
        n = field.n
        self._field, self._c = field, c
        self._state, self._velocity = np.zeros(n), np.zeros(n)
        self._noise, self._weights = np.zeros(1 + n), np.ones(n)
        self._answer = GuardTaylorCoefficients()
        arrays = {
            "constants": c,
            "parameters": np.ascontiguousarray(p, dtype=float),
            "rows": np.ascontiguousarray(field.row_ptr),
            "columns": np.ascontiguousarray(field.col),
            "state": self._state,
            "velocity": self._velocity,
            "noise": self._noise,
            "weights": self._weights,
            "found": np.zeros(n + len(field.col)),
            "varied": np.zeros(2 * n),
            "motion": np.zeros(3 * n),
            "sloped": np.zeros(4 + 2 * n),
        }
        self._kept = list(arrays.values())
        addresses = {name: array.ctypes.data for name, array in arrays.items()} | dict(given or {})
        self.instant = Instant(
            **addresses,
            rhs_jac=field.rhs_jac_address,
            variation=field.variation_address,
            answer=self._answer.address,
            size=n,
        )

    def at(self, t: float, x: np.ndarray, noise: np.ndarray, weights: np.ndarray) -> None:
        """Put an instant in place: states, their uncertainties and their magnitudes, each of shape (n,)."""
        self._t = t
        self._state[:], self._weights[:] = x, weights
        self._velocity[:] = self._field.along(np.array([t]), self._state[None], self._c)[0]
        self._noise[0], self._noise[1:] = EPSILON * abs(t), noise
        self.instant.known = 0

    @property
    def velocity(self) -> np.ndarray:
        """The rates of the states at the instant, shape (n,)."""
        return self._velocity

    def standing(self, guard: Guard, factor: float, beside: float) -> tuple[int, GuardTaylorCoefficients]:
        """How a guard of the mode stands at the instant, and the answer; see `guard_taylor_kernel.stands`."""
        kind = _STANDING(self.instant.address, guard.slopes_address, guard.direction, self._t, factor, beside)
        return kind, self._answer
