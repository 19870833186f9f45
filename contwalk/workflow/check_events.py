"""Transitions: guards, resets, and whether a guard is left behind by its own reset."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.system import System, Transition
from contwalk.workflow.check_findings import Report, place_of
from contwalk.workflow.check_functions import EPSILON, check_guard, check_map
from contwalk.workflow.check_samples import Samples
from contwalk.workflow.check_traced import Traced, vector_form

TRIES = 40
ITERATIONS = 30
# Rounding leaves a guard this far from zero, in units of the rounding of its terms.
FACTOR = 1e3
_SEED = 21


def check_transition(
    report: Report, transition: Transition, system: System, fields: Mapping[str, Traced], samples: Samples
) -> None:
    """Check the guard and the reset of a transition, and both together."""
    name = transition.name
    guard = check_guard(report, f"guard of transition '{name}'", transition.guard, system, samples)
    if transition.reset is None:
        return
    what = f"reset of transition '{name}'"
    form = vector_form(system, "reset", "x_plus")
    reset = check_map(report, what, transition.reset, system, samples, form)
    if guard is None or reset is None or not {transition.source, transition.target} <= set(fields):
        return
    _check_leaving(report, transition, guard, reset, fields, samples, system)


def _check_leaving(
    report: Report,
    transition: Transition,
    guard: Traced,
    reset: Traced,
    fields: Mapping[str, Traced],
    samples: Samples,
    system: System,
) -> None:
    """After its own reset a guard that is armed again must be off zero on the right side, or leaving it."""
    what, place = f"reset of transition '{transition.name}'", place_of(transition.reset)
    if not any(t.source == transition.target and t.guard is transition.guard for t in system.transitions):
        report.ok(what, "leads to a mode in which its guard is not armed.", place)
        return
    events = _states_at_event(transition, guard, fields[transition.source], samples)
    after = [
        _departure(transition, guard, reset, fields[transition.target], t, x, samples) for t, x in events
    ]
    known = [departure for departure in after if np.isfinite(departure)]
    leaving = sum(departure > 0.0 for departure in known)
    if not known:
        report.ok(
            what, "not checked whether its guard is left behind: no state at the event was found.", place
        )
    elif leaving == len(known):
        report.ok(what, f"leaves its guard behind, at {leaving} states at the event.", place)
    else:
        share = "at every state" if leaving == 0 else f"at {len(known) - leaving} of {len(known)} states"
        sentence = (
            f"After its own reset the guard is not left behind {share} at the event that was tried: it is "
            "zero and does not move away, or has passed zero already: the event would happen again at once."
        )
        if leaving == 0:
            report.error(what, f"{sentence} Correct the reset, or lead to a mode without this guard.", place)
        else:
            report.warning(what, f"{sentence} A motion that gets there ends.", place)


def _states_at_event(
    transition: Transition, guard: Traced, field: Traced, samples: Samples
) -> list[tuple[float, np.ndarray]]:
    """Times and states on the guard that approach it in the transition's direction."""
    random = np.random.default_rng(_SEED)
    found = []
    for k in range(TRIES):
        row = k % len(samples.states)
        t = float(samples.times[row])
        x = samples.states[row] + samples.scales * random.standard_normal(len(samples.scales))
        at = _onto(guard, t, x, samples)
        if at is None:
            continue
        rate = _rate(guard, field, t, at, samples)
        if np.isfinite(rate) and rate != 0.0 and _sign(transition, rate) * rate > 0.0:
            found.append((t, at))
    return found


def _onto(guard: Traced, t: float, x: np.ndarray, samples: Samples) -> np.ndarray | None:
    """The state where the guard is zero, reached along its gradient in the metric of the scales."""
    for _ in range(ITERATIONS):
        value = guard.values(t, x, samples.values)[0]
        if not np.isfinite(value):
            return None
        if abs(value) <= _level(guard, t, x, samples):
            return x
        slope = guard.slopes(t, x, samples.values)[0, 1:]
        scaled = slope * samples.scales
        if not np.isfinite(scaled).all() or not scaled.any():
            return None
        x = x - value * samples.scales * scaled / (scaled @ scaled)
    return None


def _departure(
    transition: Transition,
    guard: Traced,
    reset: Traced,
    field: Traced,
    t: float,
    x: np.ndarray,
    samples: Samples,
) -> float:
    """Positive where the guard is left behind after the reset; NaN where that has no value."""
    after = reset.values(t, x, samples.values)
    value = guard.values(t, after, samples.values)[0]
    if not np.isfinite(value):
        return np.nan
    rate = _rate(guard, field, t, after, samples)
    zero = abs(value) <= FACTOR * _level(guard, t, after, samples)
    if transition.direction == "both":
        return abs(rate) if zero else abs(value)
    away = 1.0 if transition.direction == "falling" else -1.0
    return away * (rate if zero else value)


def _rate(guard: Traced, field: Traced, t: float, x: np.ndarray, samples: Samples) -> float:
    """Rate of the guard along the motion, exactly zero where it is so but for rounding."""
    slope = guard.slopes(t, x, samples.values)[0]
    terms = slope * np.array([1.0, *field.values(t, x, samples.values)])
    rate = float(terms.sum())
    return 0.0 if abs(rate) <= FACTOR * EPSILON * np.abs(terms).sum() else rate


def _level(guard: Traced, t: float, x: np.ndarray, samples: Samples) -> float:
    """What rounding leaves of the guard at a zero."""
    slope = guard.slopes(t, x, samples.values)[0]
    bound = guard.roundings(t, x, samples.values)[0]
    return 2.0 * EPSILON * float(bound + np.abs(slope) @ np.abs([t, *x]))


def _sign(transition: Transition, rate: float) -> float:
    """The sign that the guard's rate has at the event."""
    if transition.direction == "both":
        return float(np.sign(rate))
    return -1.0 if transition.direction == "falling" else 1.0
