"""Parameters that are functions of others, such as `b = 2 * a`: held along every branch.

A system's functions get parameters in which they are computed anew. Their expressions are kept among the
choices of the model, so that whoever loads the system again finds them.
"""

from __future__ import annotations

import math
import re
import types
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from contwalk.equations.constant import value_of
from contwalk.equations.nodes import ModelError, Node, names_in, number, replaced
from contwalk.errors import SystemDefinitionError
from contwalk.python_functions import is_own, original
from contwalk.system.names import HELD, nearest
from contwalk.system.observables import SignalExtreme
from contwalk.system.parameter_values import ParameterValues

if TYPE_CHECKING:
    from contwalk.system.system import System

_FILE = "the expressions of the parameters"


class HeldError(SystemDefinitionError):
    """An expression that cannot hold the parameter `name`."""

    name = ""


def held_in(system: System) -> dict[str, str]:
    """Expressions by the names of the parameters that they hold."""
    return {key.removeprefix(HELD): str(text) for key, text in system.model.items() if key.startswith(HELD)}


# A date is digits and minus signs, as a difference is; Python has no number that begins so either.
_ODD_NUMBER = re.compile(r"(?<![\w.])0\d+(?![\w.])")


def settled(system: System, values: Mapping[str, float]) -> dict[str, float]:
    """Parameters by name, with those that are held as the others say."""
    found, expressions = dict(values), held_in(system)
    if not expressions:
        return found
    for name, root in _ordered(tuple(expressions.items())):
        given = {other: number(float(found[other])) for other in names_in(root) & found.keys()}
        try:
            found[name] = value_of(replaced(root, given))
        except ModelError as error:
            raise _wrong(name, expressions[name], error.sentence, error.remedy) from None
    return found


def holding(system: System, expressions: Mapping[str, Any]) -> System:
    """The system with parameters held by expressions of others.

    Raises
    ------
    HeldError
        For what is no expression of parameters, or holds what cannot be held.
    """
    held = dict(expressions)
    values = [each.value for each in system.neutral]
    for name, text in held.items():
        if not isinstance(text, str):
            raise _wrong(name, text, "it is no text", "Write an expression of parameters.")
        if name not in system.parameter_names:
            known = system.parameter_names
            raise _wrong(name, text, f"'{system.name}' has no parameter '{name}'", nearest(name, known))
        if name in system.conserved_names or name in values:
            raise _wrong(name, text, "it says which of a family of solutions is meant", "Give a number.")
    for name, root in _ordered(tuple(held.items())):
        for other in sorted(names_in(root) - {"pi"}):
            if other not in system.parameter_names or other in system.conserved_names:
                hint = nearest(other, system.parameter_names) or "It may have parameters, and pi."
                raise _wrong(name, held[name], f"'{other}' is no parameter of '{system.name}'", hint)
    wrapped = _wrapper(tuple(held.items()))
    memo: dict[int, Any] = {}

    def around(value: Any) -> Any:
        """The same with its functions wrapped, each in one way: guards are told apart by identity."""
        if isinstance(value, Mapping):
            return {key: around(each) for key, each in value.items()}
        python = original(value)
        if not isinstance(python, types.FunctionType) or is_own(python):
            return value
        return memo.setdefault(id(value), wrapped(value))

    changed: dict[str, Any] = {
        what: tuple(_with_functions(entry, around) for entry in getattr(system, what))
        for what in ("modes", "transitions", "symmetries", "neutral", "starts", "conditions", "signals")
    }
    own = [entry for entry in system.observables if not isinstance(entry.function, SignalExtreme)]
    changed["observables"] = tuple(_with_functions(entry, around) for entry in own)
    if system.conserved:
        changed["conserved"] = tuple(_with_functions(entry, around) for entry in system.conserved)
    for what in ("period", "draw", "fallen"):
        changed[what] = around(getattr(system, what))
    model = {**system.model, **{HELD + name: text for name, text in held.items()}}
    return replace(system, **changed, model=model)


