"""Names and values in declarations: what they may be, and how wrong ones are told."""

from __future__ import annotations

import keyword
import unicodedata
from collections.abc import Collection, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError

SIDES = ("before", "after")

# What a choice of the model begins with that holds a parameter by an expression.
HELD = "parameters."


def nearest(name: str, known: Sequence[str]) -> str:
    """Words that name the nearest known name, for error messages; empty when nothing is near."""
    alike = [each for each in known if each.lower() == name.lower()]
    match = alike or get_close_matches(name, list(known), n=1, cutoff=0.5)
    return f"Did you mean '{match[0]}'?" if match else ""


def free_name(name: str, taken: Collection[str]) -> str:
    """The name, with as many underscores behind it as it takes to be none of those taken."""
    while name in taken:
        name += "_"
    return name


def article(kind: str) -> str:
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"


def require_name(what: str, name: Any) -> None:
    if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
        raise SystemDefinitionError(
            f"{what} has the name {name!r}, which is not a valid Python identifier.",
            "Use letters, digits and underscores, not starting with a digit.",
        )
    written = unicodedata.normalize("NFKC", name)
    if written != name:  # Python reads p.name so, and would not find it
        raise SystemDefinitionError(
            f"{what} has the name {name!r} ({name!a}), which Python reads as {written!r} ({written!a}).",
            f"Name it {written!r}.",
        )


def is_number(value: Any) -> bool:
    """Whether this is a real number, and no larger than floats are."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool):
        return abs(int(value)) < 10**300
    return isinstance(value, float | np.floating)


def shown(value: Any) -> str:
    """A wrong value in a message: of functions and of declarations what they are called."""
    if callable(value):
        return f"the function {getattr(value, '__name__', type(value).__name__)}"
    if hasattr(value, "__dataclass_fields__") and hasattr(value, "name"):
        return f"{type(value).__name__}({value.name!r}, ...)"
    return repr(value)


def require_texts(what: str, declared: Any, *names: str) -> None:
    for name in names:
        text = getattr(declared, name)
        if not isinstance(text, str):
            raise SystemDefinitionError(f"{what} has {name} {text!r}.", f"A {name} is a text.")


def require_callable(what: str, function: Any) -> None:
    if not callable(function):
        raise SystemDefinitionError(f"{what} is {function!r}.", "It must be a function.")


def require_side(what: str, side: Any) -> None:
    if side not in SIDES:
        raise SystemDefinitionError(f"{what} has side {side!r}.", f"Allowed: {', '.join(SIDES)}.")
