"""The system that a page is computed with, or the sentence that says what it lacks without one."""

from __future__ import annotations

from collections.abc import Callable

from contwalk.errors import ContwalkError
from contwalk.storage.stored_system import StoredSystem
from contwalk.system import System


def system_or_said(
    stored: Callable[[], StoredSystem], lacks: str, differs: str, missing: list[str]
) -> System | None:
    """The system; None where its code may not run or cannot be had.

    Parameters
    ----------
    stored : callable
        What loads it.
    lacks, differs : str
        What is not shown without it; what may be wrong with one that has changed, as a sentence.
    missing : list of str
        Takes the sentence that says so.
    """
    try:
        found = stored()
    except ContwalkError as error:
        missing.append(f"Not shown: {lacks}. {error}")
        return None
    if found.changed:
        missing.append(f"{found.changed} {differs}")
    return found.system
