"""Labels, numbers and units in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def exact(value: float) -> str:
    """A number with all its digits."""
    return repr(float(value))


def rough(value: float | None) -> str:
    """An error or a cost: its magnitude matters."""
    return "" if value is None or math.isnan(value) else f"{value:.1e}"


def with_unit(name: str, units: Mapping[str, str]) -> str:
    """The unit of a name; empty where it has none."""
    unit = units.get(name, "")
    return "" if unit in ("", "1") else unit


def in_brackets(unit: str) -> str:
    """A unit behind a name: ` (m)`; empty where it is none."""
    return "" if unit in ("", "1") else f" ({unit})"


def choices(model: Mapping[str, Any]) -> str:
    """Model choices: `masses=2, suspension=isotropic`."""
    return ", ".join(f"{name}={value}" for name, value in model.items())


def plural(number: int, noun: str) -> str:
    """`1 point`, `2 points`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
