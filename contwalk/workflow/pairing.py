"""Which special point of one run is which of another run of the same study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from contwalk.branch import Branch, SpecialPoint


@dataclass
class Paired:
    """Points of a second run beside those of a first one.

    Parameters
    ----------
    values : mapping
        Name of each point of the first run, as `b2/PD1`, to the second run's value of the free parameter;
        None where it found no such point.
    extra : list of str
        Names of points that only the second run has.
    """

    values: dict[str, float | None] = field(default_factory=dict)
    extra: list[str] = field(default_factory=list)


def counted(point: SpecialPoint) -> bool:
    """Whether a point's place is a result: neither an end, nor a given value, nor unlocated."""
    given = point.label == "EP" or (point.label == "UZ" and point.kind == "parameter")
    return point.status == "located" and not given


def value_of(point: SpecialPoint) -> float:
    """The free parameter at a point."""
    return float(point.unknowns[-1])


def paired(first: Sequence[Branch], second: Sequence[Branch]) -> Paired:
    """Match points by their branches' descent, their labels, and their nearness, in this order."""
    result, children = Paired(), _children(second)
    twins: dict[tuple[str, float], tuple[str, float]] = {}  # where branches leave: first run -> second run
    taken: set[str] = set()
    for branch in first:
        key = None if branch.info.parent is None else twins.get(branch.info.parent, ("", 0.0))
        there = next((b for b in children.get(key, []) if b.name not in taken and _alike(branch, b)), None)
        if there is not None:
            taken.add(there.name)
        left = [] if there is None else [p for p in there.special_points if counted(p)]
        own = [point for point in branch.special_points if counted(point)]
        partners = _nearest_first(own, left)
        for point in own:
            found = partners.get(point.name)
            result.values[f"{branch.name}/{point.name}"] = None if found is None else value_of(found)
            if found is not None and there is not None:
                left.remove(found)
                twins[branch.name, point.s] = there.name, found.s
        if there is not None:
            result.extra += [f"{there.name}/{point.name}" for point in left]
    for branch in second:
        if branch.name not in taken:
            result.extra += [f"{branch.name}/{p.name}" for p in branch.special_points if counted(p)]
    return result


def _nearest_first(own: Sequence[SpecialPoint], others: Sequence[SpecialPoint]) -> dict[str, SpecialPoint]:
    """Partners of the points of a branch, by name: of equal label and kind, the nearest pairs first."""
    pairs = [
        (abs(value_of(a) - value_of(b)), i, j)
        for i, a in enumerate(own)
        for j, b in enumerate(others)
        if (a.label, a.kind) == (b.label, b.kind)
    ]
    result: dict[int, int] = {}
    for _, i, j in sorted(pairs):
        if i not in result and j not in result.values():
            result[i] = j
    return {own[i].name: others[j] for i, j in result.items()}


def _children(branches: Sequence[Branch]) -> dict[tuple[str, float] | None, list[Branch]]:
    """Branches by the place that they leave; starts under None."""
    result: dict[tuple[str, float] | None, list[Branch]] = {}
    for branch in branches:
        result.setdefault(branch.info.parent, []).append(branch)
    return result


def _alike(a: Branch, b: Branch) -> bool:
    """Whether two branches may be the same one: of one kind, from one start, at the same fixed parameters.

    Other models may have other parameters: those count that both have.
    """
    fixed = [name for name in a.info.parameters if name not in a.info.free and name in b.info.parameters]
    equal = all(a.info.parameters[name] == b.info.parameters[name] for name in fixed)
    started = a.info.parent is not None or a.info.origin == b.info.origin
    return a.info.problem == b.info.problem and a.info.closure == b.info.closure and equal and started
