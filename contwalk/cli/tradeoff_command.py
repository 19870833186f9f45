"""`contwalk tradeoff`: what accuracy, an integrator or a model costs in a study, measured."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.workflow.tradeoff.trials import Tradeoff, Trial

BRANCHES, MOTION, MARGINS = "continue", "simulate", "margins"
INTEGRATORS = ("dop853", "verner98", "radau5", "radau9")
METHODS = {BRANCHES: ("auto", *INTEGRATORS, "collocation"), MOTION: INTEGRATORS, MARGINS: INTEGRATORS}


@click.command("tradeoff")
@click.argument("file")
@click.option(
    "--of",
    "what",
    type=click.Choice((BRANCHES, MOTION, MARGINS)),
    default=BRANCHES,
    show_default=True,
    help="What is measured: the command whose part of the run file is run.",
)
@click.option("--accuracies", metavar="1e-4,1e-6", help="Accuracies to try.  [default: 1e-4,1e-6,1e-8,1e-10]")
@click.option(
    "--methods",
    metavar="dop853,auto",
    help="Integrators, or collocation.  [default: dop853,verner98,auto; of simulate the four integrators, of "
    "margins dop853,verner98]",
)
@click.option(
    "--model",
    "models",
    metavar="CHOICE=VALUE,...",
    multiple=True,
    help="Model choices to compare with the run file's own, instead of accuracies and integrators.",
)
@click.option(
    "--within",
    type=click.FloatRange(0.0, min_open=True),
    metavar="E",
    help="The relative error that is allowed.  [default: the run file's accuracy; of margins theirs; of "
    "models 0.01]",
)
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file.")
@click.option("--output", metavar="X.h5", help="Base of the files' names, instead of the run file's output.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option("--no-figures", is_flag=True, help="Write the table only.")
def command(
    *,
    file: str,
    what: str,
    accuracies: str | None,
    methods: str | None,
    models: tuple[str, ...],
    within: float | None,
    overrides: tuple[str, ...],
    output: str | None,
    force: bool,
    quiet: bool,
    no_figures: bool,
) -> int:
    """Run what the run file FILE asks for over accuracies and integrators, and compare time and true error.

    The truth is a run a hundred times tighter than the tightest, itself recomputed with another integrator.
    Runs are timed several times: settings whose times differ by no more than they scatter are a tie. With
    --of simulate the accuracies are tolerances and the errors those of the motion's end and last events; with
    --of margins those of the borders. With --model the study is run with other models, and the errors are how
    far its points move.

    With output X.h5 it writes X_tradeoff.csv and X_tradeoff.png; databases are temporary.

    Exit codes: 0; 1 if a promised accuracy was not met somewhere, or the truth is not sure; 2 for bad input,
    with nothing written.
    """
    from contwalk.workflow.tradeoff.files import refuse_existing_files, write

    if models and (what != BRANCHES or accuracies or methods):
        raise ContwalkError(
            "--model compares models with one accuracy and one integrator, those of the run file.",
            "Leave out --of, --accuracies and --methods; set them with --set accuracy=1e-6.",
        )
    chosen = None if methods is None else _methods(methods, METHODS[what])
    asked = None if accuracies is None else _numbers(accuracies)
    base, measure = _to_measure(file, what, overrides, output, models)
    refuse_existing_files(base, force, not no_figures)
    given: dict[str, Any] = {"wanted": within}
    if chosen is not None:
        given["methods"] = chosen
    if asked is not None:
        given["tolerances" if what != BRANCHES else "accuracies"] = asked
    found = _measured(measure, given, quiet)
    files = write(base, found, not no_figures)
    if not quiet:
        _print(found, [str(path) for path in files])
    kept = not found.kind.promises or all(found.held(trial) for trial in found.trials)
    return 0 if kept and found.sure else 1


def _to_measure(
    file: str, what: str, overrides: tuple[str, ...], output: str | None, models: Sequence[str]
) -> tuple[Path, Any]:
    """The base of the names of files, and what measures; it takes keywords."""
    from functools import partial

    if what == MOTION:
        from contwalk.workflow.run_file.simulate import read_simulation
        from contwalk.workflow.tradeoff.motion import measure_motion

        motion = read_simulation(file, overrides, output)
        return motion.output, partial(measure_motion, motion)
    if what == MARGINS:
        from contwalk.workflow.run_file.margins import read_margins
        from contwalk.workflow.tradeoff.margins import measure_margins

        pushed = read_margins(file, overrides, output)
        return pushed.output, partial(measure_margins, pushed)
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.tradeoff.branches import measure
    from contwalk.workflow.tradeoff.models import measure_models

    run_file = read_run_file(file, overrides, output)
    if not models:
        return run_file.output, partial(measure, run_file)
    variants = [
        (text, read_run_file(file, (*overrides, *(f"model.{choice}" for choice in text.split(","))), output))
        for text in dict.fromkeys(models)
    ]
    return run_file.output, partial(measure_models, run_file, variants)


def _numbers(text: str) -> tuple[float, ...]:
    try:
        return tuple(dict.fromkeys(float(number) for number in text.split(",")))
    except ValueError:
        raise ContwalkError(
            f"--accuracies {text}: this is not a list of numbers.",
            "Write them with commas, without spaces: 1e-4,1e-6.",
        ) from None


def _methods(text: str, allowed: Sequence[str]) -> tuple[str, ...]:
    from contwalk.system.declarations import nearest

    names = tuple(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in allowed:
            raise ContwalkError(
                f"--methods {text}: there is no integrator '{name}'.",
                f"Allowed: {', '.join(allowed)}. {nearest(name, allowed)}".strip(),
            )
    return names


def _measured(measure: Any, given: dict[str, Any], quiet: bool) -> Tradeoff:
    if quiet or not sys.stderr.isatty():
        return measure(**given)
    from contwalk.cli.terminal import console

    with console(stderr=True).status("...") as status:
        return measure(**given, progress=status.update)


def _print(found: Tradeoff, files: list[str]) -> None:
    from contwalk.cli.terminal import console, line, table
    from contwalk.workflow.tradeoff.sentences import digits, recommendation
    from contwalk.workflow.tradeoff.trials import MODELS

    out, kind = console(), found.kind
    first = ["model"] if kind is MODELS else [kind.asked, "method"]
    head = [*first, "CPU s", "scatter", kind.work, "worst error", "held", "found", "missing"]
    numbers = range(len(first), len(first) + 4)
    table(out, head, [_row(found, trial) for trial in found.trials], right=(*numbers, len(first) + 5))
    for t in found.trials:
        where = t.setting.model or f"{kind.asked} {t.setting.accuracy:g} with {t.setting.method}"
        if t.failed:
            line(out, f"{where}: {t.failed}")
        if t.extra:
            line(out, f"{where}: {', '.join(t.extra)} is not in the truth")
    out.print()
    for sentence in (found.compared, *found.notes, recommendation(found), digits(found)):
        if sentence:
            line(out, sentence)
    out.print()
    for path in files:
        line(out, f"{'figure' if path.endswith('.png') else 'table'}: {path}")


def _row(found: Tradeoff, t: Trial) -> list[str]:
    from contwalk.number_words import rough
    from contwalk.workflow.tradeoff.trials import MODELS

    setting = t.setting
    first = (
        [setting.model or "as it is"] if found.kind is MODELS else [f"{setting.accuracy:g}", setting.method]
    )
    times = [f"{t.seconds:.2f}", f"{t.spread:.2f}", str(t.work)]
    held = "yes" if found.held(t) else "NO"
    return [*first, *times, rough(t.worst), held, str(t.found), ", ".join(t.missing) or "-"]
