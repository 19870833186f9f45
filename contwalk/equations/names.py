"""Whether the names of a model are defined and free, what its quantities use, and their order."""

from __future__ import annotations

import keyword
from collections.abc import Iterable, Mapping
from difflib import get_close_matches

from contwalk.column_names import COLUMN_OF_SPECTRUM, RESERVED
from contwalk.equations.functions import CONSTANTS, FUNCTIONS
from contwalk.equations.model import Model
from contwalk.equations.nodes import Node, calls_in, names_in, parts_of

TIME = "t"
_WORDS = ("if", "then", "else", "and", "or", "not", "event", "falls", "rises")
# What no branch or table has a column of.
_LOCAL = ("argument", "function", "table")


# How many definitions a model may have, and how many lines the signals that they make.
LARGEST = {"definitions": 3000, "events": 100, "lines": 50_000}


def check_names(model: Model) -> None:
    """Refuse names that are taken, unknown, or used as what they are not.

    Raises
    ------
    ModelError
        With the line.
    """
    if not model.rates:
        raise model.wrong(1, "there is no equation.", "Write one for each state, as in x' = a - x.")
    _check_defined(model)
    known = {name: kind for kind, name, _ in model.lines()}
    named = {TIME, *CONSTANTS, *(name for name, kind in known.items() if kind not in ("function", "table"))}
    for root, line, arguments in model.expressions():
        _check_used(model, root, line, named.union(arguments) if arguments else named, known)
    for state, start in model.starts.items():
        if state not in model.rates:
            raise model.wrong(
                start.line, f"'{state}' has a start, and no equation.", _near(state, model.rates)
            )
    for event in model.events.values():
        for state in event.resets:
            if state not in model.rates:
                raise model.wrong(
                    event.line, f"the event sets '{state}', which is no state.", _near(state, model.rates)
                )
    if model.is_map and (model.period is not None or model.events):
        line = model.period.line if model.period is not None else next(iter(model.events.values())).line
        raise model.wrong(line, "a map has neither a period nor events.", "Leave it out, or write rates, x'.")
    if model.period is not None and names_in(model.period.value) & {TIME, *model.rates}:
        raise model.wrong(
            model.period.line, "the period depends on the time or a state.", "It may depend on parameters."
        )


def _check_defined(model: Model) -> None:
    seen: dict[str, int] = {}
    if sum(1 for _ in model.lines()) > LARGEST["definitions"]:
        raise model.wrong(1, f"more than {LARGEST['definitions']} names are defined.", "Write a plugin.")
    if len(model.events) > LARGEST["events"]:
        raise model.wrong(1, f"the model has more than {LARGEST['events']} events.", "Write a plugin.")
    for kind, name, line in model.lines():
        check_name(model, name, line, kind)
        if name in seen:
            first, second = sorted((seen[name], line))
            raise model.wrong(
                second, f"'{name}' is defined again; it is on line {first} already.", "Rename one of them."
            )
        seen[name] = line
    for name, function in model.functions.items():
        if len(set(function.arguments)) < len(function.arguments):
            raise model.wrong(function.line, f"two arguments of {name} have one name.", "Rename one of them.")
        for argument in function.arguments:
            if argument != TIME:
                check_name(model, argument, function.line, "argument")


def check_name(model: Model, name: str, line: int, kind: str) -> None:
    """Refuse a name that means something else already.

    Raises
    ------
    ModelError
    """
    taken = ""
    if keyword.iskeyword(name) or name in _WORDS:
        taken = "a word of the language"
    elif name in FUNCTIONS and kind in ("function", "table"):
        taken = "a function"
    elif name in CONSTANTS or name == TIME:
        taken = "a constant" if name in CONSTANTS else "the time"
    elif kind not in _LOCAL and (name in RESERVED or COLUMN_OF_SPECTRUM.fullmatch(name)):
        taken = "what contwalk calls a result"
    elif name.startswith("__"):
        taken = "a name of Python's own"
    if taken:
        raise model.wrong(
            line,
            f"the {kind} '{name}' has a name that is taken: it is {taken}.",
            f"Rename it, as in {name}_1.",
        )


