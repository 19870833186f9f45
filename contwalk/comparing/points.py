"""Special points and ends of two databases, paired by label and place, and compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.comparing.curve import Curve
from contwalk.comparing.difference import (
    ADMISSIBILITY,
    CRITICALITY,
    END,
    KIND,
    STABILITY,
    VALUE,
    Difference,
    apart,
)
from contwalk.labels import END as END_POINT
from contwalk.labels import EVERY_MEANING

# Points of one label this near, in parts of the branch's range, are one; farther ones are two.
ONE_POINT = 0.05
# At these a margin is zero, and which side of it a point is told on is rounding.
ON_BORDER = ("AZ", "BE", "GR", "OC")
LOCATED = "located"


@dataclass(frozen=True)
class Stored:
    """A special point and the curve that it lies on."""

    curve: Curve
    point: SpecialPoint

    @property
    def name(self) -> str:
        """`b1/PD1`."""
        return f"{self.curve.branch.name}/{self.point.name}"

    @property
    def place(self) -> np.ndarray:
        """Its row's columns in ranges, shape (number of names,)."""
        return self.curve.values[self.point.index] / self.curve.scale

    def value(self, name: str) -> float:
        """A free parameter."""
        branch = self.curve.branch
        return float(self.point.parameters.get(name, branch[name][self.point.index]))

    def claim(self, name: str) -> float:
        """The claimed error of a free parameter; that of an end that nothing locates is the last step."""
        free = self.curve.branch.info.free
        claim = self.point.error if name == free[0] else self.point.errors.get(name)
        if self.by_steps:
            claim = None
        if claim is not None and np.isfinite(claim):
            return float(claim)
        node = self.curve.node_of[self.point.index]
        values = self.curve.branch[name][self.curve.rows]
        steps = np.abs(np.diff(values))[max(node - 1, 0) : node + 1]
        return float(np.max(steps, initial=0.0))

    @property
    def by_steps(self) -> bool:
        """Whether it is an end that no equations locate: the last row, wherever the steps have led."""
        point = self.point
        ordinary = not bool(self.curve.branch.points["special"][point.index])
        return point.label == END_POINT and point.kind != "bound" and ordinary

    @property
    def kind(self) -> tuple[object, ...]:
        """What points have in common that can be the same."""
        mark = self.point.mark or {}
        return self.point.label, mark.get("name"), mark.get("value")

    def told(self) -> str:
        """`b1/PD1 (period doubling, delta = 0.0032)`."""
        words = EVERY_MEANING.get(self.point.label, self.point.label)
        words += f" {self.point.kind}" if self.point.kind else ""
        free = self.curve.branch.info.free
        return f"{self.name} ({words}, {', '.join(f'{n} = {self.value(n):.12g}' for n in free)})"


def stored(curves: Sequence[Curve]) -> list[Stored]:
    """All special points of some branches."""
    return [Stored(curve, point) for curve in curves for point in curve.branch.special_points]


def paired(
    a: Sequence[Stored], b: Sequence[Stored], in_order: bool
) -> tuple[list[tuple[Stored, Stored]], list[Stored], list[Stored]]:
    """Points that are one, the nearest first, or `in_order` along the branch; and those without a partner."""
    left, right = list(a), list(b)
    found = []
    if in_order:
        for one in a:
            other = next((each for each in right if each.kind == one.kind), None)
            if other is not None:
                found.append((one, other))
                left.remove(one)
                right.remove(other)
        return found, left, right
    distances = sorted(
        (float(np.linalg.norm(one.place - other.place)), i, j)
        for i, one in enumerate(a)
        for j, other in enumerate(b)
        if one.kind == other.kind
    )
    for distance, i, j in distances:
        if distance <= ONE_POINT and a[i] in left and b[j] in right:
            found.append((a[i], b[j]))
            left.remove(a[i])
            right.remove(b[j])
    return sorted(found, key=lambda pair: a.index(pair[0])), left, right


