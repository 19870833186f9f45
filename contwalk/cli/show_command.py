"""`contwalk show`: what a database holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from contwalk.cli.stored_system import optional_system, trust_option, units_of_run

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.branch import Branch
    from contwalk.storage import Database, FileDatabase


@click.command("show")
@click.argument("db")
@click.argument("what", metavar="[BRANCH|BRANCH/POINT]", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
@click.option("--points", is_flag=True, help="Include every point of each branch.")
@trust_option
def command(db: str, what: str | None, as_json: bool, points: bool, trust: bool) -> None:
    """Show the database DB: its branches, or one of them, or everything about one point.

    A point is named as b1/HB1, or by its number along the branch as b1/12.
    """
    from contwalk.storage import open_database

    branch_name, _, point_name = (what or "").partition("/")
    with open_database(db) as database:
        if as_json:
            _print_json(database, branch_name, point_name, points)
        else:
            _print_text(database, branch_name, point_name, points, trust)


def _print_json(database: Database, branch_name: str, point_name: str, points: bool) -> None:
    import json

    from contwalk.cli.point_page import row_of, special_of
    from contwalk.storage import document

    only = [branch_name] if branch_name else None
    if not point_name:
        shown = document(database, points, only)
    else:
        branch = database.branch(branch_name)
        row = row_of(branch, point_name)
        index = special_of(branch, point_name).index if row is None else row
        shown = document(database, points or row is not None, only)
        _keep_point(shown["branches"][0], index, None if row is not None else point_name)
    click.echo(json.dumps(shown, indent=2, allow_nan=False))


def _keep_point(entry: dict[str, Any], index: int, name: str | None) -> None:
    """Leave only one point in a branch of the document: the named one, or all that is known of a row."""
    entry["special_points"] = [
        point
        for point in entry["special_points"]
        if (point["index"] == index if name is None else point["name"] == name)
    ]
    if "points" in entry:
        entry["points"] = entry["points"][index : index + 1]


def _print_text(database: FileDatabase, branch_name: str, point_name: str, points: bool, trust: bool) -> None:
    from contwalk.cli.summary import print_branches, print_made, print_notes
    from contwalk.cli.terminal import console

    out = console()
    if point_name:
        _print_point(out, database, branch_name, point_name, trust)
        return
    among = database.branches()
    chosen = [database.branch(branch_name)] if branch_name else among
    units = database.header.provenance.get("units") or {}
    print_made(out, database.header.provenance)
    print_branches(out, database.header.system, database.header.model, chosen, among, units)
    if points:
        for branch in chosen:
            _print_points(out, branch)
    if not branch_name:
        print_notes(out, list(dict.fromkeys(database.notes().values())))


def _print_point(
    out: Console, database: FileDatabase, branch_name: str, point_name: str, trust: bool
) -> None:
    from contwalk.cli.point_page import print_point, stored_point

    branch = database.branch(branch_name)
    point = stored_point(branch, f"{branch_name}/{point_name}")
    units = units_of_run(database, trust)
    hybrid = branch.info.problem_by_name == "hybrid_orbit"
    system = optional_system(database, trust, "segments and margins of the orbit") if hybrid else None
    print_point(out, branch, point, units, system)


def _print_points(out: Console, branch: Branch) -> None:
    """Every point in a line: free parameters, observables, states, stability."""
    from contwalk import quantities
    from contwalk.cli.terminal import table
    from contwalk.special_point import told_count

    # Extremes of states, and states at later events, would treble the columns: --json and export have them.
    observables = [name for name in branch.info.observables if not quantities.of_orbit(name)]
    names = list(dict.fromkeys((*branch.info.free, *observables, *branch.info.states)))
    special = {point.index: point.name for point in reversed(branch.special_points)}
    columns = [branch[name] for name in names]
    rows = [
        [
            str(row),
            special.get(row, ""),
            *[f"{column[row]:.10g}" for column in columns],
            told_count(int(branch["unstable"][row])),
        ]
        for row in range(len(branch))
    ]
    out.print()
    table(out, [branch.name, "", *names, "unstable"], rows)
