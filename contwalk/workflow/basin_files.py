"""What is left of a basin: a table of its points, and its picture."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from contwalk.storage.failures import failures_of
from contwalk.workflow.basin import BasinResult
from contwalk.workflow.run_file.margins import MarginsFile


def write_basin_table(basin: BasinResult, path: Path) -> None:
    """A line for each point, all digits kept."""
    with failures_of(path, "create"), path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow((*basin.states, "reaches"))
        for place, label in zip(basin.places.tolist(), basin.labels, strict=True):
            writer.writerow((*place, label))


def drawn_basin(run: MarginsFile, basin: BasinResult, path: Path) -> Path:
    """The picture, with the state that is pushed."""
    from contwalk import plotting

    ax = plotting.plot_basin(
        basin.states,
        basin.cells,
        basin.cell_labels,
        np.ptp(basin.places, axis=0),
        basin.own,
        units=plotting.units_of(run.system),
    )
    return plotting.save(ax, path)
