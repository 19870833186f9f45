"""The unit of time that a system's own units imply."""

from __future__ import annotations

import re
from collections.abc import Iterable

TIMES = ("s", "ms", "us", "ns", "min", "h", "d", "day", "days", "yr", "year", "years")
# What is measured in these is measured in seconds too: units of the SI, of its mechanics above all.
IN_SECONDS = {
    "m",
    "mm",
    "cm",
    "km",
    "kg",
    "g",
    "N",
    "kN",
    "J",
    "kJ",
    "W",
    "kW",
    "Pa",
    "kPa",
    "MPa",
    "bar",
    "Hz",
    "K",
}


def time_unit(units: Iterable[str]) -> str:
    """The unit of time, such as `s` or `ms`; empty where none is known, as of a dimensionless system.

    A unit of time in any of the units (`rad/s`, `1/ms`) is it; else a unit of the SI means seconds. Two
    different ones tell nothing.
    """
    words = {word for unit in units for word in re.findall(r"[A-Za-z]+", unit)}
    named = [name for name in TIMES if name in words]
    if named:
        return named[0] if len(named) == 1 else ""
    return "s" if words & IN_SECONDS else ""


def lasting(seconds: float, unit: str, form: str = ".6g") -> str:
    """A duration with its unit, or without one."""
    return f"{seconds:{form}} {unit}".strip()
