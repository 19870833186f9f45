"""`contwalk systems stress`: whether a study is the same in other units, orders and accuracies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from contwalk.cli.model_option import model_of, model_option

if TYPE_CHECKING:
    from contwalk.workflow.stress.stressing import Result, Stress

STRESS_VERSION = 1
_STYLES = {"same": "green", "differs": "bold red", "refused": "yellow"}


@click.command("stress")
@click.argument("study", metavar="SYSTEM_OR_PATH")
@model_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
def command(study: str, choices: Sequence[str], as_json: bool) -> int:
    """Compute a study in other units and orders, and say what changes.

    SYSTEM_OR_PATH is an installed system, a plugin file, or a run file; without a run file the study is the
    one that `contwalk init` would write. States and parameters are taken in units of 1e-6 and 1e6, time in
    units of 1e-3 and 1e3, the equations in the opposite order, and the accuracy from 1e-3 to 1e-13. Each time
    what is found is compared with the study as it is, in its units, within the errors that both claim.

    Exit codes: 0 if all that is found is the same, or refused with a sentence; 1 if something differs; 2 for
    bad input, or if the study fails as it is.
    """
    from contwalk.errors import ContwalkError
    from contwalk.workflow.stress.stressing import run_to_stress, stressed

    if study.endswith((".yaml", ".yml")) and choices:
        raise ContwalkError("--set belongs to a system.", "Write the model choices into the run file.")
    run_file = run_to_stress(study, model_of(choices))
    if as_json:
        import json

        found = stressed(run_file)
        click.echo(json.dumps(_document(found), indent=2, allow_nan=False))
    else:
        from contwalk.cli.terminal import console, line

        out = console()
        line(out, f"{run_file.system.name}, along {run_file.free}; A is the study as it is", style="bold")
        found = stressed(run_file, lambda result: _print(out, result))
    return 0 if found.same else 1


def _print(out: Any, result: Result) -> None:
    """A line for each change, when it has been computed."""
    from contwalk.cli.terminal import line
    from contwalk.number_words import plural

    numbers = f"{plural(result.points, 'point'):<10} {result.seconds:7.1f} s"
    said = result.sentences[0] if result.sentences else ""
    more = f" And {len(result.sentences) - 1} more." if len(result.sentences) > 1 else ""
    text = f"{result.case:<32} {result.verdict:<8} {numbers}  {said}{more}".rstrip()
    line(out, text, style=_STYLES[result.verdict])


def _document(found: Stress) -> dict[str, Any]:
    """The results as plain JSON values."""
    from dataclasses import asdict

    results = [{**asdict(result), "sentences": list(result.sentences)} for result in found.results]
    return {
        "stress_version": STRESS_VERSION,
        "system": found.system,
        "same": found.same,
        "results": results,
    }
