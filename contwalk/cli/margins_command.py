"""`contwalk margins`: how far a stored motion may be pushed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contwalk.cli.bar import bar
from contwalk.cli.study_call import StudyCall, study_command

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.workflow.basin import BasinResult
    from contwalk.workflow.margins import MarginsResult
    from contwalk.workflow.run_file.margins import MarginsFile


@study_command(
    "margins",
    "what a study has found",
    output="Base of the files' names, instead of the run file's output.",
    resume="Go on with a study that was stopped.",
    force="Replace files that exist.",
    jobs="Processes, or auto; the result does not depend on it.",
    no_figures="Draw no figure.",
)
def command(call: StudyCall) -> int:
    """Find how far the motion that the run file FILE names may be pushed, one state and sign at a time.

    With output X.h5 it writes X_margins.h5, X_margins.csv and X_margins.png; what is found is kept in
    X_margins.journal until then.

    Exit codes: 0; 1 if a computation failed; 2 for bad input, with nothing written; 130 after Ctrl-C, 143
    after SIGTERM.
    """
    from contwalk.cli.terminal import console
    from contwalk.workflow.cluster import executor_at
    from contwalk.workflow.margins import margins
    from contwalk.workflow.run_file.margins import read_margins

    run = read_margins(*call.given)

    def work() -> int:
        with bar("rays", None, call.quiet) as move, executor_at(call.scheduler) as executor:
            progress = move and (lambda done, of: move(completed=done, total=of))
            result = margins(run, jobs=call.jobs, executor=executor, **call.kept, progress=progress)
        if not call.quiet:
            _print(console(), run, result)
        return 0

    return call.interruptible(work, run.file("margins.journal"), call.again())


def _print(out: Console, run: MarginsFile, result: MarginsResult) -> None:
    from contwalk.cli.terminal import line, table

    line(out, f"{run.system.name}, {run.margins.of.point} of {run.database}", style="bold")
    if result.basin is not None:
        _print_basin(out, result.basin)
    if not result.rows:
        _print_rest(out, result)
        return
    heads = ["instant", "state", "down", "up", "beyond, down", "beyond, up"]
    shown = []
    for up, down in zip(result.rows[::2], result.rows[1::2], strict=True):
        cells = [f"{'several: ' if r['several'] else ''}{_size(r)}" for r in (down, up)]
        shown.append([str(up["instant"]), up["state"], *cells, down["ends"], up["ends"]])
    table(out, heads, shown, indent=4, right=(0, 2, 3))
    _print_rest(out, result)


def _print_basin(out: Console, basin: BasinResult) -> None:
    from contwalk.cli.terminal import line

    whole = sum(part**2 for part in basin.cells[:, 2].tolist())
    line(out, f"basin in {basin.states[0]} and {basin.states[1]}, {len(basin.labels)} motions:")
    for label in sorted(set(basin.cell_labels)):
        mine = zip(basin.cells[:, 2].tolist(), basin.cell_labels, strict=True)
        share = sum(part**2 for part, own in mine if own == label) / whole
        line(out, f"    {100.0 * share:5.1f} % of the plane: {label or 'squares on borders'}")


def _print_rest(out: Console, result: MarginsResult) -> None:
    from contwalk.cli.terminal import line

    out.print()
    for note in result.notes:
        line(out, f"note: {note}")
    for path in result.files:
        line(out, f"file:   {path}")
    for path in result.figures:
        line(out, f"figure: {path}")


def _size(row: dict[str, object]) -> str:
    return f"none to {row['farthest']:.4g}" if row["border"] is None else f"{row['border']:.4g}"
