"""The system of a database for a command: what may not run, and what has changed, is said."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contwalk.storage import FileDatabase
    from contwalk.system import System


def trust_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option `--trust` of the commands that may need the system of a database."""
    return click.option(
        "--trust", is_flag=True, help="Run the plugin that the database names, also if it has changed."
    )(command)


def required_system(database: FileDatabase, trust: bool) -> System:
    """The system of a run.

    Raises
    ------
    ContwalkError
        If it may not run without `--trust`, or cannot be loaded.
    """
    from contwalk.cli.entry import say

    stored = database.stored_system(trust)
    if stored.changed:
        say(f"warning: {stored.changed} What is computed with it may differ from what is stored.")
    return stored.system


def optional_system(database: FileDatabase, trust: bool, needed_for: str) -> System | None:
    """The same; where it cannot be had, what is not shown is said on stderr."""
    from contwalk.cli.entry import say

    try:
        return required_system(database, trust)
    except ContwalkError as error:
        say(f"Not shown: {needed_for}. {error}")
        return None


def units_of_run(database: FileDatabase, trust: bool) -> Mapping[str, str]:
    """Units and what figures call them, by name: as stored, or else the system's."""
    from contwalk.plotting.quantities import Units, units_of

    stored, called = (database.header.provenance.get(key) for key in ("units", "called"))
    if stored is not None:
        known = ({str(name): str(text) for name, text in (each or {}).items()} for each in (stored, called))
        return Units(*known)
    system = optional_system(database, trust, "units")
    return {} if system is None else units_of(system)
