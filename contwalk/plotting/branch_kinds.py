"""What branches are, in a word or two for a legend: equilibrium, period 1, period 2."""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.branch import Branch
from contwalk.signatures import told_problem
from contwalk.special_point import SpecialPoint, nearest_to

DOUBLING = "PD"


def kinds_of(branches: Sequence[Branch]) -> list[str]:
    """What each branch is, where they differ in it; else nothing.

    An orbit is told by its period, in periods of the first orbits that led to it by period doublings.

    Parameters
    ----------
    branches : sequence of Branch
        A branch whose parent is not among them is taken for a first one.
    """
    by_name = {branch.info.name: branch for branch in branches}
    if len(by_name) < len(branches):  # of several runs
        return []
    kinds = [_kind_of(branch, by_name) for branch in branches]
    return kinds if len(set(kinds)) > 1 else []


def _kind_of(branch: Branch, by_name: dict[str, Branch]) -> str:
    info = branch.info
    orbit = info.problem_by_name not in ("equilibrium", "locus")
    return f"period {_periods(branch, by_name)}" if orbit else told_problem(info.problem_by_name)


def _periods(branch: Branch, by_name: dict[str, Branch]) -> int:
    """How many periods of the first orbit a period is."""
    doublings = 0
    while (point := _born_at(branch, by_name)) is not None and branch.info.parent is not None:
        doublings += point.label == DOUBLING
        branch = by_name[branch.info.parent[0]]
    return int(branch.info.subharmonic * 2**doublings)


def _born_at(branch: Branch, by_name: dict[str, Branch]) -> SpecialPoint | None:
    """The special point of its parent that a branch was born at, if the parent is there."""
    if branch.info.parent is None or branch.info.parent[0] not in by_name:
        return None
    name, s = branch.info.parent
    return nearest_to(by_name[name].special_points, s)
