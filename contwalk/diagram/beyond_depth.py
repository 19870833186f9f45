"""What a diagram did not follow because its generations have come to their end, in one sentence."""

from __future__ import annotations

from collections.abc import Iterable

from contwalk.diagram.one_place import is_one
from contwalk.special_point import SpecialPoint


class BeyondDepth:
    """Points that branches of the last generation lead away from, against those that were followed.

    A point that lies on two curves was followed if it was from either.
    """

    def __init__(self, depth: int) -> None:
        self._depth = depth
        self._followed: list[SpecialPoint] = []
        self._left: list[tuple[str, SpecialPoint]] = []

    def tell(self, branch: str, points: Iterable[SpecialPoint], depth: int) -> None:
        """Points of a branch of this generation that others leave."""
        for point in points:
            if depth < self._depth:
                self._followed.append(point)
            elif not any(is_one(point, other) for _, other in self._left):
                self._left.append((f"{branch}/{point.name}", point))

    def sentence(self) -> str | None:
        """What is missing, or None where nothing is."""
        names = [
            name for name, point in self._left if not any(is_one(point, other) for other in self._followed)
        ]
        if not names:
            return None
        return (
            f"What begins or crosses at {', '.join(names)} was not followed from there: "
            f"the generations of curves end with `diagram.depth` = {self._depth}. Raise it to follow them."
        )
