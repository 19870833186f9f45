"""A derived sliding mode as text to paste into a plugin."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contwalk.errors import SystemDefinitionError
from contwalk.fields.plugin_text import function_text
from contwalk.flow.hybrid.sliding import SlidingMode
from contwalk.system import System, Transition


def sliding_text(system: System, mode: SlidingMode, name: str | None = None) -> str:
    """Functions and declarations of a sliding mode, and what to change of the plugin's own.

    Parameters
    ----------
    system : System
    mode : SlidingMode
    name : str, optional
        Of the mode; `slide` by default.

    Raises
    ------
    SystemDefinitionError
        If the name is no identifier, or that of another mode.
    """
    name = _name(system, name)
    functions = _functions(system, mode, name)
    code = "\n\n".join(functions)
    imports = [
        line for line, used in (("import math", "math."), ("import numpy as np", "np.")) if used in code
    ]
    parts = [
        _head(system, mode),
        "\n".join(imports) + "\n" if imports else "",
        code,
        _declared(system, mode, name),
    ]
    return "\n\n".join(part for part in parts if part)


def _name(system: System, name: str | None) -> str:
    taken = {each.name for each in system.modes}
    chosen = name or "slide"
    if not chosen.isidentifier() or chosen in taken:
        why = "is a mode already" if chosen in taken else "is not a name"
        raise SystemDefinitionError(
            f"'{chosen}' {why} in '{system.name}'.", "Give a name for the sliding mode with --name."
        )
    return chosen


def _head(system: System, mode: SlidingMode) -> str:
    surface = mode.surface
    states = ", ".join(f"x[{i}] {system.state_names[i]}" for i in system.states_of(surface.above))
    return (
        f"# Filippov's sliding mode on the surface of {surface.name}, where the guard is positive in "
        f"'{surface.above}',\n# derived by `contwalk systems slide` from system '{system.name}'. "
        f"States: {states}.\n"
    )


def _functions(system: System, mode: SlidingMode, name: str) -> list[str]:
    above, below = mode.surface.above, mode.surface.below
    names = system.parameter_names
    outputs = [f"dx[{i}]" for i in system.states_of(above)]
    about = f"Filippov's mean of '{above}' and '{below}' that keeps the guard zero."
    functions = [function_text(f"{name}_field(t, x, p, dx)", about, mode.field, names, outputs)]
    for side, of, program in (("up", above, mode.above), ("down", below, mode.below)):
        about = f"Rate of the guard with the field of '{of}'."
        functions.append(function_text(f"{name}_{side}(t, x, p)", about, program, names))
    if _named_guard(mode) is None:
        functions.append(function_text(f"{name}_guard(t, x, p)", "The surface.", mode.guard, names))
    return functions


def _declared(system: System, mode: SlidingMode, name: str) -> str:
    """Lines for the declarations of the system."""
    surface = mode.surface
    guard = _named_guard(mode) or f"{name}_guard"
    lines = [
        "# In System(...), one more of the modes:",
        f'#     Mode("{name}", {name}_field{_states(system, surface.above)}),',
        f"# of the transitions, in place of {' and '.join(_quoted(surface.crossings))}:",
    ]
    lines += [f"#     {_crossing(transition, guard, name)}," for transition in surface.crossings]
    lines.append("# and two more:")
    for way, target, direction in (("up", surface.above, "rising"), ("down", surface.below, "falling")):
        ends = f'"{name}_leaves_{way}", "{name}", "{target}"'
        lines.append(f'#     Transition({ends}, {name}_{way}, "{direction}", level=True),')
    lines += [
        f"# No transition out of '{side}' leads over the surface: motions there go on through it."
        for side in (surface.above, surface.below)
        if side not in {each.source for each in surface.crossings}
    ]
    others = [
        transition.name
        for side in (surface.above, surface.below)
        for transition in system.leaving(side)
        if transition not in surface.crossings
    ]
    if others:
        lines.append(
            f"# What else ends '{surface.above}' or '{surface.below}' does not end '{name}' until it is "
            f"declared for it: {', '.join(dict.fromkeys(others))}."
        )
    return "\n".join(lines) + "\n"


def _quoted(transitions: tuple[Transition, ...]) -> list[str]:
    return list(dict.fromkeys(f"'{transition.name}'" for transition in transitions))


def _states(system: System, mode: str) -> str:
    names = system.mode(mode).states
    return "" if names is None else f", states={tuple(names)!r}"


def _crossing(transition: Transition, guard: str, name: str) -> str:
    """The declaration of a transition, with the sliding mode for its target."""
    reset = _named(transition.reset)
    more = (f", reset={reset}" if reset else "") + (", level=True" if transition.level else "")
    ends = f'"{transition.name}", "{transition.source}", "{name}"'
    return f'Transition({ends}, {guard}, "{transition.direction}"{more})'


def _named_guard(mode: SlidingMode) -> str | None:
    return next((name for t in mode.surface.crossings if (name := _named(t.guard))), None)


def _named(function: Callable[..., Any] | None) -> str | None:
    """The name that a function has in its own module; None for one that has none there."""
    name = getattr(function, "__name__", "")
    return name if getattr(function, "__globals__", {}).get(name) is function and function else None
