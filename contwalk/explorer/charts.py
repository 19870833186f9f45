"""The regions between curves in two parameters, as a page fills them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.chart import Region
from contwalk.errors import ContwalkError
from contwalk.explorer.packing import packed, short, varints
from contwalk.labels import LOCUS
from contwalk.printable import printable
from contwalk.studies.charts import chart
from contwalk.system import System


def chart_of(system: System, branches: Sequence[Branch]) -> tuple[str, list[str]]:
    """The chart of the first two parameters that curves of equilibria have, packed, and sentences on it.

    Empty where there are no such curves.
    """
    curves = [branch for branch in branches if branch.info.problem == LOCUS and len(branch)]
    if not any(curve.info.settings["of_problem"] == "equilibrium" for curve in curves):
        return "", []
    try:
        with np.errstate(all="ignore"):
            found = chart(system, branches)
    except ContwalkError as error:
        return "", [f"The regions between the curves are not filled. {error}"]
    header = {
        "names": list(found.names),
        "low": short(np.array(found.low)),
        "high": short(np.array(found.high)),
        "rows": len(found.labels),
        "columns": len(found.labels[0]),
        "regions": [_region(region) for region in found.regions],
    }
    runs = [(label + 1, len(list(run))) for label, run in groupby(found.labels.ravel().tolist())]
    notes = [f"Of the chart: {printable(note)}" for note in found.notes]
    return packed(header, varints([number for run in runs for number in run])), notes


def _region(region: Region) -> list[Any]:
    """What fills it: `none`, `unknown` or the number of unstable directions; whether it is admissible; the
    numbers of all solutions there; its place.
    """
    shown = region.shown
    fill = "none" if shown is None else "unknown" if shown.unstable is None else str(min(shown.unstable, 4))
    counts = " ".join("?" if count is None else str(count) for count in region.counts)
    admissible = shown is None or shown.admissible
    return [fill, admissible, counts or "\N{EN DASH}", *short(np.array(region.at))]
