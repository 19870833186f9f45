"""The record of a special point, in a line of text, and as a table for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from contwalk import tables
from contwalk.labels import EVERY_MEANING


def allowed_error(accuracy: float, value: float, error: float, magnitude: float) -> float:
    """What a relative accuracy allows a value of the free parameter that is known to `error`, absolutely.

    A value that is zero to its error has no relative error; it is compared with the parameter's magnitude.
    """
    return accuracy * (abs(value) if abs(value) > error else max(magnitude, abs(value)))


@dataclass(frozen=True, repr=False)
class SpecialPoint:
    """A special point, located or not. Fields are those of the JSON interface, plus `s` and the unknowns.

    `unstable_before` and `unstable_after` count unstable directions on both sides; None where the sign of an
    eigenvalue is not known. `mark` is what is marked at a marked value: `{"name": "max_re", "value": 0.0}`,
    its value None at an extremum.
    """

    label: str
    s: float
    kind: str | None = None
    status: str = "located"
    parameters: Mapping[str, float] = field(default_factory=dict)
    state: Mapping[str, float] = field(default_factory=dict)
    period: float | None = None
    period_full: float | None = None
    spectrum: tuple[complex, ...] = ()
    spectrum_full: tuple[complex, ...] | None = None
    trivial_error: float | None = None
    unstable_before: int | None = 0
    unstable_after: int | None = 0
    error: float | None = None
    errors: Mapping[str, float] = field(default_factory=dict)
    criticality: str | None = None
    coefficients: Mapping[str, Any] = field(default_factory=dict)
    admissible: bool = True
    margin: Mapping[str, float] = field(default_factory=dict)
    note: str | None = None
    mark: Mapping[str, Any] = field(default_factory=dict)
    unknowns: tuple[float, ...] = ()
    tangent: tuple[float, ...] = ()
    name: str = ""
    index: int = -1

    def __repr__(self) -> str:
        return f"<{told_point(self)}>"

    def _repr_html_(self) -> str:
        return tables.html("", table_of_point(self))


def told_point(point: SpecialPoint) -> str:
    """`PD1: period doubling, supercritical, located, error 3e-12`."""
    parts = [EVERY_MEANING.get(point.label, point.label), told_kind(point), point.criticality, point.status]
    error = f"error {point.error:.1e}" if point.error is not None else None
    said = ", ".join(part for part in (*parts, error) if part)
    return f"{point.name or point.label}: {said}"


def told_kind(point: SpecialPoint) -> str | None:
    """The kind in words, of a marked value what it is of: `extremum of max_re`, `max_re = 0`."""
    name, value = point.mark.get("name"), point.mark.get("value")
    if name is None or point.kind is None:
        return point.kind
    return f"{point.kind} of {name}" if value is None else f"{name} = {value:g}"


def told_what(point: SpecialPoint) -> str:
    """`branch point (pitchfork)`; one that is not located says so."""
    kind = told_kind(point)
    words = EVERY_MEANING.get(point.label, point.label) + (f" ({kind})" if kind else "")
    return words if point.status == "located" else f"{words}, NOT LOCATED"


def told_count(unstable: int | None) -> str:
    """How many directions are unstable; negative as well where it is not known."""
    return "not known" if unstable is None or unstable < 0 else str(unstable)


def told_sides(point: SpecialPoint, arrow: str = "->") -> str:
    """`0 -> 2`: unstable directions on both sides of a point."""
    return f"{told_count(point.unstable_before)} {arrow} {told_count(point.unstable_after)}"


def table_of_point(point: SpecialPoint) -> tables.Table:
    """What is known of one special point."""
    rows = [[told_point(point), ""]]
    rows += [[name, f"{value:.12g}"] for name, value in {**point.parameters, **point.state}.items()]
    if point.period is not None:
        rows.append(["period", f"{point.period:.12g}"])
    for number, value in enumerate(point.spectrum, start=1):
        text = f"{value.real:.8g}" + (f"{value.imag:+.8g}i" if value.imag else "")
        rows.append([f"eigenvalue or multiplier {number}", text])
    if point.note:
        rows.append(["note", point.note])
    return rows


def nearest_to(points: Iterable[SpecialPoint], s: float) -> SpecialPoint | None:
    """The point nearest to an arclength, as that which a branch has left; None where there is none."""
    return min(points, key=lambda point: abs(point.s - s), default=None)
