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
# So many times what it is at sampled states a number is at a pole, as near as rounding leaves it there.
POLE = 1e10


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
    states = _states(str(entry.at), entry.side, system, happenings, seen, samples)
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
    transition = _transition(str(entry.at), system)
    mode = transition.source if entry.side == "before" else transition.target
    return traced(report, _words(entry), entry.function, system, number_form("function(t, x, p)"), mode=mode)


def _words(entry: Condition | Observable) -> str:
    kind = "condition" if isinstance(entry, Condition) else "observable"
    return f"{kind} '{entry.name}'"


def _transition(name: str, system: System) -> Transition:
    """The transition, the first one of its name."""
    return system.transition(name, system.sources(name)[0])


def _states(
    name: str,
    side: str,
    system: System,
    happenings: Sequence[Happening],
    seen: Seen | None,
    samples: Samples,
) -> list[tuple[float, np.ndarray]]:
    """Times and states of sample motions before or after a transition; without these any on the guard."""
    happening = next((h for h in happenings if h.transition.name == name), None)
    if happening is None:
        return []
    met = seen.events.get(name, []) if seen is not None else []
    states = (met or happening.before)[:MOST_STATES]
    if side == "after":
        from contwalk.flow.hybrid.machine import applied, hybrid_machine  # compiled flows

        machine = hybrid_machine(system, samples.parameters)
        states = [(t, applied(machine, _transition(name, system), t, x)) for t, x in states]
    return [(t, x) for t, x in states if np.isfinite(x).all()]


def check_at_all_events(
    report: Report,
    observable: Observable,
    system: System,
    happenings: Sequence[Happening],
    seen: Seen | None,
    samples: Samples,
) -> None:
    """Whether an observable over the motion has a value at the states of events, which motions pass exactly.

    Sampled states are at no event: a pole there is met by every orbit with that event, and by none of them.
    """
    function, p = plain(observable.function), ParameterValues(**samples.parameters)

    def sizes(states: Sequence[tuple[float, np.ndarray]]) -> np.ndarray:
        with np.errstate(all="ignore"):
            return np.abs([float(function(np.array([t]), x[None].copy(), p)) for t, x in states])

    try:
        usual = float(np.max(sizes(list(zip(samples.times, samples.states, strict=True)))))
        most = POLE * usual if usual > 0.0 else np.finfo(float).max
        for name in dict.fromkeys(h.transition.name for h in happenings if h.transition.role != "watched"):
            for side in ("before", "after"):
                states = _states(name, side, system, happenings, seen, samples)
                lacking = ~(sizes(states) <= most)
                if np.any(lacking) and np.isfinite(usual):
                    _tell_pole(
                        report, observable, f"{np.sum(lacking)} of {len(states)} states {side} '{name}'"
                    )
                    return
    except (
        Exception,
        SystemExit,
    ):  # it is told with sampled states, or of motions, which are not one instant
        return


def _tell_pole(report: Report, observable: Observable, where: str) -> None:
    report.warning(
        _words(observable),
        f"It is not finite, or has a pole, at {where}: orbits with this event have no value of it. Leave the "
        "states at events out, or return what is finite there.",
        place_of(observable.function),
    )
