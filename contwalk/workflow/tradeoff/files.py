"""The table and the figure of a tradeoff."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from contwalk.storage.csv_files import write_csv
from contwalk.storage.failures import check_writable, refuse_existing
from contwalk.workflow.file_names import beside
from contwalk.workflow.tradeoff.trials import MODELS, Tradeoff, Trial


def names_of_files(output: Path) -> tuple[Path, Path]:
    """Table and figure, beside the run's output."""
    return beside(output, "tradeoff.csv"), beside(output, "tradeoff.png")


def refuse_existing_files(output: Path, force: bool, figure: bool) -> None:
    """Refuse to replace results, and a folder that takes none, before anything is computed."""
    table, picture = names_of_files(output)
    check_writable(table)
    refuse_existing([table, picture] if figure else [table], force)


def write(output: Path, found: Tradeoff, figure: bool = True) -> list[Path]:
    """Write the table, and the figure."""
    table, picture = names_of_files(output)
    names = list(found.truth)
    head = [found.kind.asked, "method", "model", "cpu_seconds", "cpu_spread", "runs"]
    head += ["rhs" if found.kind.work == "right-hand sides" else "simulations"]
    head += ["worst_error", "promise_held", "found", "missing", "extra"]
    write_csv(table, [*head, *[f"error {name}" for name in names]], _rows(found, names))
    timed = [trial for trial in found.trials if trial.seconds > 0.0]
    if not figure or not timed:
        return [table]
    _draw(found, timed, picture)
    return [table, picture]


def _rows(found: Tradeoff, names: list[str]) -> Iterator[list[str]]:
    for t in found.trials:
        row = [repr(t.setting.accuracy), t.setting.method, t.setting.model]
        row += [f"{t.seconds:.4f}", f"{t.spread:.4f}", str(len(t.times)), str(t.work), f"{t.worst:.3e}"]
        row += [str(found.held(t)), str(t.found), " ".join(t.missing), " ".join(t.extra)]
        yield [*row, *[f"{t.errors[name]:.3e}" for name in names]]


def _draw(found: Tradeoff, timed: list[Trial], picture: Path) -> None:
    from contwalk import plotting

    names = list(found.truth)
    if found.kind is MODELS:
        series = {t.setting.model or "as it is": [(t.seconds, t.worst)] for t in timed}
        plotting.save(plotting.plot_tradeoff(series, xlabel="CPU time (s)", ylabel="largest shift"), picture)
        return
    methods = list(dict.fromkeys(trial.setting.method for trial in timed))
    own = {method: [t for t in timed if t.setting.method == method] for method in methods}
    panels = {m: {name: [(t.seconds, t.errors[name]) for t in own[m]] for name in names} for m in methods}
    asked = {m: [(t.seconds, t.setting.accuracy) for t in own[m]] for m in methods}
    axes = plotting.plot_tradeoff_panels(panels, asked, doubt=found.doubt)
    plotting.save(axes[0], picture)
