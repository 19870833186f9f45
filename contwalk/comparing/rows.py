"""Rows of one branch against those of another: are they there, and do stability and admissibility agree."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.comparing.curve import AT_NODE, Curve, Foot, from_border
from contwalk.comparing.difference import ADMISSIBILITY, ROWS, STABILITY, VALUE, Difference, apart
from contwalk.labels import UNDECIDED


@dataclass(frozen=True)
class Met:
    """A row and its foot on the nearest curve of the other database; `curve` is None where it is on none."""

    row: int
    curve: Curve | None
    foot: Foot


def met(own: Curve, others: Sequence[Curve]) -> list[Met]:
    """Each node of a curve on the curves of the other database."""
    found = []
    for row in own.rows:
        place = own.values[row]
        near = [other for other in others if len(others) > 1 and other.may_hold(place)] or others
        feet = [(other, other.foot(place)) for other in near]
        curve, foot = min(feet, key=lambda each: (not each[1].on, each[1].distance))
        beside = foot.on or foot.beyond > 0.0
        found.append(Met(int(row), curve if beside else None, foot))
    return found


def absent(own: Curve, places: Sequence[Met], side: str) -> Iterator[Difference]:
    """Stretches of rows that the other database has not, beyond the last step before its ends."""

    def missing(place: Met) -> bool:
        return place.curve is None or place.foot.beyond > 1.0

    for gone, run in groupby(places, missing):
        if gone:
            rows = [place.row for place in run]
            other = "B" if side == "A" else "A"
            text = f"{told_rows(own, rows)} of {own.branch.name} in {side} lie on no such branch of {other}."
            yield _placed(Difference(ROWS, text), own, None, side)


def moved(own: Curve, places: Sequence[Met], side: str) -> Iterator[Difference]:
    """Rows beside the other curve by more than is allowed; the worst of each column."""
    worst: dict[str, tuple[float, Difference]] = {}
    lead = from_lead(own)
    for place in places:
        if place.curve is None or place.foot.beyond > 0.0 or not place.foot.on:
            continue
        curve, foot, row = place.curve, place.foot, place.row
        unsure = curve.unsure(own.claims[row], foot.segment)
        there, spread = curve.at(curve.values[curve.rows], foot.segment, foot.t, unsure)
        allowed = own.claims[row] + curve.claims_at(foot.segment) + spread
        gap = np.abs(own.values[row] - there)
        checks = list(zip(own.names, own.values[row], there, gap, allowed, strict=True))
        checks += _leads(lead, curve, foot, row, unsure)
        for name, value, other, difference, most in checks:
            if not difference > most:
                continue
            times = difference / most if most > 0.0 else np.inf
            if name not in worst or times > worst[name][0]:
                text = (
                    f"Row {row} of {own.branch.name} in {side}: {name} = {value:.12g}, and {other:.12g} on "
                    f"{curve.branch.name} there; {apart(difference, most)}."
                )
                told = Difference(
                    VALUE, text, quantity=name, difference=float(difference), allowed=float(most)
                )
                worst[name] = times, _placed(told, own, curve, side, (float(value), float(other)))
    yield from (difference for _, difference in worst.values())


def from_lead(curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """The leading eigenvalue's measure of each row, and its claimed error, both of shape (k,)."""
    return curve.all_leads, curve.branch.points["spectrum_error"]


def _leads(
    own: tuple[np.ndarray, np.ndarray], curve: Curve, foot: Foot, row: int, unsure: float
) -> list[tuple[str, float, float, float, float]]:
    value, claim = own[0][row], own[1][row]
    there, spread = curve.at(curve.lead, foot.segment, foot.t, unsure)
    claims = from_lead(curve)[1][curve.rows[[foot.segment, min(foot.segment + 1, len(curve) - 1)]]]
    most = claim + float(np.max(claims)) + float(spread)
    gap = abs(float(value) - float(there))
    if not (np.isfinite(most) and np.isfinite(gap)):
        return []
    return [("leading eigenvalue", float(value), float(there), gap, most)]


# -- stability and admissibility -----------------------------------------------------------------------------


