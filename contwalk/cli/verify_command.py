"""`contwalk verify`: the special points of a database, computed once more."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from contwalk.cli.bar import bar
from contwalk.cli.stored_system import required_system, trust_option

if TYPE_CHECKING:
    from contwalk.branch import Branch, SpecialPoint
    from contwalk.storage import Database, RunHeader
    from contwalk.studies.comparison import Comparison
    from contwalk.system import System

METHODS = ("dop853", "verner98", "radau5", "radau9")


@click.command("verify")
@click.argument("db")
@click.argument("what", metavar="[BRANCH|BRANCH/POINT]", required=False)
@click.option(
    "--method", type=click.Choice(METHODS), help="The integrator; by default another one than used."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
@trust_option
def command(db: str, what: str | None, method: str | None, as_json: bool, trust: bool) -> int:
    """Recompute every located special point of the database DB, and compare.

    Orbits are computed with another integrator at a tolerance far below the stored error, equilibria from
    another start with residuals of 40 digits. A point agrees if both values differ by no more than 5 times
    the sum of their error estimates, and by no more than the accuracy that the run file asked for.

    Exit codes: 0 if all agree; 1 if one does not, or could not be checked; 2 for bad input.
    """
    from contwalk.storage import open_database

    # What a plugin prints is no part of the document.
    with contextlib.redirect_stdout(sys.stderr) if as_json else contextlib.nullcontext():
        with open_database(db) as database:
            points = _chosen(database, what or "")
            system = required_system(database, trust)
            header = database.header
        from contwalk.studies.comparison import AGREES, ELSEWHERE

        found = _compared(system, header, points, method or "", as_json)
    if as_json:
        _print_json(db, header, found)
    else:
        _print(header, found)
    enough = (AGREES,) if what else (AGREES, ELSEWHERE)  # the parent is among all branches
    return 0 if all(comparison.verdict in enough for comparison in found) else 1


def _chosen(database: Database, what: str) -> list[tuple[Branch, SpecialPoint]]:
    """The points that are asked for: all, those of a branch, or one."""
    from contwalk.cli.point_page import special_of
    from contwalk.workflow.verifying import points_of

    branch_name, _, point_name = what.partition("/")
    if point_name:
        branch = database.branch(branch_name)
        return [(branch, special_of(branch, point_name))]
    return points_of([database.branch(branch_name)] if branch_name else database.branches())


def _compared(
    system: System,
    header: RunHeader,
    points: Sequence[tuple[Branch, SpecialPoint]],
    method: str,
    silent: bool,
) -> list[Comparison]:
    """All comparisons, with a bar where somebody watches."""
    from contwalk.workflow.verifying import verify

    with bar("points", len(points), silent) as move:
        return verify(
            system,
            header,
            points,
            method,
            move and (lambda done: move(advance=1, description=f"{done.branch}/{done.point}")),
        )


def _print(header: RunHeader, found: Sequence[Comparison]) -> None:
    from contwalk.cli.terminal import console, line, table
    from contwalk.cli.words import exact, plural, rough
    from contwalk.studies.comparison import AGREES, SKIPPED, SLACK

    out = console()
    if not found:
        line(out, "There is no special point to recompute.")
        return
    rows = [
        [
            f"{each.branch}/{each.point}",
            each.quantity,
            exact(each.stored),
            "" if math.isnan(each.recomputed) else exact(each.recomputed),
            rough(each.difference),
            rough(each.stored_error),
            rough(each.own_error),
            each.method,
            each.verdict,
        ]
        for each in found
    ]
    header_ = ["point", "quantity", "stored", "recomputed", "difference", "stored error"]
    table(out, [*header_, "own error", "by", "verdict"], rows)
    for each in found:
        if each.reason:
            line(out, f"{each.branch}/{each.point}: {each.reason}")
    out.print()
    failed, skipped = sum(c.failed for c in found), sum(c.verdict == SKIPPED for c in found)
    agree = sum(c.verdict == AGREES for c in found)
    others = (
        f", {elsewhere} checked at the parent" if (elsewhere := len(found) - failed - skipped - agree) else ""
    )
    others += f", {failed} DISAGREE" if failed else ""
    others += f", {skipped} NOT CHECKED" if skipped else ""
    line(out, f"{agree} of {plural(len(found), 'point')} agree{others}.")
    if skipped:
        line(out, f"{plural(skipped, 'point')} could not be checked; the reasons are above.")
    accuracy = header.provenance.get("accuracy", float("nan"))
    line(
        out,
        f"A point agrees if it differs by at most {SLACK:g} times both errors together, and by at most the "
        f"accuracy that was asked for, {accuracy:g} of its value.",
    )


def _print_json(db: str, header: RunHeader, found: Sequence[Comparison]) -> None:
    import json
    from dataclasses import asdict

    from contwalk.studies.comparison import SKIPPED, SLACK

    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    points = [{k: plain(v) for k, v in asdict(each).items()} | {"failed": each.failed} for each in found]
    shown = {
        "database": db,
        "accuracy": header.provenance.get("accuracy"),
        "slack": SLACK,
        "agree": not any(each.failed for each in found),
        "not_checked": sum(each.verdict == SKIPPED for each in found),
        "points": points,
    }
    click.echo(json.dumps(shown, indent=2, allow_nan=False))