def compared(a: Stored, b: Stored) -> Iterator[Difference]:
    """What differs between two versions of a special point."""
    for name in a.curve.branch.info.free:
        one, other = a.value(name), b.value(name)
        allowed = a.claim(name) + b.claim(name) + 4.0 * np.finfo(float).eps * max(abs(one), abs(other))
        if abs(one - other) > allowed:
            far = apart(abs(one - other), allowed)
            text = f"{a.told()} in A is at {name} = {one:.15g}, {b.name} in B at {other:.15g}: {far}."
            told = abs(one - other), allowed
            yield Difference(VALUE, text, a.name, b.name, name, one, other, *told)
    if a.point.status != b.point.status:
        text = f"{a.told()} is {_status(a)} in A and {_status(b)} in B."
        yield Difference(KIND, text, a.name, b.name)
    if a.point.kind != b.point.kind:
        what = END if a.point.label == END_POINT else KIND
        text = f"{a.told()} in A is of the kind {_word(a.point.kind)}, {b.name} in B {_word(b.point.kind)}."
        yield Difference(what, text, a.name, b.name)
    if a.point.criticality != b.point.criticality:
        text = f"{a.told()} is {_word(a.point.criticality)} in A and {_word(b.point.criticality)} in B."
        yield Difference(CRITICALITY, text, a.name, b.name)
    yield from _sides(a, b)
    yield from _states(a, b)


def _status(each: Stored) -> str:
    return LOCATED if each.point.status == LOCATED else "not located"


def _word(text: str | None) -> str:
    return "not told" if text is None else text


def _sides(a: Stored, b: Stored) -> Iterator[Difference]:
    """Counts of unstable directions on both sides, whichever way the branches were walked."""
    if a.point.label == END_POINT:
        return
    one, other = (
        (a.point.unstable_before, a.point.unstable_after),
        (
            b.point.unstable_before,
            b.point.unstable_after,
        ),
    )
    ways = a.curve.way(a.curve.node_of[a.point.index]), b.curve.way(b.curve.node_of[b.point.index])
    if float(ways[0] @ ways[1]) < 0.0:
        other = other[::-1]
    if any(None not in side and side[0] != side[1] for side in zip(one, other, strict=True)):
        text = (
            f"{a.told()}: {one[0]} unstable before and {one[1]} after it in A, "
            f"{other[0]} and {other[1]} in B."
        )
        yield Difference(STABILITY, text, a.name, b.name)
    if a.point.label not in ON_BORDER and a.point.admissible != b.point.admissible:
        words = ["admissible" if each.point.admissible else "not admissible" for each in (a, b)]
        text = f"{a.told()} is {words[0]} in A and {words[1]} in B."
        yield Difference(ADMISSIBILITY, text, a.name, b.name)


def _states(a: Stored, b: Stored) -> Iterator[Difference]:
    """Stored states and periods: those of both rows' errors, and what the parameters' errors allow."""
    if a.by_steps or b.by_steps:
        return
    drift = _drift(a) + _drift(b)
    for column, name in enumerate(a.curve.names):
        if name in a.curve.branch.info.free or column >= len(drift):
            continue
        pair = [_of_record(each, name) for each in (a, b)]
        if any(value is None for value in pair):
            continue
        one, other = (float(value) for value in pair if value is not None)
        claims = [each.curve.claims[each.point.index][column] for each in (a, b)]
        allowed = float(sum(claims) + drift[column])
        if abs(one - other) > allowed:
            far = apart(abs(one - other), allowed)
            text = f"{a.told()}: {name} = {one:.12g} in A and {other:.12g} in B, {far}."
            told = abs(one - other), allowed
            yield Difference(VALUE, text, a.name, b.name, name, one, other, *told)


def _of_record(each: Stored, name: str) -> float | None:
    """A value as the point's own record has it."""
    if name == "period":
        return each.point.period
    return each.point.state.get(name)


def _drift(each: Stored) -> np.ndarray:
    """How far each column may be off along the branch, where parameters are known to their errors."""
    curve, node = each.curve, each.curve.node_of[each.point.index]
    if len(curve) < 3:
        return np.full(len(curve.names), np.inf)
    middle = int(np.clip(node, 1, len(curve) - 2))
    t, values = curve.t[middle - 1 : middle + 2], curve.values[curve.rows[middle - 1 : middle + 2]]
    low, high = t[1] - t[0], t[2] - t[1]
    chords = (values[1] - values[0]) / low, (values[2] - values[1]) / high
    second = 2.0 * (chords[1] - chords[0]) / (low + high)
    slope = (chords[0] * high + chords[1] * low) / (low + high) + second * (curve.t[node] - t[1])
    way = np.inf
    for name in curve.branch.info.free:
        column, claim = curve.names.index(name), each.claim(name)
        rate, bend = abs(slope[column]), abs(second[column])
        straight = claim / rate if rate > 0.0 else np.inf
        turning = (2.0 * claim / bend) ** 0.5 if bend > 0.0 else np.inf
        way = min(way, straight, turning)
    # Slopes between rows are those of the point to the bend between them.
    return np.asarray((np.abs(slope) + np.abs(second) * max(low, high)) * way)
