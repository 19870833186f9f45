"""What is remembered of one discretisation of an orbit: a new discretisation begins with an empty one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from contwalk.memory import remembered

Value = TypeVar("Value")


class Evaluations:
    """Solutions that were looked at lately, each by what was computed of it."""

    def __init__(self) -> None:
        self._at: dict[str, dict[bytes, Any]] = {}
        self._once: dict[str, Any] = {}
        self._on: dict[str, tuple[object, Any]] = {}

    def at(self, what: str, z: np.ndarray, most: int, make: Callable[[], Value]) -> Value:
        """What is known of a solution; made if nothing is, and kept in place of the oldest of `most`.

        z has the shape (N + 1,).
        """
        return remembered(self._at.setdefault(what, {}), z.tobytes(), most, make)

    def found(self, what: str, z: np.ndarray) -> Any:
        """What is known of a solution, or None; nothing is made. z has the shape (N + 1,)."""
        return self._at.get(what, {}).get(z.tobytes())

    def on(self, steps: object, what: str, make: Callable[[], Value]) -> Value:
        """What belongs to the steps, with all that is measured of them, made when it is first asked for."""
        known = self._on.get(what)
        if known is None or known[0] is not steps:
            known = self._on[what] = steps, make()
        value: Value = known[1]
        return value

    def once(self, what: str, make: Callable[[], Value]) -> Value:
        """What belongs to the discretisation itself, made when it is first asked for."""
        if what not in self._once:
            self._once[what] = make()
        value: Value = self._once[what]
        return value