def usable_name(name: str, function: bool) -> str:
    """The name, with an underscore behind it where it is taken."""
    taken = keyword.iskeyword(name) or name in _WORDS or name in CONSTANTS or name == TIME
    columns = name in RESERVED or COLUMN_OF_SPECTRUM.fullmatch(name) or name.startswith("__")
    return f"{name}_" if taken or (name in FUNCTIONS if function else columns) else name


def _check_used(model: Model, root: Node, line: int, named: set[str], known: Mapping[str, str]) -> None:
    for part in parts_of(root):
        if part.kind == "name" and part.value not in named:
            name = str(part.value)
            if name in FUNCTIONS or name in known:
                raise model.wrong(line, f"{name} is a function.", f"Give its arguments: {name}(x).")
            raise model.wrong(line, f"'{name}' is not defined.", _near(name, named) or f"As in {name} = 1.0.")
        if part.kind == "call":
            _check_call(model, part, line, known)


def _check_call(model: Model, call: Node, line: int, known: Mapping[str, str]) -> None:
    name, given = str(call.value), len(call.parts)
    if name in model.functions:
        takes: tuple[int, ...] = (len(model.functions[name].arguments),)
    elif name in model.tables:
        takes = (1,)
    elif name in known:
        raise model.wrong(
            line, f"'{name}' is a {known[name]} and is used as a function.", f"A product is {name} * (...)."
        )
    elif name in FUNCTIONS:
        takes = FUNCTIONS[name].arguments
    else:
        near = _near(name, (*FUNCTIONS, *model.functions, *model.tables))
        raise model.wrong(
            line, f"there is no function '{name}'.", near or f"Define it, as in {name}(x) = x^2."
        )
    if given not in takes:
        words = " or ".join(map(str, takes))
        raise model.wrong(line, f"{name} takes {words} argument{'s' * (takes[-1] != 1)}, and gets {given}.")


def _near(name: str, known: Iterable[str]) -> str:
    names = sorted(known)
    folded = [other for other in names if other.lower() == name.lower()]
    found = folded or get_close_matches(name, names, n=1, cutoff=0.5)
    return f"Did you mean '{found[0]}'?" if found else ""


def needs(model: Model) -> dict[str, tuple[str, ...]]:
    """What each quantity and each function uses, directly or not: names of all kinds, its arguments left out.

    Quantities and functions come in an order in which each is after all that it uses.

    Raises
    ------
    ModelError
        If one is defined by itself.
    """
    bodies: dict[str, tuple[Node, tuple[str, ...], int]] = {
        name: (entry.value, (), entry.line) for name, entry in model.quantities.items()
    }
    bodies |= {name: (f.body, f.arguments, f.line) for name, f in model.functions.items()}
    found: dict[str, tuple[str, ...]] = {}
    begun: dict[str, None] = {}
    for name in bodies:
        waiting = [name]
        while waiting:
            top = waiting[-1]
            if top in found:
                waiting.pop()
                continue
            body, arguments, line = bodies[top]
            direct = {*names_in(body) - set(arguments), *calls_in(body)}
            missing = [other for other in sorted(direct) if other in bodies and other not in found]
            if top in begun and missing:
                others = [other for other in begun if other not in found and other != top]
                circle = f", by way of {', '.join(others[:5])}" if others else ""
                raise model.wrong(
                    line, f"'{top}' is defined by itself{circle}.", "Write what it is without it."
                )
            begun[top] = None
            waiting += missing
            if not missing:
                used = dict.fromkeys(sorted(direct))
                for other in sorted(direct):
                    used |= dict.fromkeys(found.get(other, ()))
                if arguments:
                    _check_shadowed(model, top, arguments, direct, found, line)
                found[top] = tuple(used)
    return found


def _check_shadowed(
    model: Model,
    name: str,
    arguments: tuple[str, ...],
    direct: set[str],
    found: Mapping[str, tuple[str, ...]],
    line: int,
) -> None:
    """An argument hides a name from the function itself, not from those that it calls."""
    for other in sorted(direct):
        hidden = set(arguments) & {*found.get(other, ())} & {TIME, *model.rates, *model.quantities}
        if hidden:
            raise model.wrong(
                line,
                f"the argument {min(hidden)} of {name} has a name that {other} uses, which {name} calls.",
                "Rename the argument.",
            )
