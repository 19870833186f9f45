"""Expressions of SymPy as equations in text, which hold what the plugin does.

Nothing of SymPy is imported: its objects are told by the names of their classes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from contwalk.equations.functions import FUNCTIONS
from contwalk.equations.names import TIME, usable_name
from contwalk.equations.nodes import ModelError

_FUNCTIONS = {"Abs": "abs", "Min": "min", "Max": "max", "Heaviside": "heav", "ceiling": "ceil", "Mod": "mod"}
_RELATIONS = {
    "StrictLessThan": "<",
    "LessThan": "<=",
    "StrictGreaterThan": ">",
    "GreaterThan": ">=",
    "Equality": "==",
    "Unequality": "!=",
}


def text_of_sympy(
    states: Sequence[Any],
    equations: Sequence[Any] | Mapping[Any, Any],
    parameters: Mapping[Any, float],
    start: Mapping[Any, float],
    period: Any,
    is_map: bool,
) -> str:
    """The text of equations of SymPy; see `contwalk.shortcuts.from_sympy.system_from_sympy`.

    Raises
    ------
    ModelError
        For what cannot be translated.
    """
    names = [_name(state) for state in states]
    rights = _rights(states, equations)
    mark = "+" if is_map else "'"
    lines = [f"{name}{mark} = {_text(right, names)}" for name, right in zip(names, rights, strict=True)]
    lines += [f"{_name(parameter)} = {float(value)!r}" for parameter, value in parameters.items()]
    lines += [f"{_name(state)}(0) = {float(value)!r}" for state, value in start.items()]
    if period is not None:
        lines.append(f"period = {_text(period, names)}")
    return "\n".join(lines) + "\n"


def _rights(states: Sequence[Any], equations: Sequence[Any] | Mapping[Any, Any]) -> list[Any]:
    """The right sides, one for each state."""
    if isinstance(equations, Mapping):
        missing = [state for state in states if state not in equations]
        if missing:
            raise ModelError(f"There is no equation for the state {missing[0]}.", "Give one for each.")
        return [equations[state] for state in states]
    if len(equations) != len(states):
        raise ModelError(
            f"There are {len(equations)} equations for {len(states)} states.", "Give one for each, in order."
        )
    found: list[Any] = []
    for state, equation in zip(states, equations, strict=True):
        if type(equation).__name__ != "Equality":
            found.append(equation)
            continue
        left = equation.lhs
        if type(left).__name__ != "Derivative" or _name(left.args[0]) != _name(state):
            raise ModelError(
                f"The equation {equation} is not that of d{state}/dt.", "Write Eq(Derivative(x(t), t), ...)."
            )
        found.append(equation.rhs)
    return found


def _name(symbol: Any) -> str:
    """The name of a symbol, or of a function of the time."""
    text = str(symbol.func if getattr(symbol, "is_Function", False) else symbol)
    if text == TIME:
        return text
    if not re.fullmatch(r"[^\W\d]\w*", text):
        raise ModelError(f"The symbol {text!r} is no name.", "Use letters, digits and underscores.")
    return usable_name(text, False)


def _text(root: Any, states: Sequence[str]) -> str:
    """An expression in the grammar of equations, with parentheses around all operations."""
    kind = type(root).__name__
    if isinstance(root, int | float):
        return f"({float(root)!r})"
    args: tuple[Any, ...] = getattr(root, "args", ())
    if getattr(root, "is_Function", False) and str(root.func) in states:
        return str(_name(root))
    if getattr(root, "is_Symbol", False):
        return _name(root)
    if kind == "Pi":
        return "pi"
    if getattr(root, "is_Rational", False):
        return f"({root.p}.0/{root.q}.0)" if root.q != 1 else f"({root.p}.0)"
    if getattr(root, "is_number", False) and not args:
        if not (root.is_real and root.is_finite):
            raise ModelError(f"{root} is no finite real number.", "Write equations of real numbers.")
        return f"({float(root)!r})"
    if kind in ("Add", "And", "Or"):
        sign = {"Add": " + ", "And": " & ", "Or": " | "}[kind]
        return f"({sign.join(_grouped(args, states))})"
    if kind == "Mul":
        return f"({_product(args, states)})"
    if kind == "Pow":
        return _power(root, states)
    if kind in _RELATIONS:
        return f"({_text(args[0], states)} {_RELATIONS[kind]} {_text(args[1], states)})"
    if kind == "Not":
        return f"(!{_text(args[0], states)})"
    if kind == "Piecewise":
        return _pieces(args, states)
    name = _FUNCTIONS.get(kind, str(getattr(root, "func", kind)))
    if name in ("min", "max"):
        nested = _text(args[0], states)
        for each in args[1:]:
            nested = f"{name}({nested}, {_text(each, states)})"
        return nested
    if name == "heav":
        args = args[:1]
    if name not in FUNCTIONS:
        raise ModelError(f"{name}(...) is no function that can be translated.", "Write it by others.")
    return f"{name}({', '.join(_text(each, states) for each in args)})"


def _grouped(args: Iterable[Any], states: Sequence[str]) -> list[str]:
    return [_text(each, states) for each in args]


def _product(args: Iterable[Any], states: Sequence[str]) -> str:
    """Factors, those of negative powers below."""
    above, below = [], []
    for each in args:
        power = each.args[1] if type(each).__name__ == "Pow" else None
        if power is not None and getattr(power, "is_number", False) and power.is_negative:
            below.append(_text(each.args[0] ** -power, states))
        else:
            above.append(_text(each, states))
    return " * ".join(above or ["1"]) + "".join(f" / {each}" for each in below)


def _power(root: Any, states: Sequence[str]) -> str:
    base, exponent = root.args
    if str(exponent) == "1/2":
        return f"sqrt({_text(base, states)})"
    if str(exponent) == "-1/2":
        return f"(1/sqrt({_text(base, states)}))"
    if getattr(exponent, "is_Integer", False):
        whole = int(exponent)
        text = f"{_text(base, states)}^{abs(whole)}"
        return f"({text})" if whole > 0 else f"(1/{text})"
    return f"({_text(base, states)}^{_text(exponent, states)})"


def _pieces(args: Sequence[Any], states: Sequence[str]) -> str:
    """A piecewise expression, the last piece of which must be for all that is left."""
    value, condition = args[-1].args
    if str(condition) != "True":
        raise ModelError(
            "A Piecewise says nothing for what its conditions leave out.", "End it by (value, True)."
        )
    text = _text(value, states)
    for piece in reversed(args[:-1]):
        value, condition = piece.args
        text = f"if({_text(condition, states)})then({_text(value, states)})else({text})"
    return text
