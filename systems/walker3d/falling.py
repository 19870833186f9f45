"""When a walker has fallen: its hip is nearer to the slope than a leg lets it be while it walks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import bodies
from .model import Model
from .states import Q2

# Of the length of a straight leg: on every gait of the studies the hip stays above 0.95 of it.
LOWEST = 0.6


def make_fallen(model: Model) -> Callable[[Any, Any, Any], Any]:
    """`fallen(t, x, p)`: how far the hip is below its lowest height, m."""

    def fallen(t: Any, x: Any, p: Any) -> Any:
        leg = -bodies.knee(p, 1, model) - bodies.toe(p, 1, 1, model)[1]
        return LOWEST * leg - x[Q2]

    return fallen
