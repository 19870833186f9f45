"""States that do not exist where a function is used: it reads zeros, and what it writes is left out."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from contwalk.errors import ContwalkError
from contwalk.fields.trace import Outputs
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.traced import Form, Traced, number_form, vector_form
from contwalk.system import System


def check_absent(report: Report, system: System) -> None:
    """Warn of functions that use states which exist in none of the modes that they are for."""
    if all(mode.states is None for mode in system.modes):
        return
    fields = ((f"field of mode '{mode.name}'", mode.field, mode.name) for mode in system.modes)
    for what, function, modes in _by_function(fields):
        _check(report, what, function, system, modes, _needing(system, modes, "field", "dx"))
        _check_writing(report, what, function, system, modes)
    guards = ((f"guard of transition '{t.name}'", t.guard, t.source) for t in system.transitions)
    for what, function, modes in _by_function(guards):
        _check(report, what, function, system, modes, number_form("guard(t, x, p)"))
    for kind, entries in (("condition", system.conditions), ("observable", system.observables)):
        for entry in entries:
            if entry.at is None:
                continue
            at = [t for t in system.acting if t.name == entry.at]
            existing = [t.source if entry.side == "before" else t.target for t in at]
            form = number_form("function(t, x, p)")
            _check(report, f"{kind} '{entry.name}'", entry.function, system, existing, form)
    resets = [(f"reset of transition '{t.name}'", t.reset, t.source) for t in system.transitions if t.reset]
    acting = {id(t.reset) for t in system.acting}
    into = ((t.name, t.reset, t.target) for t in system.transitions if id(t.reset) in acting)
    targets = {id(function): modes for _, function, modes in _by_function(into)}
    for what, function, modes in _by_function(resets):
        form = _needing(system, targets.get(id(function), []), "reset", "x_plus")
        _check(report, what, function, system, modes, form)


def _by_function(used: Iterable[tuple[str, Any, str]]) -> list[tuple[str, Callable[..., Any], list[str]]]:
    """Each function once: in words, and all modes that it is used in."""
    found: dict[int, tuple[str, Callable[..., Any], list[str]]] = {}
    for what, function, mode in used:
        found.setdefault(id(function), (what, function, []))[2].append(mode)
    return list(found.values())


def _existing(system: System, modes: Iterable[str]) -> set[int]:
    return {i for mode in modes for i in system.states_of(mode)}


def _needing(system: System, modes: Iterable[str], name: str, argument: str) -> Form:
    return vector_form(system, name, argument, _existing(system, modes))


def _with_every_state(function: Callable[..., Any], system: System, form: Form, mode: str) -> Traced | None:
    try:
        return Traced(function, system, form, mode=mode, every=True)
    except ContwalkError:  # told where the function itself is checked
        return None


def _check(
    report: Report, what: str, function: Callable[..., Any], system: System, modes: list[str], form: Form
) -> None:
    found = _with_every_state(function, system, form, modes[0])
    if found is None:
        return
    for i in sorted({k - 1 for k in found.depends() if k > 0} - _existing(system, modes)):
        report.warning(
            what,
            f"It reads x[{i}] (state {system.state_names[i]}), which does not exist in {_named(modes)} and "
            "is zero there. Read another state, or give the mode this one.",
            place_of(function),
        )


def _check_writing(
    report: Report, what: str, function: Callable[..., Any], system: System, modes: list[str]
) -> None:
    found = _with_every_state(function, system, vector_form(system, "field", "dx"), modes[0])
    if found is None:
        return
    value = found.program.graph.value
    for i in sorted(set(range(len(system.states))) - _existing(system, modes)):
        nodes = [leaf.nodes[i] for leaf in found.program.leaves() if isinstance(leaf, Outputs)]
        if any(value(node) != 0.0 for node in nodes):
            report.warning(
                what,
                f"It writes dx[{i}] (state {system.state_names[i]}), which does not exist in "
                f"{_named(modes)}: nothing becomes of it. Leave it out, or give the mode this state.",
                place_of(function),
            )


def _named(modes: list[str]) -> str:
    names = list(dict.fromkeys(modes))
    return f"mode '{names[0]}'" if len(names) == 1 else f"the modes {', '.join(names)}"
