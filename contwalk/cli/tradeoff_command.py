"""`contwalk tradeoff`: what accuracy costs in a study, measured."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.workflow.run_file.reading import RunFile
    from contwalk.workflow.tradeoff import Tradeoff

METHODS = ("auto", "dop853", "verner98", "radau5", "radau9", "collocation")


@click.command("tradeoff")
@click.argument("file")
@click.option("--accuracies", metavar="1e-4,1e-6", help="Accuracies to try.  [default: 1e-4,1e-6,1e-8,1e-10]")
@click.option(
    "--methods", metavar="dop853,auto", help="Integrators, or collocation.  [default: dop853,verner98,auto]"
)
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file.")
@click.option("--output", metavar="X.h5", help="Base of the files' names, instead of the run file's output.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option("--no-figures", is_flag=True, help="Write the table only.")
def command(
    file: str,
    accuracies: str | None,
    methods: str | None,
    overrides: tuple[str, ...],
    output: str | None,
    force: bool,
    quiet: bool,
    no_figures: bool,
) -> int:
    """Run the study of the run file FILE over accuracies and integrators, and compare time and true error.

    The truth is a run a hundred times tighter than the tightest, itself recomputed with another integrator.
    With output X.h5 it writes X_tradeoff.csv and X_tradeoff.png; databases are temporary.

    Exit codes: 0; 1 if the promised accuracy was not met somewhere; 2 for bad input, with nothing written.
    """
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.tradeoff import ACCURACIES, refuse_existing_files, write
    from contwalk.workflow.tradeoff import METHODS as USUAL

    asked = ACCURACIES if accuracies is None else _numbers(accuracies)
    chosen = USUAL if methods is None else _methods(methods)
    run_file = read_run_file(file, overrides, output)
    refuse_existing_files(run_file, force, not no_figures)
    found = _measured(run_file, asked, chosen, quiet)
    files = write(run_file, found, not no_figures)
    if not quiet:
        _print(found, [str(path) for path in files])
    unsure = any(comparison.failed for comparison in found.checked)
    return 0 if all(trial.held for trial in found.trials) and not unsure else 1


def _numbers(text: str) -> tuple[float, ...]:
    try:
        return tuple(dict.fromkeys(float(number) for number in text.split(",")))
    except ValueError:
        raise ContwalkError(
            f"--accuracies {text}: this is not a list of numbers.",
            "Write them with commas, without spaces: 1e-4,1e-6.",
        ) from None


def _methods(text: str) -> tuple[str, ...]:
    from contwalk.system.declarations import nearest

    names = tuple(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in METHODS:
            raise ContwalkError(
                f"--methods {text}: there is no integrator '{name}'.",
                f"Allowed: {', '.join(METHODS)}. {nearest(name, METHODS)}".strip(),
            )
    return names


def _measured(
    run_file: RunFile, accuracies: tuple[float, ...], methods: tuple[str, ...], quiet: bool
) -> Tradeoff:
    from contwalk.workflow.tradeoff import measure

    if quiet or not sys.stderr.isatty():
        return measure(run_file, accuracies, methods)
    from contwalk.cli.terminal import console

    with console(stderr=True).status("...") as status:
        return measure(run_file, accuracies, methods, status.update)


def _print(found: Tradeoff, files: list[str]) -> None:
    from contwalk.cli.terminal import console, line, table
    from contwalk.cli.words import plural, rough

    out = console()
    rows = [
        [
            f"{t.accuracy:g}",
            t.method,
            f"{t.seconds:.2f}",
            str(t.rhs),
            rough(t.worst),
            "yes" if t.held else "NO",
            str(t.found),
            ", ".join(t.missing) or "-",
        ]
        for t in found.trials
    ]
    head = [
        "accuracy",
        "method",
        "CPU s",
        "right-hand sides",
        "worst error",
        "promise held",
        "found",
        "missing",
    ]
    table(out, head, rows, right=(0, 2, 3, 4, 6))
    for t in found.trials:
        where = f"accuracy {t.accuracy:g} with {t.method}"
        if t.failed:
            line(out, f"{where}: {t.failed}")
        if t.extra:
            line(out, f"{where}: {', '.join(t.extra)} is not in the truth")
    out.print()
    methods = ", ".join(dict.fromkeys(c.method for c in found.checked if c.method))
    line(
        out,
        f"Truth: {plural(len(found.truth), 'point')} at accuracy {found.truth_accuracy:g}, "
        f"recomputed by {methods}: they agree to {found.doubt:.1e}, and smaller errors are not told apart.",
    )
    for c in found.checked:
        if c.reason:
            line(out, f"{c.branch}/{c.point}: {c.verdict}, {c.reason}")
    line(out, found.recommendation)
    out.print()
    for path in files:
        line(out, f"{'figure' if path.endswith('.png') else 'table'}: {path}")
