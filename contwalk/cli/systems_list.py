"""`contwalk systems list`: what is installed."""

from __future__ import annotations

import click


@click.command("list")
def command() -> None:
    """List the installed systems."""
    from contwalk.cli.terminal import console, line, table
    from contwalk.system import list_systems

    out = console()
    names = list(list_systems())
    if not names:
        line(out, "No system is installed. A plugin file of your own is named by its path, as ./my_model.py.")
        return
    table(out, ["system", "about"], [[name, _about(name)] for name in names])
    out.print()
    line(out, f"next: contwalk systems describe {names[0]}")


def _about(name: str) -> str:
    """One line about a system; why it cannot be loaded, where that is so."""
    from contwalk.system.loading import load_declaration

    try:
        return load_declaration(name).about
    except (Exception, SystemExit) as error:  # somebody else's plugin may raise anything
        return f"cannot be loaded: {type(error).__name__}: {error}"
