"""One stored point of a branch, and its special points by number or by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, SupportsIndex, overload

from contwalk.special_point import SpecialPoint


class StoredPoint:
    """A point of a branch: `point["x"]` is what `branch["x"]` has there.

    Parameters
    ----------
    branch : Branch
    row : int
        Its number, from 0.
    """

    def __init__(self, branch: Any, row: int) -> None:
        self.branch, self.row = branch, row

    def __getitem__(self, name: str) -> Any:
        return self.branch[name][self.row]

    def keys(self) -> Iterator[str]:
        """Names of what is one number a point: free parameters, states, observables and columns."""
        return iter(self.branch.columns())

    def __repr__(self) -> str:
        info = self.branch.info
        values = ", ".join(f"{name} = {float(self[name]):.6g}" for name in (*info.free, *info.states))
        stable = {1: "stable", 0: "unstable"}.get(int(self["stable"]), "stability not known")
        return f"<{info.name}/{self.row}: {values}; {stable}>"


class SpecialPoints(list[SpecialPoint]):
    """Special points in their order: by number, by slice, or by name, as `special_points["HB1"]`."""

    def __init__(self, points: Iterable[SpecialPoint] = ()) -> None:
        super().__init__(points)

    @overload
    def __getitem__(self, key: SupportsIndex) -> SpecialPoint: ...

    @overload
    def __getitem__(self, key: str) -> SpecialPoint: ...

    @overload
    def __getitem__(self, key: slice) -> list[SpecialPoint]: ...

    def __getitem__(self, key: Any) -> Any:
        if not isinstance(key, str):
            return super().__getitem__(key)
        for point in self:
            if point.name == key:
                return point
        known = ", ".join(point.name for point in self)
        raise KeyError(f"There is no special point '{key}'. Known: {known or 'none'}.")
