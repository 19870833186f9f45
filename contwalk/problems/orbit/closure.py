"""How an orbit closes: onto itself, or onto its image under a declared symmetry.

An orbit x closes up to the symmetry S of order q after the q-th part of its period: S x(T) = x(0). Its
motion over the whole period consists of q images of that piece, so that a q-th of it needs to be
integrated (the thesis's equation 44 is the case q = 2). Angles may turn: `turns` says by how many of its
own periods each state grows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow import Field
from contwalk.problems.images import imaged
from contwalk.problems.mapping import mapped
from contwalk.problems.orbit.motion import DIRECTIONS, STATES, Motion, lifted
from contwalk.problems.tracing import state_symbols
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

MOST_FOLD = 24


@dataclass(frozen=True, eq=False)
class Closure:
    """The map that takes the end of the integrated piece to its beginning.

    Parameters
    ----------
    motion : Motion
    turns : ndarray, shape (n,)
        What a state has grown by, in its own units, when the orbit closes.
    symmetry : Symmetry, optional
        The symmetry up to which it closes; `power` of it is applied.
    fold : int
        The integrated piece is this part of the period.
    """

    motion: Motion
    turns: np.ndarray
    symmetry: Symmetry | None = None
    power: int = 1
    fold: int = 1

    @property
    def name(self) -> str:
        """`full`, or the symmetry's name."""
        return "full" if self.symmetry is None else self.symmetry.name

    @cached_property
    def _program(self) -> Program:
        assert self.symmetry is not None
        copy, motion, power = rebound(self.symmetry.map), self.motion, self.power

        def image(tracer: Tracer) -> list:
            p = motion.parameters(tracer)
            x = state_symbols(tracer, motion.states)
            for _ in range(power):
                out = np.full(motion.states, 0.0, dtype=object)
                copy(motion.duration(tracer, p), x, p, out)
                x = out
            return list(x)

        return trace(image)

    def _map(self, lift: str) -> Field:
        key = f"_{lift}_map"
        if key not in self.__dict__:
            motion = self.motion
            states = [(group, i) for group in STATES[lift] for i in range(motion.states)]
            groups = {**motion.groups, **{group: len(motion.columns) for group in DIRECTIONS[lift]}}
            program = lifted(self._program, motion.states, motion.columns, lift)
            self.__dict__[key] = Field(program, states, groups, motion.columns, time=("t", 0))
        return self.__dict__[key]

    def end(self, lift: str, y: np.ndarray, values: np.ndarray) -> np.ndarray:
        """The closed end of a lift's states; `values` are what the lift's field depends on."""
        if self.symmetry is not None:
            field = self._map(lift)
            y = field(1.0, y, field.constants(values))
        return self._turned_back(y)

    def end_with_columns(
        self, lift: str, y: np.ndarray, columns: np.ndarray, sources: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `end`, with derivatives; `sources` tells which column of scalars drives each, -1 for none."""
        if self.symmetry is not None:
            field = self._map(lift)
            c = field.constants(values)
            derivative = field.jacobian(1.0, y, c)
            y = field(1.0, y, c)
            columns = derivative[:, : len(y)] @ columns
            driven = sources >= 0
            columns[:, driven] += derivative[:, len(y) :][:, sources[driven]]
        return self._turned_back(y), columns

    def _turned_back(self, y: np.ndarray) -> np.ndarray:
        if np.any(self.turns):
            y = y.copy()
            y[: len(self.turns)] -= self.turns
        return y

    def images(self, x: np.ndarray, parameters: ParameterValues) -> list[np.ndarray]:
        """Pieces of the whole motion in the order of time, from the integrated one, each of shape (k, n)."""
        return [self.image(x, parameters, j) for j in range(self.fold)]

    def image(self, x: np.ndarray, parameters: ParameterValues, number: int) -> np.ndarray:
        """One piece of the whole motion, from the integrated one, which is number 0."""
        # S x(T) = x(0): the next piece is the inverse image
        return images_of(self.symmetry, x, parameters, (self.power * (self.fold - number)) % self.fold)


def images_of(
    symmetry: Symmetry | None, states: np.ndarray, parameters: ParameterValues, power: int = 1
) -> np.ndarray:
    """Images of many states, shape (k, n): all at once where the map allows it."""
    for _ in range(power if symmetry is not None else 0):
        states = mapped(f"symmetry '{symmetry.name}'", symmetry.map, states, parameters)  # type: ignore[union-attr]
    return states


def order_of(symmetry: Symmetry, x: np.ndarray, parameters: ParameterValues) -> int | None:
    """The smallest q with S^q = identity, tried at a state; None if there is none up to `MOST_FOLD`."""
    generic = x + (1.0 + np.abs(x)) * np.cos(np.arange(1.0, len(x) + 1.0))
    image = generic
    for q in range(1, MOST_FOLD + 1):
        image = imaged(symmetry, image, parameters)
        if np.allclose(image, generic, rtol=1e-10, atol=1e-12):
            return q
    return None
