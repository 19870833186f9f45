"""Expressions as trees, and how deep they may be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from contwalk.errors import SystemDefinitionError

# How many operations may stand inside each other, and parentheses: Python itself gives up at 200 of them.
LIMITS = {"operations": 300, "parentheses": 90}
RELATIONS = ("<", "<=", ">", ">=", "==", "!=")
CONDITIONS = (*RELATIONS, "and", "or", "not")


class ModelError(SystemDefinitionError):
    """A text of equations that cannot be made a system; the sentence names its line."""


@dataclass(frozen=True, slots=True)
class Node:
    """A part of an expression.

    Parameters
    ----------
    kind : str
        `number`, `name`, `call`, `if`, `negative`, `not`, or the operator: `+ - * / ^`, a relation, `and`,
        `or`.
    value : float or str
        Of a number its value, of a name or a call the name.
    parts : tuple of Node
        What the operation is of, or the arguments.
    depth : int
        How many operations stand inside each other.
    """

    kind: str
    value: float | str = ""
    parts: tuple[Node, ...] = ()
    depth: int = 1


def node(kind: str, *parts: Node, value: float | str = "") -> Node:
    """An operation of some parts.

    Raises
    ------
    ModelError
        If it is nested too deeply.
    """
    depth = 1 + max((part.depth for part in parts), default=0)
    if depth > LIMITS["operations"]:
        raise ModelError(
            f"An expression has more than {LIMITS['operations']} operations inside each other.",
            "Give parts of it names of their own, as in `total = a + b`, and use these.",
        )
    return Node(kind, value, parts, depth)


def number(value: float) -> Node:
    """A number as a tree."""
    return Node("number", float(value)) if value >= 0 else node("negative", Node("number", -float(value)))


def name(text: str) -> Node:
    """A name as a tree."""
    return Node("name", text)


def parts_of(root: Node) -> Iterator[Node]:
    """A tree's parts, itself first."""
    waiting = [root]
    while waiting:
        part = waiting.pop()
        yield part
        waiting.extend(part.parts)


def names_in(root: Node) -> set[str]:
    """The names that stand in a tree, those of called functions left out."""
    return {str(part.value) for part in parts_of(root) if part.kind == "name"}


def calls_in(root: Node) -> set[str]:
    """The names of the functions that a tree calls."""
    return {str(part.value) for part in parts_of(root) if part.kind == "call"}


def replaced(root: Node, values: Mapping[str, Node]) -> Node:
    """An expression with others in the place of some names.

    Raises
    ------
    ModelError
        If it is nested too deeply then.
    """
    if root.kind == "name":
        return values.get(str(root.value), root)
    if not root.parts:
        return root
    return node(root.kind, *(replaced(part, values) for part in root.parts), value=root.value)
