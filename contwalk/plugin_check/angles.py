"""Declared periods of angles: are fields, guards and resets the same a period later?"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from contwalk.fields.derivative import ancestors
from contwalk.fields.periodic import repeats
from contwalk.fields.trace import roots
from contwalk.plugin_check.digits import meant_with_pi, told_apart
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON
from contwalk.plugin_check.modes import CheckedFields
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced
from contwalk.system import State, System

# Bounds of rounding errors are of first order and of single operations.
FACTOR = 1e3


def check_angles_of_fields(report: Report, system: System, fields: CheckedFields, samples: Samples) -> None:
    """Check f(x + T e) = f(x) for each angle with a declared period T; a multiple of its own is one too."""
    for index, state in _angles(system):
        what, compared, known, told = f"period of state '{state.name}'", 0, 0, False
        for mode, field in fields.items():
            if index in field.existing and _repeats(field, index):
                known += 1
                continue
            found = _compared(field, index, samples, np.abs)
            compared += found[0]
            if found[1]:
                remedy = (
                    _typed(field, index, samples, np.abs)
                    or _together(field, index, samples)
                    or "Correct the period or the field, or leave the period out."
                )
                report.error(
                    what,
                    f"The field of mode '{mode}' is another one a period of {state.period:.10g} later: "
                    f"{found[1]}. States that differ by a period count as the same motion. {remedy}",
                    place_of(field.function),
                )
                told = True
                break
        if compared and not told:
            report.ok(what, f"fields are the same a period later, at {compared} states.")
        elif known and not told:
            report.ok(what, "fields are the same a period later, by their form.")


def check_angles_at_event(
    report: Report, name: str, guard: Traced | None, reset: Traced | None, samples: Samples
) -> None:
    """Warn of a guard that is another one a period later, and of a reset that goes on by a part of one.

    Motions that stay on one side of the event are right all the same, as of a pendulum between stops.
    """
    for kind, function in (("guard", guard), ("reset", reset)):
        if function is None:
            continue
        for index, state in _angles(function.system):
            changes = np.abs if kind == "guard" else _beyond_turns(function.system)
            _, differs = _compared(function, index, samples, changes)
            if not differs:
                continue
            later = f"It is another one a period of '{state.name}' ({state.period:.10g}) later: {differs}."
            remedy = _typed(function, index, samples, changes) or (
                "Write it with sine and cosine of the angle, or leave the period out; for motions that never "
                "go round it is right."
            )
            report.warning(
                f"{kind} of transition '{name}'",
                f"{later} States that differ by a period count as the same motion: an orbit that goes round "
                f"would be closed, though the event does not happen again as it did. {remedy}",
                place_of(function.function),
            )


def _angles(system: System) -> Iterator[tuple[int, State]]:
    return ((i, state) for i, state in enumerate(system.states) if state.period)


def _beyond_turns(system: System) -> Callable[[np.ndarray], np.ndarray]:
    """Changes of a state without whole periods of its angles."""
    periods = np.array([state.period or 0.0 for state in system.states])

    def rest(change: np.ndarray) -> np.ndarray:
        turns = np.round(np.divide(change, periods, out=np.zeros_like(change), where=periods > 0.0))
        return np.abs(change - turns * periods)

    return rest


def _reads(function: Traced, index: int) -> bool:
    """Whether a state is among what a function is computed from."""
    graph = function.program.graph
    return graph.input("x", index) in ancestors(graph, roots(function.program.tree))


def _repeats(function: Traced, index: int) -> bool:
    """Whether a function is written in a state such that it is the same a period later."""
    graph, period = function.program.graph, function.system.states[index].period or 0.0
    return repeats(graph, roots(function.program.tree), graph.input("x", index), period)


def _typed(function: Traced, index: int, samples: Samples, size: Callable[[np.ndarray], Any]) -> str:
    """What to do about a period that was typed with too few digits; empty if it was not."""
    period = function.system.states[index].period or 0.0
    meant = meant_with_pi(period, lambda exact: not _compared(function, index, samples, size, exact)[1])
    return meant and f"It is the same after {meant}: write period={meant}, with all digits."


def _together(function: Traced, index: int, samples: Samples) -> str:
    """What to do where a function is the same if several angles go on by a period at once; else empty."""
    own, *others = sorted(_angles(function.system), key=lambda angle: angle[0] != index)
    for group in [*([other] for other in others), *([others] if len(others) > 1 else [])]:
        for sign in (1.0, -1.0):
            shifts = {i: sign * (state.period or 0.0) for i, state in group}
            compared, differs = _compared(function, index, samples, np.abs, besides=shifts)
            if compared and not differs:
                return _as_differences(own[1], [state for _, state in group], sign)
    return ""


def _as_differences(own: State, others: Sequence[State], sign: float) -> str:
    """Angles that are periodic together, as one angle and what the others are beside it."""
    names = [state.name for state in (own, *others)]
    ratios = [(state.period or 0.0) / (own.period or 1.0) * sign for state in others]
    sums = [
        f"{state.name} {'-' if ratio > 0.0 else '+'} "
        + ("" if abs(ratio) == 1.0 else f"{abs(ratio):g} * ")
        + own.name
        for state, ratio in zip(others, ratios, strict=True)
    ]
    how = "together" if sign > 0.0 else "against each other"
    return (
        f"It is the same where {' and '.join(names)} go on by a period {how}: keep {own.name} as an angle, "
        f"and in place of {', '.join(names[1:])} write {', '.join(sums)}, without a period."
    )


def _compared(
    function: Traced,
    index: int,
    samples: Samples,
    size: Callable[[np.ndarray], Any],
    after: float | None = None,
    besides: Mapping[int, float] = MappingProxyType({}),
) -> tuple[int, str]:
    """At how many states a function was compared with itself a period later, and what differs at one.

    `after` is another period than the declared one; `besides`, by how much which other states go on as well.
    """
    if index not in function.existing or not _reads(function, index):
        return 0, ""
    compared, period = 0, after or function.system.states[index].period or 0.0
    for t, x in zip(samples.times, samples.states, strict=True):
        x = function.given(x)
        later = x.copy()
        later[index] += period
        for other, shift in besides.items():
            later[other] += shift
        now, then = (function.values(t, y, samples.values) for y in (x, later))
        if not (np.isfinite(now).all() and np.isfinite(then).all()):
            continue
        compared += 1
        apart = size(then - now)
        allowed = FACTOR * EPSILON * (np.abs(now) + np.abs(then))
        if (apart <= allowed).all():
            continue  # how much more rounding may let them differ need not be asked for
        for y in (x, later):
            slope = np.abs(function.slopes(t, y, samples.values)[:, 1:])
            allowed += FACTOR * EPSILON * (function.roundings(t, y, samples.values) + slope @ np.abs(y))
        if (apart > allowed).any():
            i = int(np.argmax(apart - allowed))
            entry = function.form.entry(i) if function.form.argument else "its value"
            values = told_apart(float(now[i]), float(then[i]))
            return compared, f"{entry} is {values[0]} at {function.system.state_names[index]} = " + (
                f"{x[index]:.4g} and {values[1]} a period later"
            )
    return compared, ""
