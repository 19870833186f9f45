"""Expressions written as Python, with the names that a plugin has for what they mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from contwalk.equations.functions import FUNCTIONS
from contwalk.equations.nodes import CONDITIONS, RELATIONS, Node

# How tightly operations bind; what binds less than its place asks for gets parentheses.
_BINDS = {"relation": 3, "+": 5, "-": 5, "*": 6, "/": 6, "negative": 7, "^": 8, "atom": 9}
_PYTHON = {"^": "**"}
_CONTRARY = dict(zip(RELATIONS, (">=", ">", "<=", "<", "!=", "=="), strict=True))

Called = Callable[[str, list[str]], str]


class Writer:
    """Writes expressions in the names of one function of a plugin.

    Parameters
    ----------
    names : mapping
        What stands for each name.
    called : callable
        `called(name, arguments)` is the text of a call of one of the model's own functions.
    """

    def __init__(self, names: Mapping[str, str], called: Called) -> None:
        self._names, self._called = names, called

    def text(self, root: Node) -> str:
        """The expression as Python."""
        return self._at_least(root, 0)

    def _at_least(self, root: Node, place: int) -> str:
        """The text where something that binds as tightly as `place` is needed."""
        text, binds = self._bound(root)
        return f"({text})" if binds < place else text

    def _bound(self, root: Node) -> tuple[str, int]:
        kind, parts, atom = root.kind, root.parts, _BINDS["atom"]
        if kind == "number":
            return repr(float(root.value)), atom
        if kind == "name":
            return self._names[str(root.value)], atom
        if kind == "call":
            return self._call(root)
        if kind == "if":
            sides = ", ".join(self.text(part) for part in parts[1:])
            return f"np.where({self._condition(parts[0])}, {sides})", atom
        if kind in CONDITIONS:
            return f"np.where({self._condition(root)}, 1.0, 0.0)", atom
        binds = _BINDS[kind]
        if kind == "negative":
            return f"-{self._at_least(parts[0], binds)}", binds
        if kind == "^":
            return self._power(*parts)
        left, right = self._at_least(parts[0], binds), self._at_least(parts[1], binds + 1)
        return f"{left} {_PYTHON.get(kind, kind)} {right}", binds

    def _power(self, base: Node, exponent: Node) -> tuple[str, int]:
        binds = _BINDS["^"]
        left = self._at_least(base, binds + 1)
        whole = exponent.kind == "number" and float(exponent.value).is_integer() and base.kind != "number"
        if whole and float(exponent.value) < 1e6:
            right = str(int(exponent.value))
        else:
            right = self._at_least(exponent, _BINDS["negative"])
        close = base.kind == "name" and exponent.kind in ("number", "name")
        return (f"{left}**{right}" if close else f"{left} ** {right}"), binds

    def _call(self, root: Node) -> tuple[str, int]:
        name, parts = str(root.value), root.parts
        if name == "log" and len(parts) == 2:
            return f"np.log({self.text(parts[0])}) / np.log({self.text(parts[1])})", _BINDS["/"]
        known = FUNCTIONS.get(name)
        if known is None:
            return self._called(name, [self.text(part) for part in parts]), _BINDS["atom"]
        infix = {"pow": "^", "mod": "/"}.get(name)
        if infix is None:
            return known.written.format(*map(self.text, parts)), _BINDS["atom"]
        return known.written.format(*(self._at_least(part, _BINDS["atom"]) for part in parts)), _BINDS[infix]

    def _condition(self, root: Node, holds: bool = True) -> str:
        """A condition, or its contrary: `not` is written into its relations."""
        kind, parts, place = root.kind, root.parts, _BINDS["+"]
        if kind == "not":
            return self._condition(parts[0], not holds)
        if kind in ("and", "or"):
            sign = "&" if (kind == "and") == holds else "|"
            return f" {sign} ".join(f"({self._condition(part, holds)})" for part in parts)
        if kind in RELATIONS:
            sides = [self._at_least(part, place) for part in parts]
            return f"{sides[0]} {kind if holds else _CONTRARY[kind]} {sides[1]}"
        return f"{self._at_least(root, place)} {'!=' if holds else '=='} 0.0"
