"""Branches and special points in a line of text, and as tables of HTML for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contwalk.labels import MEANINGS

if TYPE_CHECKING:
    from contwalk.branch import Branch, SpecialPoint

Table = list[list[str]]  # the first row is the head


def told_branch(branch: Branch) -> str:
    """`b2: 64 points, periodic orbit, delta 0.003 to 0.006; PD1 UZ1; complete (bound)`."""
    info, outcome = branch.info, branch.outcome
    parts = [
        f"{info.name}: {len(branch)} point{'' if len(branch) == 1 else 's'}, {info.problem.replace('_', ' ')}"
    ]
    if len(branch) and info.free:
        values = branch[info.free[0]]
        parts[0] += f", {info.free[0]} {values.min():.6g} to {values.max():.6g}"
    parts.append(_names([point.name for point in branch.special_points]))
    parts.append(f"{outcome.status} ({outcome.reason})")
    return "; ".join(part for part in parts if part)


def _names(names: Sequence[str], most: int = 8) -> str:
    """Names of special points; the first ones of many."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return " ".join(names[:most]) + more


def told_point(point: SpecialPoint) -> str:
    """`PD1: period doubling, supercritical, located, error 3e-12`."""
    parts = [MEANINGS.get(point.label, point.label), point.kind, point.criticality, point.status]
    error = f"error {point.error:.1e}" if point.error is not None else None
    said = ", ".join(part for part in (*parts, error) if part)
    return f"{point.name or point.label}: {said}"


def of_special_points(branch: Branch) -> Table:
    """The special points of a branch, one a row."""
    free = branch.info.free[0] if branch.info.free else ""
    rows = [["name", "what", free, "error", "criticality", "unstable"]]
    for point in branch.special_points:
        value = point.parameters.get(free, float(branch[free][point.index]) if free and len(branch) else None)
        what = MEANINGS.get(point.label, point.label) + (f" ({point.kind})" if point.kind else "")
        rows.append(
            [
                point.name,
                what if point.status == "located" else f"{what}, NOT LOCATED",
                "" if value is None else f"{value:.12g}",
                "" if point.error is None else f"{point.error:.1e}",
                point.criticality or "",
                f"{point.unstable_before} \u2192 {point.unstable_after}",
            ]
        )
    return rows


def of_point(point: SpecialPoint) -> Table:
    """What is known of one special point."""
    rows = [[told_point(point), ""]]
    rows += [[name, f"{value:.12g}"] for name, value in {**point.parameters, **point.state}.items()]
    if point.period is not None:
        rows.append(["period", f"{point.period:.12g}"])
    for number, value in enumerate(point.spectrum, start=1):
        text = f"{value.real:.8g}" + (f"{value.imag:+.8g}i" if value.imag else "")
        rows.append([f"eigenvalue or multiplier {number}", text])
    if point.note:
        rows.append(["note", point.note])
    return rows


def of_branches(branches: Sequence[Branch]) -> Table:
    """Branches, one a row."""
    rows = [["branch", "problem", "points", "range", "special points", "ended", "origin"]]
    for branch in branches:
        info, free = branch.info, branch.info.free[0] if branch.info.free else ""
        span = ""
        if free and len(branch):
            span = f"{free} {branch[free].min():.6g} to {branch[free].max():.6g}"
        names = _names([point.name for point in branch.special_points])
        ended = f"{branch.outcome.status} ({branch.outcome.reason})"
        rows.append(
            [info.name, info.problem.replace("_", " "), str(len(branch)), span, names, ended, info.origin]
        )
    return rows


def html(caption: str, rows: Table) -> str:
    """A table of HTML; what is written in it is text, whatever it holds."""
    import html as escaping  # for notebooks alone

    head, *body = [[escaping.escape(cell) for cell in row] for row in rows]
    lines = ["<table>"]
    lines += [f"<caption>{escaping.escape(caption)}</caption>"] if caption else []
    lines.append("<thead><tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr></thead>")
    lines.append("<tbody>")
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in body]
    return "\n".join([*lines, "</tbody>", "</table>"])
