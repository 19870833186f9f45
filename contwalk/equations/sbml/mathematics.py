"""Expressions of SBML, as libsbml has them, made trees of ours."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any

from contwalk.equations.names import TIME
from contwalk.equations.nodes import ModelError, Node, name, node, number

# Of libsbml's kinds of expressions, by the ends of their names: operators, and functions under our names.
_OPERATORS = {"PLUS": "+", "TIMES": "*", "LOGICAL_AND": "and", "LOGICAL_OR": "or"}
_NOTHING = {"PLUS": 0.0, "TIMES": 1.0, "LOGICAL_AND": 1.0, "LOGICAL_OR": 0.0}
_RELATIONS = {"LT": "<", "LEQ": "<=", "GT": ">", "GEQ": ">=", "EQ": "==", "NEQ": "!="}
_CIRCULAR = ("SIN", "COS", "TAN", "SINH", "COSH", "TANH")
_FUNCTIONS = {each: each.lower() for each in ("ABS", "EXP", "LN", "FLOOR", *_CIRCULAR)} | {"CEILING": "ceil"}
_FUNCTIONS |= {f"ARC{each}": f"a{each.lower()}" for each in _CIRCULAR}
# What is one over another function, and what is another function of one over the argument.
_OVER = {"SEC": "cos", "CSC": "sin", "COT": "tan", "SECH": "cosh", "CSCH": "sinh", "COTH": "tanh"}
_CONSTANTS = {"CONSTANT_E": math.e, "CONSTANT_TRUE": 1.0, "CONSTANT_FALSE": 0.0}


class Mathematics:
    """Makes trees of libsbml's.

    Parameters
    ----------
    library : module
        libsbml.
    names : mapping
        Our name, or an expression, for each identifier.
    """

    def __init__(self, library: Any, names: Mapping[str, str | Node]) -> None:
        self.names = names
        kinds = {value: key[4:] for key, value in vars(library).items() if key.startswith("AST_")}
        self._kinds = {value: key.removeprefix("FUNCTION_") for value, key in kinds.items()}
        self._function = library.AST_FUNCTION

    def tree(self, root: Any, local: Mapping[str, str | Node] | None = None) -> Node:
        """The expression, with the names of a reaction or a function before all others.

        Raises
        ------
        ModelError
            For what has no counterpart.
        """
        names = {**self.names, **(local or {})}

        def made(each: Any) -> Node:
            kind = self._kinds.get(each.getType(), "UNKNOWN")
            if kind in ("INTEGER", "REAL", "REAL_E", "RATIONAL"):
                return _number(each, kind)
            if kind == "NAME":
                found = names.get(each.getName(), each.getName())
                return name(found) if isinstance(found, str) else found
            if kind == "NAME_TIME":
                return name(TIME)
            parts = [made(each.getChild(i)) for i in range(each.getNumChildren())]
            if each.getType() == self._function:
                called = names.get(each.getName(), each.getName())
                return node("call", *parts, value=str(called))
            if kind == "NAME_AVOGADRO":
                return number(each.getReal())
            return _operation(kind, parts)

        return made(root)


def _number(root: Any, kind: str) -> Node:
    value = float(root.getInteger()) if kind == "INTEGER" else float(root.getReal())
    if not math.isfinite(value):
        raise ModelError(f"the number {value} is none that can be computed with.", "Write a finite one.")
    return number(value)


def _call(function: str, *parts: Node) -> Node:
    return node("call", *parts, value=function)


def _over(part: Node) -> Node:
    return node("/", number(1.0), part)


def _operation(kind: str, parts: list[Node]) -> Node:
    """An operation of some parts.

    Raises
    ------
    ModelError
    """
    if kind in _CONSTANTS:
        return number(_CONSTANTS[kind])
    if kind == "CONSTANT_PI":
        return name("pi")
    if kind in _OPERATORS:
        return _row(_OPERATORS[kind], parts, _NOTHING[kind])
    if kind.startswith("RELATIONAL_"):
        relation = _RELATIONS[kind.removeprefix("RELATIONAL_")]
        pairs = itertools.pairwise(parts)
        return _row("and", [node(relation, *pair) for pair in pairs], 1.0)
    if kind in ("MIN", "MAX") and parts:
        return reduce(lambda a, b: _call(kind.lower(), a, b), parts)
    known = _BY_NUMBER.get((kind, len(parts)))
    if known is not None:
        return known(*parts)
    if kind == "PIECEWISE":
        return _pieces(parts)
    if len(parts) == 1:
        if kind in _FUNCTIONS:
            return _call(_FUNCTIONS[kind], *parts)
        if kind in _OVER:
            return _over(_call(_OVER[kind], *parts))
        if kind == "ARCCOT":  # between -pi/2 and pi/2, as MathML has it
            return _call("atan", _over(parts[0]))
        if kind.removeprefix("ARC") in _OVER:
            return _call(f"a{_OVER[kind.removeprefix('ARC')]}", _over(parts[0]))
    words = {"DELAY": "the past of a quantity", "RATE_OF": "a rate by the name of what changes"}
    what = words.get(kind, f"'{kind.lower().replace('_', ' ')}' with {len(parts)} arguments")
    raise ModelError(
        f"{what} stands in an expression.", "It cannot be translated: write it by other functions."
    )


def _row(operator: str, parts: list[Node], nothing: float) -> Node:
    return reduce(lambda a, b: node(operator, a, b), parts) if parts else number(nothing)


def _pieces(parts: list[Node]) -> Node:
    if len(parts) % 2 == 0:
        raise ModelError(
            "a piecewise expression says nothing for what its conditions leave out.",
            "End it by an <otherwise>.",
        )
    found = parts[-1]
    for i in range(len(parts) - 3, -1, -2):
        found = node("if", parts[i + 1], parts[i], found)
    return found


def _whole_quotient(a: Node, b: Node) -> Node:
    return _call("trunc", node("/", a, b))


_BY_NUMBER: dict[tuple[str, int], Callable[..., Node]] = {
    ("MINUS", 1): lambda a: node("negative", a),
    ("MINUS", 2): lambda a, b: node("-", a, b),
    ("DIVIDE", 2): lambda a, b: node("/", a, b),
    ("POWER", 2): lambda a, b: node("^", a, b),
    ("ROOT", 1): lambda a: _call("sqrt", a),
    ("ROOT", 2): lambda degree, a: _call("sqrt", a) if degree == number(2.0) else node("^", a, _over(degree)),
    ("LOG", 1): lambda a: _call("log10", a),
    ("LOG", 2): lambda base, a: _call("log10", a) if base == number(10.0) else _call("log", a, base),
    ("FACTORIAL", 1): lambda a: _call("gamma", node("+", a, number(1.0))),
    ("LOGICAL_NOT", 1): lambda a: node("not", a),
    ("LOGICAL_XOR", 2): lambda a, b: node("!=", a, b),
    ("LOGICAL_IMPLIES", 2): lambda a, b: node("or", node("not", a), b),
    ("QUOTIENT", 2): _whole_quotient,
    ("REM", 2): lambda a, b: node("-", a, node("*", b, _whole_quotient(a, b))),
}
