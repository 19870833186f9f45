"""Everything that is known of one point."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from contwalk import quantities
from contwalk.cli.hybrid_page import (
    admissible_line,
    facts_at,
    meaning_line,
    print_margins,
    print_segments,
    signature_line,
)
from contwalk.cli.summary import free_value
from contwalk.cli.terminal import line, table
from contwalk.cli.words import exact, plural, rough, with_unit
from contwalk.errors import ContwalkError
from contwalk.labels import UNDECIDED
from contwalk.signatures import is_iterated, told_problem
from contwalk.special_point import told_count, told_sides, told_what

if TYPE_CHECKING:
    import numpy as np
    from rich.console import Console

    from contwalk.branch import Branch, SpecialPoint
    from contwalk.system import System


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


def print_special(
    out: Console,
    branch: Branch,
    point: SpecialPoint,
    units: Mapping[str, str],
    system: System | None = None,
) -> None:
    """A special point: where it is, what happens there, and the numbers that say so."""
    hybrid = facts_at(system, branch, point)
    line(out, f"{branch.name}/{point.name}  {told_what(point)}", style="bold")
    free = branch.info.free[0]
    error = f", estimated error {rough(point.error)}" if point.error is not None else ""
    facts = [f"{free} = {exact(free_value(branch, point))} {with_unit(free, units)}".strip() + error]
    facts.append(f"unstable directions: {told_sides(point)}")
    facts += [f"criticality: {point.criticality}"] if point.criticality else []
    facts += meaning_line(branch, point, hybrid, system)
    facts += [f"note: {point.note}"] if point.note else []
    facts += admissible_line(point.admissible, branch, hybrid)
    facts += signature_line(branch)
    facts += [] if point.period is None else _of_orbit(branch, point.period, point.trivial_error, units)
    facts.append(f"point {point.index} of the branch, {told_problem(branch.info.problem_by_name)}")
    facts += _cost(branch.points[point.index]) if point.index < len(branch) else []
    for fact in facts:
        line(out, fact, indent=4)
    print_segments(out, hybrid, with_unit("period", units))
    _values(out, "parameter", point.parameters.items(), units)
    _values(out, "state", point.state.items(), units)
    _ranges(out, branch, point.index, units)
    if hybrid is not None:
        print_margins(out, hybrid)
    elif not is_iterated(branch.info.signature):
        _values(out, "margin", point.margin.items(), {})
    _spectrum(out, branch, point.spectrum, "")
    _spectrum(out, branch, point.spectrum_full or (), " of the full orbit")
    if point.coefficients:
        out.print()
        table(
            out, ["coefficient", ""], [[name, _text(v)] for name, v in point.coefficients.items()], indent=4
        )


def print_row(
    out: Console, branch: Branch, row: int, units: Mapping[str, str], system: System | None = None
) -> None:
    """Any other stored point."""
    hybrid = facts_at(system, branch, row)
    info, point = branch.info, branch.points[row]
    line(out, f"{branch.name}/{row}  point of {told_problem(info.problem_by_name)}", style="bold")
    stable = {1: "stable", 0: "not stable"}.get(int(point["stable"]), UNDECIDED)
    line(out, f"unstable directions: {told_count(int(branch['unstable'][row]))} ({stable})", indent=4)
    period, trivial = float(point["period"]), float(point["trivial_error"])
    known = None if math.isnan(trivial) else trivial
    facts = _of_orbit(branch, period, known, units) if period > 0.0 else []
    can = admissible_line(bool(point["admissible"]), branch, hybrid)
    for fact in [*can, *signature_line(branch), *facts, *_cost(point)]:
        line(out, fact, indent=4)
    print_segments(out, hybrid, with_unit("period", units))
    parameters = {**info.parameters, **dict(zip(info.free, point["free"], strict=True))}
    _values(out, "parameter", parameters.items(), units)
    _values(out, "state", zip(info.states, point["state"], strict=True), units)
    _ranges(out, branch, row, units)
    named = {margin.name for margin in hybrid.margins} if hybrid is not None else set()
    observables = [
        (name, value)
        for name, value in zip(info.observables, point["observables"], strict=True)
        if name not in named and not quantities.of_orbit(name)
    ]
    _values(out, "observable", observables, units)
    if hybrid is not None:
        print_margins(out, hybrid)
    _spectrum(out, branch, point["spectrum"], "")


def _of_orbit(
    branch: Branch, period: float, trivial_error: float | None, units: Mapping[str, str]
) -> list[str]:
    """Period, closure and accuracy of an orbit."""
    info = branch.info
    fold = int(info.settings.get("fold", 1))
    time = with_unit("period", units)
    facts = [f"period: {exact(fold * period)} {time}".rstrip()]
    if info.closure not in (None, "full"):
        part = f"closure: up to the symmetry '{info.closure}' after 1/{fold} of the period, {exact(period)}"
        facts.append(f"{part} {time}".rstrip())
        facts += [f"period of the orbit: {info.subharmonic} of the forcing"] if info.subharmonic > 1 else []
    elif info.subharmonic > 1:
        facts.append(f"closure: after {info.subharmonic} periods of the forcing")
    else:
        facts.append("closure: full")
    if trivial_error is not None:
        facts.append(f"error of the trivial multiplier, which is one: {rough(trivial_error)}")
    return facts


def _cost(row: np.void) -> list[str]:
    """How well a point is known, and what it cost."""
    spectral, excess = float(row["spectrum_error"]), float(row["residual"])
    facts = [] if math.isnan(spectral) else [f"estimated error of the leading eigenvalue: {rough(spectral)}"]
    facts += [] if math.isnan(excess) else [f"residual: {excess:.2g} of its own error"]
    rhs, passes = int(row["rhs"]), int(row["iterations"])
    if rhs:
        cost = f"cost: {plural(rhs, 'right-hand side')}, {plural(passes, 'Newton iteration')}"
        facts.append(f"{cost}, {1e3 * float(row['seconds']):.3g} ms")
    return facts


def _values(out: Console, title: str, values: Iterable[tuple[str, float]], units: Mapping[str, str]) -> None:
    rows = [[name, exact(value), with_unit(name, units)] for name, value in values]
    if rows:
        out.print()
        header = [title, "value", "unit" if any(row[2] for row in rows) else ""]
        table(out, header, rows, indent=4)


def _ranges(out: Console, branch: Branch, row: int, units: Mapping[str, str]) -> None:
    """Between which values each state moves on the orbit, where that is stored."""
    names = [name for name in branch.info.states if quantities.MAX + name in branch.info.observables]
    if not names or row >= len(branch):
        return
    ends = quantities.MIN, quantities.MAX
    moved = {name: [float(branch[end + name][row]) for end in ends] for name in names}
    rows = [
        [name, *("none" if value != value else exact(value) for value in both), with_unit(name, units)]
        for name, both in moved.items()
    ]
    header = ["over the orbit", "least", "largest", "unit" if any(row[-1] for row in rows) else ""]
    out.print()
    table(out, header, rows, indent=4)
    if any(value != value for both in moved.values() for value in both):
        out.print("    none: of an angle that goes round, or a state that never exists on the orbit")


def _spectrum(out: Console, branch: Branch, spectrum: Iterable[complex], which: str) -> None:
    orbit = branch.info.settings.get("of_problem", branch.info.problem) != "equilibrium"
    numbers = [complex(number) for number in spectrum]
    rows = [[exact(n.real), exact(n.imag), *([exact(abs(n))] if orbit else [])] for n in numbers if n == n]
    if rows:
        out.print()
        name = "multipliers" if orbit else "eigenvalues"
        table(out, [f"{name}{which}: real", "imaginary", *(["modulus"] if orbit else [])], rows, indent=4)


def _text(value: Any) -> str:
    return exact(value) if isinstance(value, float) else str(value)
