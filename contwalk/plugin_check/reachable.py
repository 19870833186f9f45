"""Which modes transitions lead to: those that no motion enters or leaves, and machines whose events come once
only."""

from __future__ import annotations

from collections.abc import Iterable

from contwalk.plugin_check.findings import Report, place_of
from contwalk.system import System


def check_reachable(report: Report, system: System) -> None:
    """Tell of modes that no transition leads to, and of transitions that never come round."""
    if not system.acting:
        return
    leads: dict[str, set[str]] = {mode.name: set() for mode in system.modes}
    for transition in system.acting:
        leads[transition.source].add(transition.target)
    entered = _closure(leads, [system.modes[0].name]).union(*leads.values())
    for mode in system.modes:
        if mode.name not in entered:
            report.warning(
                f"mode '{mode.name}'",
                "No transition that acts leads to it: a motion is in it only if it starts there. Is it the "
                "target of a transition that names another mode, or that is watched?",
                place_of(mode.field),
            )
    if not any(name in _closure(leads, leads[name]) for name in leads):
        names = ", ".join(dict.fromkeys(t.name for t in system.acting))
        report.warning(
            f"system '{system.name}'",
            f"Its transitions ({names}) never come round: each happens once at most, and no orbit passes "
            "them. Lead one of them back to an earlier mode.",
            place_of(system.acting[0].guard),
        )
        return
    for mode in system.modes:
        if leads[mode.name] or mode.about or system.fallen is not None:
            continue
        into = [t.name for t in system.acting if t.target == mode.name and t.source != mode.name]
        if into:
            report.warning(
                f"mode '{mode.name}'",
                f"'{into[0]}' leads to it, and no transition leads out of it: a motion that gets there "
                "stays, and no orbit passes it. Declare what ends it; if it is meant to last, as that of a "
                "machine that has fallen, say so with about=... of the mode.",
                place_of(mode.field),
            )


def _closure(leads: dict[str, set[str]], names: Iterable[str]) -> set[str]:
    """These modes, and all that transitions lead to from them."""
    found, left = set[str](), list(names)
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            left += leads[name]
    return found
