"""What lies between soft transitions, eliminated from the equations of an explicit orbit, exactly."""

from __future__ import annotations

from functools import cached_property
from typing import Generic

import numpy as np

from contwalk.numerics.broyden import broyden_step
from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.limited_orbit import Kind
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.parameter_line import ParameterLine

# Corrections of what is eliminated, and a residual of it that is solved, in units of its level: what is left
# of it enters the other equations, to first order.
MOST_CORRECTIONS, SOLVED = 4, 1e2
# Beyond corrections of this size, against the orbit's, the next solution may be another one.
COARSE = 1e-2
# Corrections by the derivatives of another orbit: how many at most, and by how much each is smaller at least.
MOST_CHORDS, CONTRACTS = 12, 0.5
# What is left of the other equations, in their units, near a solution.
NEARLY = 1e-7
# The same where it is worth to ask whether it is the machine's.
SETTLED = 1e-4


class Eliminated(Generic[Kind]):
    """An explicit orbit's equations with what is eliminated from them, at the unknowns z that are left."""

    def __init__(self, explicit: Kind, grouping: Grouping, z: np.ndarray, soft: np.ndarray) -> None:
        self.explicit, self.grouping, self.z, self.soft = explicit, grouping, z, soft
        self.unknowns = grouping.joined(z, soft)

    @cached_property
    def _parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        found, grouping = self.explicit.linearize(self.unknowns), self.grouping
        own, soft = grouping.columns(found.jacobian)
        hard_rows, soft_rows = grouping.hard_rows, grouping.soft_rows
        return (
            found.residual[hard_rows],
            found.residual[soft_rows],
            own[hard_rows],
            soft[hard_rows],
            own[soft_rows],
            soft[soft_rows],
        )

    @property
    def finite(self) -> bool:
        """Whether the equations have values."""
        return self.explicit.linearize(self.unknowns).finite

    @cached_property
    def _level(self) -> np.ndarray:
        """Level of the residuals of what is eliminated."""
        return self.explicit.linearize(self.unknowns).levels[0][self.grouping.soft_rows]

    def excess_of(self, residual: np.ndarray) -> float:
        """A residual of what is eliminated, in units of its level here. The residual has the shape (e,)."""
        return float(np.max(np.abs(residual) / self._level, initial=0.0))

    @cached_property
    def excess(self) -> float:
        """Residual of what is eliminated, in units of its level."""
        return self.excess_of(self._parts[1])

    @property
    def solved(self) -> bool:
        """Whether what is eliminated is solved for."""
        return self.excess <= SOLVED

    @property
    def settles(self) -> bool:
        """Whether what is left is solved nearly."""
        return self.solved and self.left < SETTLED

    @cached_property
    def left(self) -> float:
        """What is left to solve, in units of the equations."""
        return self.size_of(self.residual)

    def size_of(self, residual: np.ndarray) -> float:
        """A residual of what is left, in units of the equations. The residual has the shape (N,)."""
        return float(np.linalg.norm(residual / self._scales))

    @cached_property
    def _scales(self) -> np.ndarray:
        return self.explicit.equation_scales[self.grouping.hard_rows]

    @cached_property
    def inverse(self) -> np.ndarray:
        """Inverse of the derivatives by what is eliminated of its own equations: it is used often.

        Shape (e, e).
        """
        return np.linalg.inv(self._parts[5])

    @cached_property
    def correction(self) -> np.ndarray:
        """What Newton's method subtracts from what is eliminated. Shape (e,)."""
        return self.inverse @ self._parts[1]

    @cached_property
    def step(self) -> float:
        """Length of the correction, in units of the states' variation and of the closure's duration."""
        return float(np.linalg.norm(self.correction / self.sizes))

    @cached_property
    def sizes(self) -> np.ndarray:
        """Units of what is eliminated: the states' variation, and the closure's duration. Shape (e,)."""
        return self.grouping.split(np.append(cycle_scales(self.explicit)[1], 1.0))[1]

    @cached_property
    def slope(self) -> np.ndarray:
        """Derivative of what is eliminated by the unknowns. Shape (e, N + 1)."""
        return -self.inverse @ self._parts[4]

    @cached_property
    def residual(self) -> np.ndarray:
        """Of the equations that are left. Shape (N,)."""
        return self.corrected(self._parts[0], self.correction)

    def corrected(self, hard: np.ndarray, correction: np.ndarray) -> np.ndarray:
        """What a correction of what is eliminated makes of a residual of what is left, to first order."""
        return hard - self._parts[3] @ correction

    @property
    def jacobian(self) -> np.ndarray:
        """Derivatives of what is left by the unknowns that are left. Shape (N, N + 1)."""
        _, _, by_own, by_soft, _, _ = self._parts
        return by_own + by_soft @ self.slope

    def along(self, column: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by another parameter of what is left, (N,), and of what is eliminated itself, (e,).

        `column` are those of all equations, shape (N + e,).
        """
        soft = -self.inverse @ column[self.grouping.soft_rows]
        return column[self.grouping.hard_rows] + self._parts[3] @ soft, soft

    def levels(self, explicit: np.ndarray) -> np.ndarray:
        """Levels of what is left, from levels of all equations. Shape (N,)."""
        own, soft = explicit[self.grouping.hard_rows], explicit[self.grouping.soft_rows]
        return own + np.abs(self._parts[3] @ self.inverse) @ soft

    def direction(self, tangent: np.ndarray) -> np.ndarray:
        """A direction of the unknowns that are left as one of all of them.

        The tangent has the shape (N + 1,).
        """
        return self.grouping.joined(tangent, self.slope @ tangent)


class OnLine(Eliminated[Kind]):
    """What is known of an orbit as where solutions on another line through the parameters begin.

    Nothing is solved on that line yet: the derivatives are those of the line that it was solved on.
    """

    def __init__(self, of: Eliminated[Kind], line: ParameterLine) -> None:
        self._of: Eliminated[Kind] = of._of if isinstance(of, OnLine) else of
        z = of.z.copy()
        z[-1] = line.parameters.get(line.free, 0.0)  # where the line was drawn
        super().__init__(of.explicit.varied(line=line, free=line.free), of.grouping, z, of.soft)

    @property
    def solved(self) -> bool:
        """Nothing is."""
        return False

    @cached_property
    def correction(self) -> np.ndarray:
        """None is known, shape (e,)."""
        return np.zeros(len(self.soft))

    @cached_property
    def inverse(self) -> np.ndarray:
        """That of the orbit it is made of. Shape (e, e)."""
        return self._of.inverse

    @cached_property
    def slope(self) -> np.ndarray:
        """That of the orbit it is made of, along which the parameter moves elsewhere. Shape (e, N + 1)."""
        slope = self._of.slope.copy()
        slope[:, -1] = 0.0
        return slope

    @cached_property
    def _level(self) -> np.ndarray:
        """Level of the residuals of what is eliminated."""
        return self._of._level


class Chord:
    """Residuals of what is left at points near an orbit, without derivatives: those of that orbit are used.

    What is eliminated is corrected by them, each time from where it has come to; at the orbit itself, it is
    what is known there. One chord serves one chain of points.
    """

    def __init__(self, near: Eliminated) -> None:
        self.near, self.z = near, near.z
        self.soft = near.soft if near.solved else near.soft - near.correction

    def moved(self, z: np.ndarray) -> None:
        """Go to another point, to first order. z has the shape (N + 1,)."""
        self.soft, self.z = self.soft + self.near.slope @ (z - self.z), z

    def residuals(self) -> tuple[np.ndarray, np.ndarray]:
        """Of what is left, with what is eliminated to be corrected yet, and of that. Shapes (N,) and (e,)."""
        grouping = self.near.grouping
        found = self.near.explicit.residual(grouping.joined(self.z, self.soft))
        return found[grouping.hard_rows], found[grouping.soft_rows]

    def residual(self, z: np.ndarray) -> np.ndarray:
        """Of what is left at z, that is eliminated being corrected once. Shape (N,)."""
        self.moved(z)
        hard, soft = self.residuals()
        correction = self.near.inverse @ soft
        self.soft = self.soft - correction
        return self.near.corrected(hard, correction)

    def follow(self, z: np.ndarray) -> bool:
        """Solve for what is eliminated at z, by Broyden's method, as far as it contracts.

        False where it leads nowhere. Residuals are far cheaper than the derivatives that are asked for then.

        z has the shape (N + 1,).
        """
        self.moved(z)
        steps: list[np.ndarray] = []
        before = np.inf
        while len(self.soft) and len(steps) < MOST_CHORDS:
            soft = self.residuals()[1]
            chord = -(self.near.inverse @ soft) / self.near.sizes
            steps.append(broyden_step(chord, steps))
            size, change = float(np.linalg.norm(steps[-1])), steps[-1] * self.near.sizes
            if not size <= COARSE:
                return False
            self.soft = self.soft + change
            shrinks = min(size / before, 1.0) if len(steps) > 1 else CONTRACTS
            if shrinks > CONTRACTS or shrinks * self.near.excess_of(soft) <= 1.0:
                break
            before = size
        return True


def negligible(step: float, left: float) -> bool:
    """Whether what second derivatives make of a step is small beside what is left to solve.

    At a solution of what is left it has to be solved for.
    """
    return left > NEARLY and step**2 < 0.01 * left


def reached(near: Eliminated, z: np.ndarray, roughly: bool = False) -> Eliminated | None:
    """What is eliminated at z, solved for from an orbit near it: a function of both alone.

    None where Newton's method finds none, or one that runs backwards. Solved to the level of residuals, or
    roughly: to where they are negligible beside those that are left.

    z has the shape (N + 1,).
    """
    if near.solved and np.array_equal(near.z, z):
        return near
    chord = Chord(near)
    try:
        if not chord.follow(z):
            return None
    except np.linalg.LinAlgError:
        return None
    return corrected(near.explicit, near.grouping, z, chord.soft, roughly)


def corrected(
    explicit: Kind, grouping: Grouping, z: np.ndarray, soft: np.ndarray, roughly: bool = False
) -> Eliminated[Kind] | None:
    """The explicit orbit over z; None where Newton's method finds none, or one that runs backwards.

    Residuals are solved to their level, or roughly: to where they are negligible beside those that are left.
    """
    before = np.inf
    for _ in range(MOST_CORRECTIONS):
        found = Eliminated(explicit, grouping, z, soft)
        if grouping.backward(found.unknowns[explicit.layout.durations]) or not found.finite:
            return None
        if found.solved:
            return found
        try:
            if found.step > min(COARSE, before):  # it leads nowhere: another transition comes or goes
                return None
        except np.linalg.LinAlgError:
            return None
        if roughly and negligible(found.step, found.left):
            return found
        before, soft = found.step, soft - found.correction
    return None
