"""The data of a run file, where each piece of it came from, and how messages name both."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

Key = tuple[str | int, ...]

MAX_CHARACTERS = 256 * 1024


@dataclass
class Document:
    """Data of a run file and where each piece came from.

    Parameters
    ----------
    name : str
        The file, as the user gave it.
    data : dict
        Plain dicts, lists, str, int, float, bool and None.
    origins : dict
        Key path, as `("continue", "range")`, to its line (counted from 1) or to the `--set ...` it came from.
    """

    name: str
    data: dict[str, Any]
    origins: dict[Key, int | str] = field(default_factory=dict)

    def locate(self, loc: Key) -> tuple[Key, int | str | None]:
        """The key path that exists in the data for `loc`, and its origin.

        `loc` may hold pieces that the data does not: an index into what is written as a single value, or
        the name of an alternative in parentheses. They are left out.
        """
        node: Any = self.data
        shown: list[str | int] = []
        origin: int | str | None = None
        for step in loc:
            if _has(node, step):
                node = node[step]
                shown.append(step)
                origin = self.origins.get(tuple(shown), origin)
            elif isinstance(step, str) and not step.startswith("("):
                shown.append(step)
        return tuple(shown), origin

    def where(self, loc: Key) -> str:
        """`runs/x.yaml, line 7, key continue.range`, as far as it is known."""
        shown, origin = self.locate(loc)
        words = self.name
        if isinstance(origin, str):
            words += f" with {origin}"
        elif origin is not None:
            words += f", line {origin}"
        return words + (f", key {dotted(shown)}" if shown else "")


def _has(node: Any, step: str | int) -> bool:
    if isinstance(node, list):
        return isinstance(step, int) and step < len(node)
    return isinstance(node, dict) and step in node


def dotted(key: Key) -> str:
    """A key path as it is written after `--set`."""
    return ".".join(str(step) for step in key)


def shown(value: Any) -> str:
    """A value as an error message shows it: short, in the words of YAML."""
    if value is None:
        return "empty"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, str):
        return f"the text '{value if len(value) <= 40 else value[:37] + '...'}'"
    words = f"{value:.12g}" if isinstance(value, float) else str(value)
    return words if len(words) <= 40 else words[:37] + "..."
