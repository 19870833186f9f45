"""Whether special points of two curves are one."""

from __future__ import annotations

from collections.abc import Mapping

from contwalk.special_point import SpecialPoint

# Each parameter is the same within so many times the errors of both, and this part of its unit.
ONE_PLACE, TINY = 100.0, 1e-9


def is_one(a: SpecialPoint, b: SpecialPoint, units: Mapping[str, float] | None = None) -> bool:
    """Whether two special points are of one kind and at one place.

    `units` are those of the parameters that are compared, by name; by default all are, by their own sizes.
    """
    if a.label != b.label or a.parameters.keys() != b.parameters.keys():
        return False
    if units is None:
        units = {name: max(abs(value), abs(b.parameters[name])) for name, value in a.parameters.items()}
    return all(
        abs(a.parameters[name] - b.parameters[name])
        <= ONE_PLACE * (_error(a, name) + _error(b, name)) + TINY * unit
        for name, unit in units.items()
    )


def _error(point: SpecialPoint, name: str) -> float:
    return (point.errors or {}).get(name) or 0.0