def turned(own: Curve, places: Sequence[Met], side: str) -> Iterator[Difference]:
    """Stretches of rows whose stability or admissibility the other database tells otherwise."""
    near, known = from_border(own.branch), own.branch["unstable"] >= 0
    stability = (STABILITY, _stability, _beside_point)
    admissibility = (ADMISSIBILITY, _admissibility, _nothing_beside)
    for what, of_row, of_point in (stability, admissibility):
        found = []
        for place in places:
            # What is not known is not told otherwise.
            unsure = what == STABILITY and not (near[place.row] > 0.0 and known[place.row])
            expected = set() if unsure else _expected(own, place, of_row, of_point)
            expected = set() if UNDECIDED in expected else expected
            said = of_row(own, place.row)
            regular = not own.special_nodes[own.node_of[place.row]]
            found.append(
                (place, said, frozenset(expected) if regular and said not in expected else frozenset())
            )
        for (said, expected), run in groupby(found, lambda each: each[1:]):
            if not expected:
                continue
            rows = [each[0].row for each in run]
            curve = next(each.curve for each in places if each.row == rows[0])
            other = "B" if side == "A" else "A"
            text = (
                f"{told_rows(own, rows)} of {own.branch.name}: {said} in {side}, "
                f"{' or '.join(sorted(expected))} in {other}."
            )
            yield _placed(Difference(what, text), own, curve, side)


def _expected(
    own: Curve,
    place: Met,
    of_row: Callable[[Curve, int], str],
    of_point: Callable[[Curve, int, bool], str | None],
) -> set[str]:
    """What the other database says of a place; several things where a border lies within errors of it."""
    curve, foot = place.curve, place.foot
    if curve is None or foot.beyond > 0.0 or not foot.on:
        return set()
    if len(curve) == 1:
        return {of_row(curve, 0)}
    found: set[str | None] = set()
    left, right = foot.segment, foot.segment + 1
    for node in (left, right):
        if curve.special_nodes[node]:
            found.add(of_point(curve, node, node == left))
            if abs(curve.t[node] - foot.t) <= _uncertainty(own, place.row, curve, node):
                return set()
        elif abs(curve.t[node] - foot.t) <= AT_NODE * curve.lengths[left]:
            return {of_row(curve, int(curve.rows[node]))}
        else:
            found.add(of_row(curve, int(curve.rows[node])))
    return {each for each in found if each is not None}


def _uncertainty(own: Curve, row: int, curve: Curve, node: int) -> float:
    """How far along the curve a special point and a row may be from where they stand."""
    there = np.nan_to_num(curve.claims[curve.rows[node]], nan=0.0)
    claims = np.nan_to_num(own.claims[row], nan=0.0) + there
    errors = [
        (point.error or 0.0) / float(curve.scale[curve.names.index(curve.branch.info.free[0])])
        for point in curve.points_at(node)
    ]
    # A parameter that turns tells a place along the curve to the root of its error.
    return float(np.linalg.norm(claims / curve.scale)) + max((max(e, e**0.5) for e in errors), default=0.0)


def _stability(curve: Curve, row: int) -> str:
    point = curve.branch.points[row]
    return told_stability(int(curve.branch["unstable"][row]), bool(point["stable"] == 1))


def told_stability(unstable: int, stable: bool) -> str:
    """`stable`, `2 unstable directions`, or what is neither."""
    if unstable > 0:
        return f"{unstable} unstable direction{'' if unstable == 1 else 's'}"
    if unstable < 0:
        return UNDECIDED
    return "stable" if stable else "not stable, no unstable direction"


def _admissibility(curve: Curve, row: int) -> str:
    return "admissible" if bool(curve.branch.points["admissible"][row]) else "not admissible"


def _beside_point(curve: Curve, node: int, after: bool) -> str | None:
    """What a special point says of the rows behind or before it."""
    points: list[SpecialPoint] = curve.points_at(node)
    if not points:
        return None
    count = points[-1].unstable_after if after else points[0].unstable_before
    return told_stability(count, True) if count else None


def _nothing_beside(curve: Curve, node: int, after: bool) -> None:
    """A special point does not say which side of it is admissible."""


def told_rows(curve: Curve, rows: Sequence[int]) -> str:
    """`Rows 4 to 9 (delta from 0.003 to 0.0035)`."""
    free = curve.branch.info.free[0]
    values = curve.branch[free][list(rows)]
    if len(rows) == 1:
        return f"Row {rows[0]} ({free} = {values[0]:.9g})"
    return f"Rows {rows[0]} to {rows[-1]} ({free} from {values[0]:.9g} to {values[-1]:.9g})"


def _placed(
    told: Difference, own: Curve, other: Curve | None, side: str, values: Any = (None, None)
) -> Difference:
    """A difference with the names and values of A first."""
    names = own.branch.name, other.branch.name if other is not None else ""
    if side == "B":
        names, values = names[::-1], values[::-1]
    return replace(told, a=names[0], b=names[1], value_a=values[0], value_b=values[1])
