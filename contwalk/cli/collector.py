"""The collector of cycles, while a process is being loaded and after."""

from __future__ import annotations

import gc

# Imports make a quarter of a million objects that live to the end. By default the collector looks through
# them every 700 objects: a tenth of a short study.
_WHILE_LOADING = 50_000
_usual: tuple[int, int, int] | None = None


def hold_collector() -> None:
    """Let the collector run seldom while modules are imported."""
    global _usual
    _usual = gc.get_threshold()
    gc.set_threshold(_WHILE_LOADING, *_usual[1:])


def loaded() -> None:
    """What is there now stays, and is not looked through again; from now on the collector runs as usual.

    It does nothing in a process that does not begin in `contwalk.cli.entry.main`.
    """
    global _usual
    if _usual is not None:
        gc.freeze()
        gc.set_threshold(*_usual)
        _usual = None
