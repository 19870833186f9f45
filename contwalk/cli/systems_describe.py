"""`contwalk systems describe`: a system in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from contwalk.cli.model_option import model_of, model_option

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.system import Family, Parameter, System


@click.command("describe")
@click.argument("system")
@model_option
def command(system: str, choices: Sequence[str]) -> None:
    """Describe SYSTEM, an installed system or the path of a plugin file."""
    from contwalk.cli.terminal import console
    from contwalk.system import Family, load_system
    from contwalk.system.loading import load_declaration

    declared = load_declaration(system)
    loaded = load_system(system, model_of(choices))
    out = console()
    _print_head(out, loaded)
    if isinstance(declared, Family):
        _print_choices(out, declared, loaded)
    _print_numbers(out, loaded)
    _print_dynamics(out, loaded)
    _print_offers(out, loaded, system)


def _print_head(out: Console, system: System) -> None:
    from contwalk.cli.terminal import line

    line(out, system.name + (f": {system.about}" if system.about else ""), style="bold")
    if system.reference:
        line(out, f"reference: {system.reference}")


def _section(
    out: Console, title: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[int] = ()
) -> None:
    """A table under its own header; nothing where it has no rows."""
    from contwalk.cli.terminal import table

    if rows:
        out.print()
        table(out, title, rows, right=right)


def _print_choices(out: Console, family: Family, system: System) -> None:
    rows = [
        [choice.name, str(system.model[choice.name]), str(choice.default), choice.words(), choice.about]
        for choice in family.choices
    ]
    _section(out, ["model choice", "here", "default", "allowed", "about"], rows)


def _default(parameter: Parameter) -> str:
    """A parameter's default; a conserved quantity may have none."""
    return "of start" if math.isnan(parameter.default) else f"{parameter.default:.12g}"


def _print_numbers(out: Console, system: System) -> None:
    states = [[state.name, state.unit, state.about] for state in system.states]
    _section(out, ["state", "unit", "about"], states)
    parameters = [[p.name, _default(p), p.unit, p.interval(), p.about] for p in system.parameters]
    _section(out, ["parameter", "default", "unit", "bounds", "about"], parameters, right=(1,))
    observables = [[entry.name, entry.unit, entry.about] for entry in system.observables]
    _section(out, ["observable", "unit", "about"], observables)
    signals = [[entry.name, entry.unit, entry.about] for entry in system.signals]
    _section(out, ["signal", "unit", "about"], signals)


def _print_dynamics(out: Console, system: System) -> None:
    from contwalk.cli.terminal import line

    _section(out, ["mode", "about"], [[mode.name, mode.about] for mode in system.modes])
    transitions = [
        [t.name, f"{t.source} -> {t.target}", t.direction, t.role, t.about] for t in system.transitions
    ]
    _section(out, ["transition", "modes", "guard", "role", "about"], transitions)
    _section(out, ["symmetry", "role", "about"], [[s.name, s.role, s.about] for s in system.symmetries])
    neutral = [[n.name, n.pin or "", n.value or "", n.about] for n in system.neutral]
    _section(out, ["neutral direction", "held state", "by parameter", "about"], neutral)
    if system.period is not None:
        out.print()
        line(out, "Forced periodically: its period is a function of the parameters.")


def _print_offers(out: Console, system: System, reference: str) -> None:
    from contwalk.cli.terminal import line

    starts = [[start.name, start.about, start.exists] for start in system.starts]
    _section(out, ["start", "about", "exists"], starts)
    defaults = system.defaults()
    presets = []
    for name, values in system.presets.items():
        changed = [f"{key}={value:.12g}" for key, value in values.items() if value != defaults[key]]
        presets.append([name, ", ".join(changed) or "nothing"])
    _section(out, ["preset", "differs from the defaults in"], presets)
    out.print()
    line(out, f"picture: {'drawn by the system' if system.draw is not None else 'none'}")
    line(out, f"next:    contwalk init {reference}")
