"""`contwalk systems slide`: Filippov's sliding mode on a switching surface, as text for the plugin."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from contwalk.cli.model_option import model_of, model_option
from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.flow.hybrid.sliding import SwitchingSurface
    from contwalk.system import System


@click.command("slide")
@click.argument("system", metavar="SYSTEM_OR_PATH")
@click.option("--at", "transition", metavar="TRANSITION", help="A transition over the surface.")
@click.option("--name", metavar="MODE", help="Name of the sliding mode.  [default: slide]")
@click.option("-o", "output", metavar="FILE", help="Write the text to FILE instead of printing it.")
@model_option
def command(
    system: str, transition: str | None, name: str | None, output: str | None, choices: Sequence[str]
) -> None:
    """Derive the mode in which SYSTEM slides along a switching surface, as Python to paste into the plugin.

    A switching surface is the zero of a guard over which one mode hands the state on to another. The field is
    Filippov's mean of both modes' fields, derived from what the plugin says; the guards end it where either
    field no longer leads towards the surface. Where there is one surface only, --at is not needed.
    """
    from contwalk.flow.hybrid.sliding import sliding_mode
    from contwalk.plugin_check.switching_surfaces import refuse_one_rate, switching_surfaces
    from contwalk.system import load_system
    from contwalk.workflow.sliding_text import sliding_text

    loaded = load_system(system, model_of(choices))
    surface = _chosen(loaded, switching_surfaces(loaded), transition)
    mode = sliding_mode(loaded, surface)
    refuse_one_rate(loaded, mode)
    text = sliding_text(loaded, mode, name)
    if output is None:
        click.echo(text, nl=False)
        return
    try:
        with Path(output).open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise ContwalkError(f"{output} exists.", "Give another name with -o, or remove it first.") from None
    except OSError as error:
        raise ContwalkError(f"{output} cannot be written: {error.strerror}.", "Give another name.") from None
    click.echo(
        f"Wrote {output}. Next: put what it says into the plugin, then contwalk systems check {system}"
    )


def _chosen(system: System, surfaces: Sequence[SwitchingSurface], transition: str | None) -> SwitchingSurface:
    """The surface that a transition leads over, or the only one."""
    known = sorted({each.name for surface in surfaces for each in surface.crossings})
    fitting = [s for s in surfaces if transition is None or transition in {each.name for each in s.crossings}]
    if len(fitting) == 1:
        return fitting[0]
    if not surfaces:
        raise ContwalkError(
            f"'{system.name}' has no switching surface.",
            "One is the zero of a hard transition's guard, falling or rising, that leads from one mode to "
            "another and keeps the state there.",
        )
    if not fitting:
        raise ContwalkError(
            f"No transition '{transition}' of '{system.name}' leads over a switching surface.",
            f"Those that do: {', '.join(known)}. They are hard, falling or rising, lead from one mode to "
            "another, and keep the state.",
        )
    raise ContwalkError(
        f"'{system.name}' has {len(fitting)} switching surfaces"
        + (f" with a transition '{transition}'" if transition else "")
        + f": of {'; of '.join(surface.name for surface in fitting)}.",
        "Say which one with --at TRANSITION; a name that several surfaces share must be made two."
        if transition
        else "Say which one with --at TRANSITION.",
    )
