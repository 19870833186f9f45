"""Everything that is known of one point, in words: what `contwalk show` prints, and what a page shows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from contwalk import quantities
from contwalk.labels import UNDECIDED
from contwalk.number_words import exact, plural, rough, with_unit
from contwalk.signatures import is_iterated, told_problem
from contwalk.special_point import told_count, told_sides, told_what
from contwalk.workflow.stored.hybrid_words import (
    PointWords,
    TableOfWords,
    admissible_line,
    margin_table,
    meaning_line,
    segment_tables,
    signature_line,
)

if TYPE_CHECKING:
    import numpy as np

    from contwalk.branch import Branch, SpecialPoint
    from contwalk.system import System
    from contwalk.workflow.stored.hybrid_facts import HybridFacts


def special_words(
    branch: Branch,
    point: SpecialPoint,
    units: Mapping[str, str],
    hybrid: HybridFacts | None = None,
    system: System | None = None,
) -> PointWords:
    """A special point: where it is, what happens there, and the numbers that say so.

    `hybrid` are the facts of an orbit with events, where they are known.
    """
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
    tables = [
        *segment_tables(hybrid, with_unit("period", units)),
        *_values("parameter", point.parameters.items(), units),
        *_values("state", point.state.items(), units),
        *_ranges(branch, point.index, units),
    ]
    if hybrid is not None:
        tables.append(margin_table(hybrid))
    elif not is_iterated(branch.info.signature):
        tables += _values("margin", point.margin.items(), {})
    tables += _spectrum(branch, point.spectrum, "")
    tables += _spectrum(branch, point.spectrum_full or (), " of the full orbit")
    if point.coefficients:
        rows = [[name, _text(value)] for name, value in point.coefficients.items()]
        tables.append(TableOfWords(["coefficient", ""], rows))
    return PointWords(f"{branch.name}/{point.name}  {told_what(point)}", facts, tables)


def row_words(
    branch: Branch, row: int, units: Mapping[str, str], hybrid: HybridFacts | None = None
) -> PointWords:
    """Any other stored point."""
    info, point = branch.info, branch.points[row]
    stable = {1: "stable", 0: "not stable"}.get(int(point["stable"]), UNDECIDED)
    counted = f"unstable directions: {told_count(int(branch['unstable'][row]))} ({stable})"
    period, trivial = float(point["period"]), float(point["trivial_error"])
    known = None if math.isnan(trivial) else trivial
    facts = _of_orbit(branch, period, known, units) if period > 0.0 else []
    can = admissible_line(bool(point["admissible"]), branch, hybrid)
    facts = [counted, *can, *signature_line(branch), *facts, *_cost(point)]
    tables = [
        *segment_tables(hybrid, with_unit("period", units)),
        *_values("parameter", branch.parameters_at(row).items(), units),
        *_values("state", zip(info.states, point["state"], strict=True), units),
        *_ranges(branch, row, units),
    ]
    named = {margin.name for margin in hybrid.margins} if hybrid is not None else set()
    observables = [
        (name, value)
        for name, value in zip(info.observables, point["observables"], strict=True)
        if name not in named and not quantities.of_orbit(name)
    ]
    tables += _values("observable", observables, units)
    tables += [] if hybrid is None else [margin_table(hybrid)]
    tables += _spectrum(branch, point["spectrum"], "")
    return PointWords(f"{branch.name}/{row}  point of {told_problem(info.problem_by_name)}", facts, tables)


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


def _values(title: str, values: Iterable[tuple[str, float]], units: Mapping[str, str]) -> list[TableOfWords]:
    """A table of values by name; none where there are none."""
    rows = [[name, exact(value), with_unit(name, units)] for name, value in values]
    header = [title, "value", "unit" if any(row[2] for row in rows) else ""]
    return [TableOfWords(header, rows)] if rows else []


def _ranges(branch: Branch, row: int, units: Mapping[str, str]) -> list[TableOfWords]:
    """Between which values each state moves on the orbit, where that is stored."""
    names = [name for name in branch.info.states if quantities.MAX + name in branch.info.observables]
    if not names or row >= len(branch):
        return []
    ends = quantities.MIN, quantities.MAX
    moved = {name: [float(branch[end + name][row]) for end in ends] for name in names}
    rows = [
        [name, *("none" if value != value else exact(value) for value in both), with_unit(name, units)]
        for name, both in moved.items()
    ]
    header = ["over the orbit", "least", "largest", "unit" if any(row[-1] for row in rows) else ""]
    lacking = any(value != value for both in moved.values() for value in both)
    remark = "none: of an angle that goes round, or a state that never exists on the orbit"
    return [TableOfWords(header, rows, remark if lacking else "")]


def _spectrum(branch: Branch, spectrum: Iterable[complex], which: str) -> list[TableOfWords]:
    """Eigenvalues or multipliers; no table where none is known."""
    orbit = branch.info.settings.get("of_problem", branch.info.problem) != "equilibrium"
    numbers = [complex(number) for number in spectrum]
    rows = [[exact(n.real), exact(n.imag), *([exact(abs(n))] if orbit else [])] for n in numbers if n == n]
    name = "multipliers" if orbit else "eigenvalues"
    header = [f"{name}{which}: real", "imaginary", *(["modulus"] if orbit else [])]
    return [TableOfWords(header, rows)] if rows else []


def _text(value: Any) -> str:
    return exact(value) if isinstance(value, float) else str(value)


def free_value(branch: Branch, point: SpecialPoint) -> float:
    """The free parameter at a special point; on a path it is known from the point's row."""
    name = branch.info.free[0]
    if name in point.parameters:
        return float(point.parameters[name])
    return float(branch[name][point.index])
