"""One point on the terminal, and the names by which points are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from contwalk.cli.terminal import line, table
from contwalk.errors import ContwalkError
from contwalk.workflow.stored.point_words import row_words, special_words

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.branch import Branch, SpecialPoint
    from contwalk.system import System
    from contwalk.workflow.stored.hybrid_facts import HybridFacts


def row_of(branch: Branch, name: str) -> int | None:
    """The row that a point's name is the number of; None for the name of a special point.

    Raises
    ------
    ContwalkError
        If the branch has no such row.
    """
    if not (name.isascii() and name.isdigit()):
        return None
    if int(name) >= len(branch):
        raise ContwalkError(
            f"Branch {branch.name} has no point {name}.", f"Its points are 0 to {len(branch) - 1}."
        )
    return int(name)


def special_of(branch: Branch, name: str) -> SpecialPoint:
    """The special point of this name.

    Raises
    ------
    ContwalkError
        If the branch has none; the remedy names those it has.
    """
    for point in branch.special_points:
        if point.name == name:
            return point
    from contwalk.system.declarations import nearest

    known = [point.name for point in branch.special_points]
    raise ContwalkError(
        f"Branch {branch.name} has no special point '{name}'.",
        f"{nearest(name, known)} Known: {', '.join(known) or 'none'}; or the number of a point, "
        f"0 to {len(branch) - 1}.".strip(),
    )


def stored_point(branch: Branch, point: str) -> SpecialPoint | int:
    """The special point that `b1/HB1` names, or the number of the row that `b1/12` does.

    Raises
    ------
    ContwalkError
        If the branch has none.
    """
    name = point.partition("/")[2]
    row = row_of(branch, name)
    return special_of(branch, name) if row is None else row


def print_point(
    out: Console,
    branch: Branch,
    point: SpecialPoint | int,
    units: Mapping[str, str],
    system: System | None = None,
) -> None:
    """A special point or a row: its title, what is true of it, and tables of its numbers."""
    hybrid = _facts_at(system, branch, point)
    if isinstance(point, int):
        words = row_words(branch, point, units, hybrid)
    else:
        words = special_words(branch, point, units, hybrid, system)
    line(out, words.title, style="bold")
    for fact in words.facts:
        line(out, fact, indent=4)
    for each in words.tables:
        out.print()
        table(out, each.header, each.rows, indent=4)
        if each.remark:
            line(out, each.remark, indent=4)


def _facts_at(system: System | None, branch: Branch, point: SpecialPoint | int) -> HybridFacts | None:
    """Segments and margins; None of other orbits, and where they cannot be had: why is said on stderr."""
    if system is None or branch.info.problem_by_name != "hybrid_orbit":
        return None
    from contwalk.cli.entry import say
    from contwalk.workflow.stored.hybrid_facts import facts_of

    try:
        return facts_of(system, branch, point)
    except ContwalkError as error:
        say(f"Not shown: segments and margins of the orbit. {error}")
        return None
