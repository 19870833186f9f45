"""One time round an orbit from beside it: the map whose derivatives normal forms are made of.

A start lies in the plane across the flow through the orbit's own start. It goes through the same legs, each
up to its guard, and then forth or back to that plane; of a forced orbit to the end of the closure.
"""

from __future__ import annotations

import numpy as np

from contwalk.verification.equations import Evaluation, basis
from contwalk.verification.finding import CannotTell
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import EPSILON, reached


class Round:
    """The map of a section once round.

    Parameters
    ----------
    equations : OrbitEquations
    at : Evaluation
        At the orbit.
    relative : float
        The tolerance of motions.

    Attributes
    ----------
    basis : ndarray, shape (n, r)
        The section's directions in states.
    matrix : ndarray, shape (r, r)
        The map's derivative.
    """

    def __init__(self, equations: OrbitEquations, at: Evaluation, relative: float) -> None:
        self.equations, self.relative = equations, relative
        functions, size = equations.functions, equations.size
        if any(
            name not in functions.system.conserved_names for name in equations.info.settings.get("pins", ())
        ):
            raise CannotTell("Directions that are held have no return map that is recomputed.")
        if equations.lasting_first:
            raise CannotTell("The return map of an orbit that a leg of no time begins is not recomputed.")
        self.mode, n = equations.legs[0][0], len(equations.first[0])
        self.origin, self.start = at.z[:n], float(at.z[size - 1])
        self.free = at.z[size:]
        self.durations = at.z[size - equations.count - 1 : size - 1]
        self.p = functions.parameters.at(self.free)
        self.flow, _ = functions.field(self.mode)(self.start, self.origin, self.p)
        self.levels = self._levels(self.origin)[0]
        gradients = self._levels(self.origin)[1]
        self.basis = basis(gradients, [] if equations.forced else [self.flow])
        self.lift = np.linalg.pinv(gradients) if len(gradients) else np.zeros((n, 0))
        self.matrix, self.total, self.legs = at.matrix, float(self.durations.sum()), at.legs

    def _levels(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Conserved quantities at a state, shape (j,), and their gradients, (j, n)."""
        functions, values, rows = self.equations.functions, [], []
        for quantity in functions.system.conserved:
            made = functions.number(("conserved", quantity.name), self.mode, quantity.of(self.mode))
            value, slope = made(self.start, x, self.p)
            values.append(value[0])
            rows.append(slope[0, 1 : 1 + len(x)])
        return np.array(values), np.array(rows).reshape(-1, len(x))

    @property
    def by_free(self) -> np.ndarray:
        """Derivatives of the map by the free parameters, shape (r, k).

        Raises
        ------
        CannotTell
            If events lie on the way, or the period is a function of parameters.
        """
        if self.equations.eventful or self.equations.forced:
            raise CannotTell("How events move with the parameter is not recomputed.")
        n, moved = len(self.origin), np.zeros((len(self.origin), len(self.free)))
        for piece in self.legs[0].pieces:
            moved = piece.derivative[:, 1 : 1 + n] @ moved + piece.derivative[:, 1 + n :]
        own, end = self.equations, self.legs[0].pieces[-1]
        image = own.functions.jump(None, end.mode, self.mode, own.image, own.power)
        _, by = image(self.start, end.end, self.p)
        return np.asarray(self.basis.T @ (by[:, 1 : 1 + n] @ moved + by[:, 1 + n :]))

    def __call__(self, xi: np.ndarray) -> np.ndarray:
        """Where a start xi, shape (r,), comes back; both from the orbit's own start."""
        equations, p = self.equations, self.p
        x, t = self._begun(xi), self.start
        for number, (mode, event) in enumerate(equations.legs):
            x, t = self._leg(number, mode, event, x, t, float(self.durations[number]), p)
        rest = self.total + self.start - t
        if equations.forced:
            x, _ = self._flown(self.mode, self.start - rest, x, rest, p)
        else:
            x = self._onto_plane(x, p)
        return np.asarray(self.basis.T @ (x - self.origin))

    def _begun(self, xi: np.ndarray) -> np.ndarray:
        """The start of a point of the section, at the same conserved quantities."""
        x = self.origin + self.basis @ xi
        for _ in range(12 if len(self.levels) else 0):
            x = x - self.lift @ (self._levels(x)[0] - self.levels)
        return np.asarray(x)

    def _flown(
        self, mode: str, t: float, x: np.ndarray, duration: float, p: np.ndarray
    ) -> tuple[np.ndarray, str]:
        """Where a motion is after a duration, and in which mode."""
        if duration == 0.0:
            return x, mode
        scale = self.equations._scale(mode)
        return reached(self.equations.functions, mode, t, x, duration, p, scale, self.relative)

    def _leg(
        self, number: int, mode: str, event: str, x: np.ndarray, t: float, duration: float, p: np.ndarray
    ) -> tuple[np.ndarray, float]:
        """Follow a leg up to its event, and what happens there: the next leg's start, and when it is."""
        equations, functions = self.equations, self.equations.functions
        last = number == len(equations.legs) - 1
        target = equations.legs[0 if last else number + 1][0]
        (x, ends), t = self._flown(mode, t, x, duration, p), t + duration
        transition = functions.system.transition(event, ends) if event else None
        if transition is not None and not equations.momentary[number]:
            guard, field = functions.guard(transition), functions.field(ends)
            for _ in range(12):
                value, slope = guard(t, x, p)
                rate = float(slope[0, 0] + slope[0, 1 : 1 + len(x)] @ field(t, x, p)[0])
                step = -float(value[0]) / rate
                if not abs(step) < self.total:
                    raise CannotTell("A motion beside the orbit does not meet its event.")
                (x, ends), t = self._flown(ends, t, x, step, p), t + step
                if abs(step) <= EPSILON * self.total:
                    break
        image, power = (equations.image, equations.power) if last else ("", 0)
        after, _ = functions.jump(transition, ends, target, image, power)(t, x, p)
        return after - (equations.turns[list(functions.system.states_of(target))] if last else 0.0), t

    def _onto_plane(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Forth or back along the motion, to the plane across the flow."""
        field = self.equations.functions.field(self.mode)
        for _ in range(12):
            rate = float(self.flow @ field(self.start, x, p)[0])
            step = -float(self.flow @ (x - self.origin)) / rate
            if not abs(step) < self.total:
                raise CannotTell("A motion beside the orbit does not come back to its section.")
            x, _ = self._flown(self.mode, self.start, x, step, p)
            if abs(step) <= EPSILON * self.total:
                break
        return x
