"""The balanced state in closed form: no displacement, the masses cancel the load (equations 11, 12, 45-48).

It is an equilibrium on an isotropic suspension. On an anisotropic one it is a constant solution, with the
same angles in the rotor (equations 31 to 34).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from contwalk.system import Start

# A load that equals the capacity on paper may exceed it by a few roundings of the products.
ROUNDING = 1e-15

_BALANCED_EXISTS = {
    1: "where |m e| = m1 l1",
    2: "where |m e| <= 2 m1 l1",
    3: "where |m e + m1 l1 (exp(i angle3) + ...)| <= 2 m1 l1: masses 1 and 2 must make up "
    "for the load and the held masses",
}


def make_balanced(n: int) -> Start:
    """The balanced state of the autobalancer with n masses."""
    return Start("balanced", _balanced(n), about="type 1: no vibration", exists=_BALANCED_EXISTS[min(n, 3)])


def state(n: int, q: complex, angles: list[float]) -> list[float]:
    """A state with this displacement and these angles, at rest."""
    return [q.real, q.imag, *angles, *[0.0] * (n + 2)]


def _balanced(n: int) -> Callable[..., list[list[float]]]:
    """Masses 3..n at the angles angle3.., masses 1 and 2 against what is left: equations 11, 12, 45-48."""

    def one_mass(p: Any) -> list[list[float]]:
        moment = p.m1 * p.l1
        if abs(abs(p.m * p.e) - moment) > ROUNDING * moment:
            return []
        return [state(1, 0j, [math.pi if p.m * p.e >= 0.0 else 0.0])]

    def states(p: Any) -> list[list[float]]:
        moment = p.m1 * p.l1
        held = [getattr(p, f"angle{i}") for i in range(3, n + 1)]
        if held:
            along = p.m * p.e + moment * math.fsum(math.cos(angle) for angle in held)
            across = moment * math.fsum(math.sin(angle) for angle in held)
            load, direction = math.hypot(along, across), math.atan2(across, along)
        else:
            # Signed, so that the angles pass smoothly through zero load.
            load, direction = p.m * p.e, 0.0
        capacity = 2.0 * moment
        if abs(load) > capacity * (1.0 + n * ROUNDING):
            return []
        # acos(load / capacity), without its loss of digits near full load.
        aside = math.atan2(math.sqrt(max(capacity - load, 0.0) * max(capacity + load, 0.0)), load)
        angles = [direction + math.pi - aside, direction + math.pi + aside, *held]
        return [state(n, 0j, angles)]

    return one_mass if n == 1 else states
