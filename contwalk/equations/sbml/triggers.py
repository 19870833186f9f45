"""Where a condition begins to hold, as what passes zero there."""

from __future__ import annotations

from collections.abc import Callable

from contwalk.equations.nodes import RELATIONS, ModelError, Node, node, number

_SIDES: dict[str, Callable[[Node, Node], tuple[Node, str]]] = {
    ">": lambda a, b: (a, "rising"),
    "<": lambda a, b: (a, "falling"),
}


def guard_of(root: Node) -> tuple[Node, str]:
    """What passes zero where a condition begins to hold, and in which direction.

    Raises
    ------
    ModelError
        If the condition is no comparison of sizes, nor made of such.
    """
    if root.kind in RELATIONS and root.kind[0] in _SIDES:
        left, right = root.parts
        difference = left if right == number(0.0) else node("-", left, right)
        return _SIDES[root.kind[0]](difference, right)
    return _rising(root), "rising"


def _rising(root: Node) -> Node:
    if root.kind in RELATIONS and root.kind[0] in _SIDES:
        difference, direction = guard_of(root)
        return difference if direction == "rising" else node("negative", difference)
    if root.kind == "not":
        return node("negative", _rising(root.parts[0]))
    if root.kind in ("and", "or"):
        least = "min" if root.kind == "and" else "max"
        return node("call", *(_rising(part) for part in root.parts), value=least)
    raise ModelError(
        "the trigger of the event is no comparison of sizes.", "Write it by <, <=, >, >=, and, or, not."
    )
