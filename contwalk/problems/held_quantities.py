"""Conserved quantities that are held at their values, so that equilibria are alone.

Where a machine conserves C(x) with a slope at its equilibria, as a network of reactions conserves totals,
these come in families, one for each value: C' f = 0 makes df/dx singular at all of them. The equations are

    f(x, p) + a grad C = 0,    C(x, p) = c,

with one unknown a more, which is zero at a solution: grad C . f = 0. The left vector of the eigenvalue zero
is grad C, and the others are those of df/dx at a right angle to it. An energy has no slope at an equilibrium,
which is alone already.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.fields.derivative import jacobian
from contwalk.fields.expression import Expression
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer
from contwalk.memory import memory_of, remembered
from contwalk.system import Conserved, Neutral, System
from contwalk.system.declarations import ParameterValues

# A slope times df/dx is zero below this part of its terms.
NEUTRAL = 1e-12
# As many quantities are remembered of a system.
MOST = 64


@dataclass(frozen=True, eq=False)
class HeldQuantity(Neutral):
    """A quantity that is held at its value; its gradient is the direction of the drift."""

    quantity: Conserved | None = None

    def held(
        self, tracer: Tracer, mode: str, x: np.ndarray, p: ParameterValues, drift: Any
    ) -> tuple[list[Any], Any]:
        """What holding it adds to the field, an entry for each state, and by how much it misses its value."""
        assert self.quantity is not None
        value = rebound(self.quantity.of(mode))(0.0, x, p)
        added: list[Any] = [0.0] * len(x)
        if isinstance(value, Expression):
            slopes = jacobian(tracer.graph, [value.node], [entry.node for entry in x])[0]
            for i, node in slopes.items():
                added[i] = drift * value.wrap(node)
        return added, value - getattr(p, self.name)


def held_quantity(system: System, name: str) -> HeldQuantity:
    """The pin of a conserved quantity, the same object each time."""

    def made() -> HeldQuantity:
        number = system.conserved_names.index(name)
        mode = system.modes[0].name

        def generator(t: float, x: np.ndarray, p: ParameterValues, v: np.ndarray) -> None:
            from contwalk.problems.conserving import gradients_of  # compiled functions

            values = {known: getattr(p, known) for known in system.parameter_names}
            v[:] = gradients_of(system, mode, np.asarray(x, dtype=float), values)[number]

        return HeldQuantity(name, generator, quantity=system.conserved[number])

    found: HeldQuantity = remembered(memory_of(system, "held quantities"), name, MOST, made)
    return found


def sloping(
    system: System, x: np.ndarray, parameters: dict[str, float], matrix: np.ndarray, free: str = ""
) -> list[HeldQuantity]:
    """The conserved quantities whose slopes make df/dx, shape (n, n), singular at a state, shape (n,).

    One that depends there on others is left out; not the free one, where one is free.
    """
    if not system.conserved:
        return []
    from contwalk.problems.conserving import gradients_of  # compiled functions

    found, basis = list[HeldQuantity](), np.zeros((len(x), 0))
    gradients = gradients_of(system, system.modes[0].name, x, parameters)
    each = sorted(zip(system.conserved, gradients, strict=True), key=lambda pair: pair[0].name != free)
    for quantity, slope in each:
        size = float(np.linalg.norm(slope))
        if not (np.isfinite(size) and size > 0.0):
            continue
        if np.abs(slope @ matrix).max() > NEUTRAL * (np.abs(slope) @ np.abs(matrix)).max():
            continue
        rest = slope / size - basis @ (basis.T @ (slope / size))
        if np.linalg.norm(rest) > 1e-6:
            basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
            found.append(held_quantity(system, quantity.name))
    return found
