"""`contwalk verify`: what a database says, recomputed from its own words."""

from __future__ import annotations

import contextlib
import math
import sys
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from contwalk.cli.bar import bar
from contwalk.cli.stored_system import required_system, trust_option

if TYPE_CHECKING:
    from contwalk.storage import Database, RunHeader
    from contwalk.system import System
    from contwalk.verification.checking import Record
    from contwalk.verification.finding import Finding

# Where an honest error estimate leaves the quotient of difference and error, and where it may be told.
_QUOTIENTS = ((0.1, "below 0.1"), (1.0, "0.1 to 1"), (5.0, "1 to 5"), (math.inf, "above 5"))


@click.command("verify")
@click.argument("db")
@click.argument("what", metavar="[BRANCH|BRANCH/POINT|BRANCH/ROW]", required=False)
@click.option(
    "--budget",
    metavar="SECONDS",
    type=click.FloatRange(min=0.0, min_open=True),
    help="CPU that is taken at most; by default twice that of the run, and at least 10 seconds.",
)
@click.option("--strict", is_flag=True, help="Exit code 1 as well where a special point cannot be told.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
@trust_option
def command(db: str, what: str | None, budget: float | None, strict: bool, as_json: bool, trust: bool) -> int:
    """Recompute what the database DB says: special points, ends of branches, and every tenth row; of margins
    the borders of survival, and every tenth place of a plane.

    Each record is recomputed from its own words, by SciPy's integrators and with nothing of the engine that
    made it. It AGREES if both values differ by no more than 5 times the sum of their errors; it DISAGREES; or
    verify CANNOT TELL, and says why. A check that is not sharp enough to see 100 errors is none.

    Exit codes: 0 if nothing disagrees; 1 if a record does; 2 for bad input.
    """
    from contwalk.storage import open_database
    from contwalk.storage.trajectory import is_of_margins

    # What a plugin prints is no part of the document.
    with contextlib.redirect_stdout(sys.stderr) if as_json else contextlib.nullcontext():
        if is_of_margins(db):
            found, asked = _pushed(db, what or "", budget, as_json, trust)
        else:
            with open_database(db) as database:
                records, seconds = _chosen(database, what or "")
                system = required_system(database, trust)
                header = database.header
            found = _checked(system, header, records, seconds if budget is None else budget, as_json)
            asked = len(records)
    if as_json:
        _print_json(db, found)
    else:
        _print(found, asked)
    from contwalk.verification.finding import AGREES

    unsure = strict and any(each.verdict != AGREES and each.of_point for each in found)
    return 1 if unsure or any(each.failed for each in found) else 0


def _chosen(database: Database, what: str) -> tuple[list[Record], float]:
    """The records that are asked for (all, those of a branch, or one), and what they may cost."""
    from contwalk.cli.point_page import special_of
    from contwalk.verification.checking import records_of
    from contwalk.workflow.verifying import budget_of

    branch_name, _, record = what.partition("/")
    branches = [database.branch(branch_name)] if branch_name else database.branches()
    if not record:
        return records_of(branches), budget_of(branches)
    (branch,) = branches
    if record.isdecimal() and int(record) < len(branch):
        return [(branch, int(record))], budget_of(branches)
    return [(branch, special_of(branch, record))], budget_of(branches)


def _pushed(
    db: str, what: str, seconds: float | None, silent: bool, trust: bool
) -> tuple[list[Finding], int]:
    """All findings of a file of margins, and how many numbers were to be recomputed."""
    from contwalk.cli.entry import say
    from contwalk.errors import ContwalkError
    from contwalk.workflow.verifying import budget_of
    from contwalk.workflow.verifying_margins import records_of, stored_margins, verified_margins

    stored, changed = stored_margins(db, trust)
    if changed:
        say(f"warning: {changed} What is computed with it may differ from what is stored.")
    parts = records_of(stored)
    if what and what not in parts:
        raise ContwalkError(f"{db} has no '{what}'.", f"Allowed: {', '.join(parts)}.")
    asked = sum(count for part, count in parts.items() if what in ("", part))
    with bar("pushes", asked, silent) as move:
        found = verified_margins(
            stored,
            what,
            budget_of([]) if seconds is None else seconds,
            move and (lambda done: move(advance=1, description=f"{done.branch}/{done.record}")),
        )
    return found, asked


def _checked(
    system: System, header: RunHeader, records: Sequence[Record], seconds: float, silent: bool
) -> list[Finding]:
    """All findings, with a bar where somebody watches."""
    from contwalk.verification.checking import checked
    from contwalk.workflow.verifying import ranges_of

    with bar("records", len(records), silent) as move:
        return checked(
            system,
            records,
            ranges_of(header),
            seconds,
            move and (lambda done: move(advance=1, description=f"{done.branch}/{done.record}")),
        )


def _print(found: Sequence[Finding], asked: int) -> None:
    from contwalk.cli.terminal import console, line, table
    from contwalk.number_words import exact, plural, rough
    from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES

    out = console()
    if not found:
        line(out, "There is nothing to recompute.")
        return
    shown = [each for each in found if each.of_point or each.verdict == DISAGREES]
    rows = [
        [
            f"{each.branch}/{each.record}",
            each.quantity,
            *("" if math.isnan(value) else exact(value) for value in (each.stored, each.recomputed)),
            rough(each.difference),
            rough(each.stored_error),
            rough(each.own_error),
            each.method,
            each.verdict,
        ]
        for each in shown
    ]
    header_ = ["record", "quantity", "stored", "recomputed", "difference", "stored error"]
    if rows:
        table(out, [*header_, "own error", "by", "verdict"], rows)
    for branch, record, reason in dict.fromkeys((e.branch, e.record, e.reason) for e in found if e.reason):
        line(out, f"{branch}/{record}: {reason}")
    out.print()
    for name in dict.fromkeys(each.branch for each in found):
        line(out, _of_rows(name, [each for each in found if each.branch == name and each.of_row]))
    _print_quotients(out, found)
    count = Counter(each.verdict for each in found)
    others = "".join(f", {count[word]} {word}" for word in (DISAGREES, CANNOT_TELL) if count[word])
    line(out, f"{count[AGREES]} of {plural(len(found), 'number')} agree{others}.")
    left = asked - len({(each.branch, each.record) for each in found})
    if left:
        line(out, f"{plural(left, 'row')} of those that were to be recomputed did not fit into --budget.")


def _of_rows(name: str, rows: Sequence[Finding]) -> str:
    """How many rows of a branch were recomputed, and what came out."""
    from contwalk.number_words import plural
    from contwalk.verification.finding import AGREES

    if not rows:
        return f"{name}: no row was recomputed."
    agree = sum(each.verdict == AGREES for each in rows)
    count = plural(len({each.record for each in rows}), "row")
    return f"{name}: {count} recomputed; {agree} of {plural(len(rows), 'number')} agree."


def _print_quotients(out: Any, found: Sequence[Finding]) -> None:
    """How large differences are beside the stored errors: whether these are honest."""
    from contwalk.cli.terminal import line

    known = [each.quotient for each in found if not math.isnan(each.quotient)]
    if not known:
        return
    counts, low = [], -1.0
    for high, words in _QUOTIENTS:
        counts.append(f"{words}: {sum(low < value <= high for value in known)}")
        low = high
    line(out, f"Differences over stored errors: {', '.join(counts)}.")


def _print_json(db: str, found: Sequence[Finding]) -> None:
    import json
    from dataclasses import asdict

    from contwalk.verification.finding import CANNOT_TELL, SLACK

    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    def document(each: Finding) -> dict[str, Any]:
        own = {"point" if key == "record" else key: plain(value) for key, value in asdict(each).items()}
        return own | {"quotient": plain(each.quotient), "failed": each.failed}

    shown = {
        "database": db,
        "slack": SLACK,
        "agree": not any(each.failed for each in found),
        "cannot_tell": sum(each.verdict == CANNOT_TELL for each in found),
        "points": [document(each) for each in found if each.of_point],
        "ends": [document(each) for each in found if each.of_end],
        "rows": [document(each) for each in found if each.of_row],
    }
    click.echo(json.dumps(shown, indent=2, allow_nan=False))
