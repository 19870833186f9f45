"""Tables of an .ode file: values at equal distances, from a formula of t or from a file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from contwalk.equations.constant import is_constant, value_of
from contwalk.equations.functions import FUNCTIONS
from contwalk.equations.model import Table
from contwalk.equations.names import TIME
from contwalk.equations.nodes import ModelError, Node, calls_in, names_in, number, replaced

# How many values a table has, and how long its file may be.
LARGEST = {"values": 10_000, "characters": 1_000_000}


def table_of_formula(text: str, expression: Callable[[str], Node], line: int) -> Table:
    """The table of `% 21 -1 1 sin(t)`: how many values, from where to where, and their formula.

    Raises
    ------
    ModelError
        If that is none.
    """
    match = re.fullmatch(r"\s*%\s*(\d+)\s+(\S+)\s+(\S+)\s+(.*)", text)
    if match is None:
        raise ModelError("the table has no values.", "As in table f % 21 -1 1 sin(t)")
    ends = [expression(end) for end in match.group(2, 3)]
    if not all(map(is_constant, ends)):
        raise ModelError("the ends of the table are no numbers.", "As in table f % 21 -1 1 sin(t)")
    low, high = map(value_of, ends)
    formula = expression(match.group(4))
    if not names_in(formula) <= {TIME, "pi"} or not calls_in(formula) <= set(FUNCTIONS):
        raise ModelError(
            "the table depends on more than t.", "It would change with parameters: write it as a function."
        )
    places = _places(int(match.group(1)[:9]), low, high)
    return Table(places, tuple(value_of(replaced(formula, {TIME: number(t)})) for t in places), line)


def table_of_file(name: str, folder: Path | None, line: int) -> Table:
    """The table of a file beside the model: how many values, from where to where, then the values.

    Raises
    ------
    ModelError
        If there is none.
    """
    if not name or Path(name).name != name:
        raise ModelError(f"'{name}' is no name of a file beside the model.", "Put the table's file there.")
    try:
        with ((folder or Path()) / name).open(encoding="utf-8") as file:
            words = file.read(LARGEST["characters"]).split()
        count, low, high = int(words[0]), float(words[1]), float(words[2])
        values = tuple(float(word) for word in words[3 : 3 + count])
    except (OSError, ValueError, IndexError, OverflowError) as error:
        raise ModelError(f"the file {name} cannot be read: {error}.", "It has numbers alone.") from None
    places = _places(count, low, high)
    if len(values) != count or not all(abs(value) < 1e300 for value in values):
        raise ModelError(f"{name} has not {count} finite values.", "Complete it.")
    return Table(places, values, line)


def _places(count: int, low: float, high: float) -> tuple[float, ...]:
    if not (2 <= count <= LARGEST["values"] and low < high < 1e300 and low > -1e300):
        raise ModelError(
            f"the table has {count} values from {low:g} to {high:g}.",
            f"Give two to {LARGEST['values']}, upwards.",
        )
    return tuple(low + (high - low) * k / (count - 1) for k in range(count))
