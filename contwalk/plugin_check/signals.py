"""Signals: an array of numbers along a motion, as figures ask for it?"""

from __future__ import annotations

import numpy as np

from contwalk.plugin_check.findings import Report, place_of, place_of_error
from contwalk.plugin_check.samples import Samples
from contwalk.python_functions import plain
from contwalk.system import Signal, System
from contwalk.system.declarations import ParameterValues

INSTANTS = 5


def check_signal(report: Report, signal: Signal, system: System, samples: Samples) -> None:
    """One number for each instant of a motion; NaN where the quantity does not exist is as it should be."""
    what, place = f"signal '{signal.name}'", place_of(signal.function)
    t, x = np.linspace(0.0, 1.0, INSTANTS), samples.states[:INSTANTS].copy()
    try:
        with np.errstate(all="ignore"):
            found = plain(signal.function)(t, x, ParameterValues(**samples.parameters))
        values = np.asarray(found, dtype=float)
    except (Exception, SystemExit) as error:
        report.error(
            what,
            f"It raises {type(error).__name__}: {error}. It gets t of shape ({INSTANTS},) and x of shape "
            f"({INSTANTS}, {len(system.states)}), and returns an array of shape ({INSTANTS},).",
            place_of_error(error, signal.function),
        )
        return
    if values.shape != t.shape:
        report.error(
            what,
            f"For a motion of {INSTANTS} instants it gives an array of shape {values.shape}. "
            "It must return one number for each instant.",
            place,
        )
        return
    report.ok(what, "gives a number for each instant.", place)
