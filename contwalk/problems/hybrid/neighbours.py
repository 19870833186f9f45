"""Neighbour words."""

from __future__ import annotations

from typing import Any


def found(problem: Any, point: Any) -> Any:
    """Not yet."""
    return (), "Not yet."
