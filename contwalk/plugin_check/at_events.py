"""Conditions, and observables that belong to an event: finite numbers with the states there?"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contwalk.plugin_check.events import Happening
from contwalk.plugin_check.findings import Report, place_of, place_of_error
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced, number_form, traced
from contwalk.python_functions import plain
from contwalk.system import Condition, Observable, System, Transition
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:
    from contwalk.plugin_check.motion import Seen

MOST_STATES = 20


def check_at_event(
    report: Report,
    entry: Condition | Observable,
    system: System,
    happenings: Sequence[Happening],
    seen: Seen | None,
    samples: Samples,
) -> None:
    """A number for an instant and the state before or after the transition `entry.at`."""
    what, place = _words(entry), place_of(entry.function)
    if traced_at_event(report, entry, system) is None:
        return
    states = _states(entry, system, happenings, seen, samples)
    if not states:
        report.ok(what, f"not checked: no state at '{entry.at}' was found.", place)
        return
    p, values = ParameterValues(**samples.parameters), []
    for t, x in states:
        try:
            with np.errstate(all="ignore"):
                value = plain(entry.function)(t, x.copy(), p)
            values.append(float(value))
        except (Exception, SystemExit) as error:
            report.error(
                what,
                f"{entry.side.capitalize()} '{entry.at}' it raises {type(error).__name__}: {error}. It gets "
                f"a time t and a state x of shape ({len(system.states)},), and returns a number.",
                place_of_error(error, entry.function),
            )
            return
    finite = np.isfinite(values)
    where = f"{entry.side} '{entry.at}'"
    if not finite.any():
        report.error(what, f"It is not finite at any state {where} that was tried.", place)
    elif not finite.all():
        report.warning(what, f"It is not finite at {np.sum(~finite)} of {len(finite)} states {where}.", place)
    else:
        report.ok(what, f"gives a finite number {where}.", place)


def traced_at_event(report: Report, entry: Condition | Observable, system: System) -> Traced | None:
    """The function as a program; None, and a finding, where it cannot be used."""
    transition = _where(entry, system)
    mode = transition.source if entry.side == "before" else transition.target
    return traced(report, _words(entry), entry.function, system, number_form("function(t, x, p)"), mode=mode)


def _words(entry: Condition | Observable) -> str:
    kind = "condition" if isinstance(entry, Condition) else "observable"
    return f"{kind} '{entry.name}'"


def _where(entry: Condition | Observable, system: System) -> Transition:
    """The transition, the first one of its name."""
    name = str(entry.at)
    return system.transition(name, system.sources(name)[0])


def _states(
    entry: Condition | Observable,
    system: System,
    happenings: Sequence[Happening],
    seen: Seen | None,
    samples: Samples,
) -> list[tuple[float, np.ndarray]]:
    """Times and states of sample motions; without these any on the guard."""
    happening = next((h for h in happenings if h.transition.name == entry.at), None)
    if happening is None:
        return []
    met = seen.events.get(str(entry.at), []) if seen is not None else []
    states = (met or happening.before)[:MOST_STATES]
    if entry.side == "after":
        from contwalk.flow.hybrid.machine import applied, hybrid_machine  # compiled flows

        machine = hybrid_machine(system, samples.parameters)
        states = [(t, applied(machine, _where(entry, system), t, x)) for t, x in states]
    return [(t, x) for t, x in states if np.isfinite(x).all()]
