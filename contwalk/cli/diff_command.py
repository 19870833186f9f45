"""`contwalk diff`: two databases beside each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from contwalk.comparing.databases import Compared, Comparison


@click.command("diff")
@click.argument("a", metavar="A")
@click.argument("b", metavar="B")
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
def command(a: str, b: str, as_json: bool) -> int:
    """Compare the databases A and B: what differs beyond the errors that both claim.

    Branches are matched by what they are, not by name: pieces, directions and order may differ. No plugin
    is run.

    Exit codes: 0 if they are the same, or differ in counts of points and cost alone; 1 if something differs;
    2 for a file that cannot be read.
    """
    from contwalk.comparing.databases import diff

    found = diff(a, b)
    if as_json:
        _print_json(found)
    else:
        _print(found)
    return 0 if found.same else 1


def _print_json(found: Comparison) -> None:
    import json

    from contwalk.comparing.document import document_of

    click.echo(json.dumps(document_of(found), indent=2, allow_nan=False))


def _print(found: Comparison) -> None:
    from contwalk.cli.terminal import console, line, table
    from contwalk.number_words import plural

    out = console()
    line(out, f"A: {found.a}")
    line(out, f"B: {found.b}")
    for note in found.notes:
        line(out, note)
    header = ["A", "B", "points A", "B", "evaluations A", "B", "seconds A", "B", ""]
    table(out, header, [_row(each) for each in found.branches], right=range(2, 8))
    for each in found.all_differences:
        line(out, f"- {each.text}")
    number = len(found.all_differences)
    line(out, "The same within errors." if found.same else f"{plural(number, 'difference')}.")


def _row(compared: Compared) -> list[str]:
    from contwalk.number_words import plural

    numbers = [*map(str, compared.points), *map(str, compared.rhs), *(f"{s:.2f}" for s in compared.seconds)]
    said = plural(len(compared.differences), "difference") if compared.differences else "the same"
    return [" + ".join(compared.a) or "-", " + ".join(compared.b) or "-", *numbers, said]
