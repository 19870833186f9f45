"""Clearance of a swinging foot where scuffing is disregarded.

The clearance of a toe dips twice in a swing: behind the standing foot, and in front of it before the knee
has locked. Each dip has its own guard: the height of the toe, lifted in the other half of the swing so as
not to see the other dip. Where a guard touches zero, a real walker would begin to scuff.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .bodies import knee
from .model import Model
from .motion import toe_place
from .states import LEGS

# How strongly a guard is lifted in the half that is not its own. It shifts no zero in its own half.
LIFT = 10.0


def make_dips(leg: int, toe: int, model: Model) -> dict[str, Callable[[Any, Any, Any], Any]]:
    """Guards of both dips of a toe."""
    other = next(number for number in LEGS if number != leg)

    def clearance(x: Any, p: Any) -> tuple[Any, Any, Any]:
        _, height, ahead = toe_place(x, p, leg, toe, model)
        _, _, standing = toe_place(x, p, other, toe, model)
        return height, ahead - standing, -knee(p, leg, model)

    def hind_dip(t: Any, x: Any, p: Any) -> Any:
        height, ahead, length = clearance(x, p)
        other_half = max(ahead, 0.0)
        return height + LIFT * other_half * other_half / length

    def front_dip(t: Any, x: Any, p: Any) -> Any:
        height, ahead, length = clearance(x, p)
        other_half = min(ahead, 0.0)
        return height + LIFT * other_half * other_half / length

    return {"hind_dip": hind_dip, "front_dip": front_dip}
