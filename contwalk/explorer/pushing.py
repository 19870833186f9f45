"""The page of a file of margins: how far each state may be pushed at each instant, and with what machine."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.explorer.machine import MachineOfBranch
from contwalk.explorer.making import making_of
from contwalk.explorer.packing import packed, short
from contwalk.explorer.page import written
from contwalk.explorer.system_of_page import system_or_said
from contwalk.number_words import choices, exact, plural, with_unit
from contwalk.plotting.playback import Playback
from contwalk.plotting.quantities import units_of
from contwalk.plotting.stage import Performer
from contwalk.printable import printable
from contwalk.storage.stored_system import system_of_run
from contwalk.storage.trajectory import Margins, read_margins
from contwalk.system import System


def margins_page(path: Path, trust: bool = False) -> tuple[str, tuple[str, ...]]:
    """The page, and sentences on what it does not show.

    Parameters
    ----------
    path : Path
        Of `X_margins.h5`.
    trust : bool
        Whether code of a plugin file, or of a system that has changed, may run.

    Raises
    ------
    DatabaseError
        If the file cannot be read.
    """
    margins = read_margins(path)
    missing: list[str] = []
    system = _system(margins, path, trust, missing)
    units = margins.header.get("units") or ({} if system is None else units_of(system))
    machine = None if system is None or system.draw is None else _machine(system, margins, missing)
    rows = sorted(margins.rows, key=lambda row: margins.states.index(row["state"]))
    largest: dict[str, float] = {}
    for row in rows:
        unit = units.get(row["state"], "")
        largest[unit] = max(largest.get(unit, 0.0), float(row["border"] or 0.0))
    head: dict[str, Any] = {
        "branches": [],
        "diagram": None,
        "plane": None,
        "file": path.name,
        "system": margins.system,
        "model": printable(choices(margins.header.get("model", {}))),
        "made": [],
        "notes": [],
        "missing": [printable(text) for text in missing],
        "error": 0.0,
        "states": list(margins.states),
        "watched": "",
        "time": "time",
        "making": making_of(
            str(margins.header.get("config", "")), margins.header.get("provenance", {}), "margins"
        ),
        "draws": machine is not None,
        "margins": {
            "instants": [_instant(margins, number, units) for number in range(len(margins.instants))],
            "rows": [_row(row, units, largest[units.get(row["state"], "")]) for row in rows],
        },
        "basin": _basin(margins),
    }
    blocks = {"head": packed(head)}
    blocks |= {"motions margins": machine} if machine else {}
    return written(f"{margins.system}: {path.name}", blocks), tuple(missing)


def _system(margins: Margins, path: Path, trust: bool, missing: list[str]) -> System | None:
    """The system, which draws the machine; None where it cannot be had, which is then said."""
    header = margins.header
    return system_or_said(
        lambda: system_of_run(header["provenance"], header.get("model", {}), margins.system, path, trust),
        "the machine where it is pushed",
        "What is drawn with it may differ from what was pushed.",
        missing,
    )


def _machine(system: System, margins: Margins, missing: list[str]) -> str:
    """The machine at each instant, as the motions of a branch that does not move; empty where it fails."""
    machine, parameters = MachineOfBranch(), margins.header["parameters"]
    try:
        for instant in margins.instants:
            playback = Playback(system, [instant["time"]], [instant["state"]], parameters)
            machine.add([Performer(playback).at(instant["time"])])
    except ContwalkError as error:
        missing.append(f"The machine is not drawn where it is pushed. {error}")
        return ""
    header: dict[str, Any] = {"states": [], "levels": {"state": 1, "time": 1}, "rows": []}
    header |= {"machine": machine.header(), "frames": [[0] for _ in margins.instants]}
    return packed(header, bytes(machine.body))


def _instant(margins: Margins, number: int, units: Any) -> dict[str, Any]:
    """An instant in words, and the states at it."""
    instant = margins.instants[number]
    after = f"after {instant['fraction']:.4g} of the closure" if instant["fraction"] else "at the beginning"
    cells = [
        [name, exact(value), with_unit(name, units)]
        for name, value in zip(margins.states, instant["state"], strict=True)
    ]
    return {"title": f"instant {number}, {after}", "mode": printable(str(instant["mode"])), "states": cells}


def _row(row: Any, units: Any, largest: float) -> dict[str, Any]:
    """A push: what is written in its cell, how long its bar is, and its facts."""
    state, up, border = row["state"], float(row["sign"]) > 0.0, row["border"]
    unit = with_unit(state, units)
    if border is None:
        told = f"no border up to {exact(row['farthest'])} {unit}".strip()
    else:
        told = f"border at {exact(border)} {unit}".strip()
    facts = [
        told,
        "survival begins again further out" if row["several"] else "",
        f"beyond it: {row['ends']}" if row["ends"] else "",
        plural(int(row["simulations"]), "simulation"),
    ]
    return {
        "instant": int(row["instant"]),
        "state": state,
        "up": up,
        "text": "\N{RIGHTWARDS ARROW}" if border is None else f"{border:.3g}",
        "share": 1.0 if border is None or not largest else round(float(border) / largest, 4),
        "open": border is None,
        "several": bool(row["several"]),
        "facts": [printable(fact) for fact in facts if fact],
    }


def _basin(margins: Margins) -> dict[str, Any] | None:
    """Places of a plane of two states by what they come to."""
    if not margins.basin:
        return None
    labels = [str(label) for label in margins.basin["labels"]]
    names = list(dict.fromkeys(labels))
    places = np.asarray(margins.basin["places"], dtype=float)
    return {
        "states": list(margins.basin["states"]),
        "names": [printable(name) or "not known" for name in names],
        "x": short(places[:, 0]),
        "y": short(places[:, 1]),
        "labels": [names.index(label) for label in labels],
    }
