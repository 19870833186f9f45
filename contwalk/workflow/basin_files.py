"""What is left of a basin: a table of its points, and its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from contwalk.storage.csv_files import write_csv
from contwalk.workflow.basin import BasinResult
from contwalk.workflow.run_file.margins import MarginsFile


def write_basin_table(basin: BasinResult, path: Path) -> None:
    """A line for each point, all digits kept."""
    rows = zip(basin.places.tolist(), basin.labels, strict=True)
    write_csv(path, (*basin.states, "reaches"), ((*place, label) for place, label in rows))


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
