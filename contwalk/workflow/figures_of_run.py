"""The figures of a run file: their names, refused early, and drawing them beside the database."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.storage.failures import refuse_existing
from contwalk.workflow.figures import draw_figure
from contwalk.workflow.file_names import beside
from contwalk.workflow.run_file.reading import RunFile


def check_figures(run_file: RunFile, replacing: bool) -> None:
    """Refuse names of figures that cannot be written, before anything is computed.

    Files that bear the output's name belong to it and are replaced. One that the run file names itself may be
    anybody's: it is replaced only where the database is, or goes on (`replacing`).

    Raises
    ------
    ContwalkError
    """
    if not run_file.figures:
        return
    paths = _figure_paths(run_file)
    for path, figure in zip(paths, run_file.figures, strict=True):
        refuse_existing([path], force=replacing or "file" not in figure.options)


def _figure_paths(run_file: RunFile) -> list[Path]:
    """Files beside the database, `X_<figure>.png` of `X.h5` unless the run file names them."""
    output, paths = run_file.output, []
    for number, figure in enumerate(run_file.figures):
        same = [f.name for f in run_file.figures[:number]].count(figure.name)
        suffix = f"_{same + 1}" if same else ""
        own = beside(output, f"{figure.name}{suffix}.png")
        paths.append(output.parent / str(figure.options["file"]) if figure.options.get("file") else own)
    return paths


def drawn(run_file: RunFile, branches: Sequence[Branch], note: Callable[[str], None]) -> Iterator[Path]:
    """The figures of the run file, as they are drawn; `note` is told what they lack, and which are not."""
    if run_file.figures and not any(len(branch) for branch in branches):
        note("No branch has a point, so no figure was drawn.")
        return
    for figure, path in zip(run_file.figures, _figure_paths(run_file), strict=True):
        options = dict(figure.options)
        if figure.name == "stability_map" and "y" not in options and run_file.sweep is not None:
            options["y"] = run_file.sweep[0]

        def report(text: str, name: str = figure.name) -> None:
            note(f"Figure '{name}': {text}")

        try:
            yield draw_figure(figure.name, branches, run_file.system, path, options, report=report)
        except ContwalkError as error:
            note(f"The figure '{figure.name}' was not drawn: {error}")