def _with_functions(entry: Any, around: Callable[[Any], Any]) -> Any:
    """A declaration with its functions wrapped."""
    functions = ("field", "guard", "reset", "map", "generator", "states", "function")
    given = {each.name: getattr(entry, each.name) for each in fields(entry) if each.name in functions}
    called = {key: around(value) for key, value in given.items() if callable(value) or key == "function"}
    return replace(entry, **called)


def _wrong(name: str, text: Any, why: str, remedy: str) -> HeldError:
    error = HeldError(f"'{name}' is held by the text '{text}': {why.rstrip('.')}.", remedy)
    error.name = name
    return error


@lru_cache(maxsize=16)
def _ordered(held: tuple[tuple[str, str], ...]) -> tuple[tuple[str, Node], ...]:
    """Expressions as trees, each after those that it uses.

    Raises
    ------
    HeldError
    """
    from contwalk.equations.functions import FUNCTIONS  # most systems hold none
    from contwalk.equations.grammar import expression_of
    from contwalk.equations.nodes import parts_of

    trees: dict[str, Node] = {}
    for name, text in held:
        odd = _ODD_NUMBER.search(text)
        if odd:
            raise _wrong(name, text, f"'{odd.group()}' is no number", "A date is no value; write 1, not 01.")
        try:
            trees[name] = expression_of(text)
        except ModelError as error:
            raise _wrong(name, text, error.sentence, error.remedy) from None
        for call in (part for part in parts_of(trees[name]) if part.kind == "call"):
            function = str(call.value)
            if function not in FUNCTIONS:
                hint = nearest(function, tuple(FUNCTIONS)) or "Write it by others."
                raise _wrong(name, text, f"there is no function '{function}'", hint)
            if len(call.parts) not in FUNCTIONS[function].arguments:
                takes = " or ".join(map(str, FUNCTIONS[function].arguments))
                many = "s" * (takes != "1")
                raise _wrong(name, text, f"{function} takes {takes} argument{many}", "")
    order: dict[str, Node] = {}
    while len(order) < len(trees):
        waits = trees.keys() - order.keys()
        free = [name for name in trees if name in waits and not names_in(trees[name]) & waits]
        if not free:
            name = min(waits)
            raise _wrong(name, dict(held)[name], "it is held by itself", "Write what it is without it.")
        order |= {name: trees[name] for name in free}
    return tuple(order.items())


@lru_cache(maxsize=16)
def _wrapper(held: tuple[tuple[str, str], ...]) -> Callable[[Any], Any]:
    """What makes of a function of parameters one that computes those that are held.

    It is written as a plugin would be: the engine traces it with symbols, as it does a plugin's functions.
    """
    import functools

    import numpy as np

    from contwalk.equations.python import Writer

    ordered = _ordered(held)
    names = {name: f'values["{name}"]' for _, root in ordered for name in names_in(root)} | {"pi": "math.pi"}
    lines = [f'    values["{name}"] = {Writer(names, _no_function).text(root)}' for name, root in ordered]
    text = "\n".join(
        [
            "def computed(p):",
            "    values = dict(vars(p))",
            *lines,
            "    return ParameterValues(**values)",
            "def wrapped(function):",
            "    def called(*given, **named):",
            "        parts = [computed(p) if isinstance(p, ParameterValues) else p for p in given]",
            "        return function(*parts, **named)",
            "    return called",
        ]
    )
    module = types.ModuleType("held_parameters")
    module.__dict__.update({"np": np, "math": math, "ParameterValues": ParameterValues})
    exec(compile(text, _FILE, "exec"), module.__dict__)

    def around(function: Any) -> Any:
        python = original(function)
        called: Any = functools.update_wrapper(module.__dict__["wrapped"](function), python)
        code = python.__code__  # where messages look for it
        called.__code__ = called.__code__.replace(
            co_filename=code.co_filename, co_firstlineno=code.co_firstlineno, co_name=code.co_name
        )
        return called

    return around


def _no_function(name: str, arguments: list[str]) -> str:
    raise NotImplementedError(name)
