"""A run in a few lines: its branches, how they ended, and their special points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.cli.terminal import line, table
from contwalk.labels import UNDECIDED
from contwalk.number_words import choices, exact, plural, rough, with_unit
from contwalk.signatures import folded, is_iterated, told_problem
from contwalk.special_point import nearest_to, told_sides, told_what
from contwalk.system.units import lasting
from contwalk.workflow.stored.point_words import free_value

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.branch import Branch


def print_branches(
    out: Console,
    system: str,
    model: Mapping[str, Any],
    branches: Sequence[Branch],
    among: Sequence[Branch],
    units: Mapping[str, str],
    errors_follow: bool = False,
) -> None:
    """Each of `branches`. Parameters that differ among all branches of the run (`among`) are named.

    `errors_follow`: why a start failed is told in full after this.
    """
    chosen = choices(model)
    line(out, system + (f" ({chosen})" if chosen else ""), style="bold")
    fixed = differing(among)
    for branch in branches:
        out.print()
        _print_branch(out, branch, among, fixed, with_unit("period", units), errors_follow)
    if not branches:
        line(out, "There are no branches.")


def print_made(out: Console, provenance: Mapping[str, Any]) -> None:
    """What a study is of and who has made it, where its run file says so."""
    description, author = provenance.get("description"), provenance.get("author")
    if description:
        line(out, str(description))
    if author:
        line(out, f"by {author}")


def print_notes(out: Console, notes: Sequence[str]) -> None:
    """Notes about the run as a whole."""
    if notes:
        out.print()
        for note in notes:
            line(out, f"note: {note}")


def print_where(out: Console, database: Path, figures: Sequence[Path], branches: Sequence[Branch]) -> None:
    """Where the results are, and what to do next."""
    import shlex

    out.print()
    line(out, f"database: {database}")
    for figure in figures:
        line(out, f"figure:   {figure}")
    if not any(len(branch) for branch in branches):  # nothing to look at
        return
    special = [f"{b.name}/{p.name}" for b in branches for p in b.special_points if p.label != "EP"]
    show = ["contwalk", "show", str(database), *special[:1]]
    plot = ["contwalk", "plot", str(database), "-o", f"{database.stem}.png"]
    line(out, f"next:     {shlex.join(show)}")
    line(out, f"          {shlex.join(plot)}")


def _print_branch(
    out: Console,
    branch: Branch,
    among: Sequence[Branch],
    fixed: Sequence[str],
    time: str,
    errors_follow: bool,
) -> None:
    info, outcome = branch.info, branch.outcome
    of = info.settings.get("of")
    words = [told_problem(info.problem_by_name) + (f" of {of}" if of else "")]
    for name in info.free if len(branch) else ():
        words.append(f"{name} from {branch[name].min():.6g} to {branch[name].max():.6g}")
    words += [plural(len(branch), "point"), f"{branch.cost.get('seconds', 0.0):.3g} s"]
    rhs = int(branch.cost.get("rhs", 0))
    words += [plural(rhs, "right-hand side")] if rhs else []
    line(out, f"{branch.name}  {', '.join(words)}", style="bold")
    if info.origin:
        line(out, info.origin, indent=4)
    if info.parent is not None:
        line(out, f"parent: {_parent(info.parent, among)}", indent=4)
    if len(branch) and branch.info.problem in ("periodic_orbit", "hybrid_orbit"):
        line(out, _orbits(branch, time), indent=4)
    if len(branch) and (unknown := branch["stable"] < 0).any():
        line(out, _not_known(branch, unknown), indent=4)
    if info.signature and not is_iterated(info.signature):
        line(out, f"signature: {folded(info.signature)}", indent=4)
    shown = [name for name in fixed if name not in info.free]
    if shown:
        line(out, ", ".join(f"{name} = {info.parameters[name]!r}" for name in shown), indent=4)
    style = "red" if outcome.status == "failed" else ""
    shown_later = errors_follow and outcome.status == "failed" and not len(branch)
    said = "see the error below" if shown_later else outcome.message
    line(out, f"{outcome.status} ({outcome.reason}): {said}", indent=4, style=style)
    _print_special(out, branch)


def _orbits(branch: Branch, time: str) -> str:
    """Periods and closure of a branch of orbits, and the worst error of their trivial multiplier."""
    info, fold = branch.info, int(branch.info.settings.get("fold", 1))
    periods = fold * branch.points["period"]
    text = f"period from {np.nanmin(periods):.6g} to {lasting(np.nanmax(periods), time)}"
    if info.closure not in (None, "full"):
        text += f", 1/{fold} of it integrated: closed up to '{info.closure}'"
    if info.subharmonic > 1 and not is_iterated(info.signature):
        text += f", {info.subharmonic} of the forcing"
    # Where a branch is born at a Hopf point, the orbit is a point still and has no direction of flow.
    trivial = branch.points["trivial_error"][branch.points["s"] != 0.0]
    if np.isfinite(trivial).any():
        text += f"; trivial multiplier right to {np.nanmax(trivial):.1e}"
    return text


def _not_known(branch: Branch, unknown: np.ndarray) -> str:
    """At how many points of a branch stability is not known, and where; `unknown` has the shape (k,)."""
    free = branch.info.free[0]
    values = branch[free][unknown]
    where = (
        f"{free} = {values[0]:.6g}"
        if len(values) == 1
        else f"{free} {values.min():.6g} to {values.max():.6g}"
    )
    return (
        f"{UNDECIDED} at {len(values)} of {plural(len(branch), 'point')} ({where}): an eigenvalue or "
        "multiplier is within its error of where it changes"
    )


def _print_special(out: Console, branch: Branch) -> None:
    if not branch.special_points:
        return
    further = branch.info.free[1:]
    header = ["name", "what", branch.info.free[0], *further, "error", "criticality", "unstable"]
    rows = [
        [
            point.name,
            told_what(point),
            exact(free_value(branch, point)),
            *(exact(float(point.parameters[name])) for name in further),
            rough(point.error),
            point.criticality or "",
            told_sides(point),
        ]
        for point in branch.special_points
    ]
    table(out, header, rows, indent=4)
    for point in branch.special_points:
        if point.note and point.label != "EP":  # why a branch ends is said above
            line(out, f"{point.name}: {point.note}", indent=4)
        if not point.admissible:
            line(out, f"{point.name}: not admissible", indent=4)


def _parent(parent: tuple[str, float], among: Sequence[Branch]) -> str:
    """`b1/HB1`: the special point of the parent that a branch left."""
    name, s = parent
    points = (point for branch in among if branch.name == name for point in branch.special_points)
    point = nearest_to(points, s)
    return name if point is None else f"{name}/{point.name}"


def differing(branches: Sequence[Branch]) -> list[str]:
    """Parameters that are fixed at different values on different branches, as in a sweep."""
    values: dict[str, set[float]] = {}
    for branch in branches:
        for name, value in branch.info.parameters.items():
            if name not in branch.info.free:
                values.setdefault(name, set()).add(float(value))
    # On a path every parameter may move; its values at the start say nothing.
    on_path = any("path" in branch.info.free for branch in branches)
    return [] if on_path else [name for name, found in values.items() if len(found) > 1]
