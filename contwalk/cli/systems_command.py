"""`contwalk systems`: the group of commands about systems."""

from __future__ import annotations

import click

from contwalk.cli.lazy_group import LazyGroup

_COMMANDS = {
    "list": ("contwalk.cli.systems_list", "List the installed systems."),
    "describe": ("contwalk.cli.systems_describe", "Describe a system: states, parameters, what it offers."),
    "check": ("contwalk.cli.systems_check", "Check a system or a plugin file before any run."),
    "stress": ("contwalk.cli.systems_stress", "Compute a study in other units and orders: is it the same?"),
    "slide": ("contwalk.cli.systems_slide", "Derive the sliding mode on a switching surface."),
}


@click.group("systems", cls=LazyGroup, lazy=_COMMANDS, invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """List, describe and check systems."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())
