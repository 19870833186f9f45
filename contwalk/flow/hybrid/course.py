"""The instant at which a motion begins in a mode: memory in which compiled code finds it."""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.events.guard import EPSILON, Guard
from contwalk.flow.hybrid import course_plan as plan

_STANDING = Entry("contwalk.flow.hybrid.course_kernel", "standing", "q", "qqqddd")


def warmup() -> None:
    """Compile what does not depend on the machine, or find it compiled."""
    _ = _STANDING.address


class Course:
    """Memory of instants of a mode at given parameters.

    Parameters
    ----------
    field : CompiledField
    c, p : ndarray
        The field's constants, and the parameters that they were made from.
    given : mapping, optional
        Addresses of states, velocity, uncertainties and magnitudes (entries of `course_plan`) that a caller
        fills in; they are owned otherwise.
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, p: np.ndarray, given: dict[int, int] | None = None
    ) -> None:
        n = field.n
        self._field, self._c = field, c
        self._state, self._velocity = np.zeros(n), np.zeros(n)
        self._noise, self._weights = np.zeros(1 + n), np.ones(n)
        self._answer = np.zeros(plan.ANSWER_LENGTH)
        arrays = {
            plan.CONSTANTS: c,
            plan.PARAMETERS: np.ascontiguousarray(p, dtype=float),
            plan.ROWS: np.ascontiguousarray(field.row_ptr),
            plan.COLUMNS: np.ascontiguousarray(field.col),
            plan.STATE: self._state,
            plan.VELOCITY: self._velocity,
            plan.NOISE: self._noise,
            plan.WEIGHTS: self._weights,
            plan.FOUND: np.zeros(n + len(field.col)),
            plan.VARIED: np.zeros(2 * n),
            plan.MOTION: np.zeros(3 * n),
            plan.SLOPED: np.zeros(4 + 2 * n),
            plan.ANSWER: self._answer,
        }
        self._kept = list(arrays.values())
        self.plan = np.zeros(plan.PLAN_LENGTH, dtype=np.int64)
        for position, array in arrays.items():
            self.plan[position] = array.ctypes.data
        for position, address in (given or {}).items():
            self.plan[position] = address
        self.plan[plan.RHS_JAC], self.plan[plan.VARIATION] = field.rhs_jac_address, field.variation_address
        self.plan[plan.SIZE] = n

    def at(self, t: float, x: np.ndarray, noise: np.ndarray, weights: np.ndarray) -> None:
        """Put an instant in place: states, their uncertainties and their magnitudes."""
        self._t = t
        self._state[:], self._weights[:] = x, weights
        self._velocity[:] = self._field.along(np.array([t]), self._state[None], self._c)[0]
        self._noise[0], self._noise[1:] = EPSILON * abs(t), noise
        self.plan[plan.KNOWN] = 0

    @property
    def velocity(self) -> np.ndarray:
        """The rates of the states at the instant."""
        return self._velocity

    def standing(self, guard: Guard, factor: float, beside: float) -> tuple[int, np.ndarray]:
        """How a guard of the mode stands at the instant, and the answer; see `course_kernel.stands`."""
        kind = _STANDING(
            self.plan.ctypes.data, guard.slopes_address, guard.direction, self._t, factor, beside
        )
        return kind, self._answer
