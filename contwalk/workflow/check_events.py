"""Transitions: guards, resets, and whether a guard is left behind by its own reset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.fields.derivative import jacobian
from contwalk.system import System, Transition
from contwalk.workflow.check_findings import Report, place_of
from contwalk.workflow.check_functions import EPSILON, check_guard, check_map
from contwalk.workflow.check_samples import Samples
from contwalk.workflow.check_traced import Traced, number_form, vector_form

TRIES = 40
ITERATIONS = 30
# Rounding leaves a guard this far from zero, in units of the rounding of its terms.
FACTOR = 1e3
_SEED = 21


@dataclass(frozen=True, eq=False)
class Jump:
    """What a transition makes of a state: reset, then relabelling; None where there is none."""

    transition: Transition
    reset: Traced | None
    relabel: Traced | None
    target: np.ndarray

    def values(self, t: float, x: np.ndarray, parameters: Sequence[float]) -> np.ndarray:
        """The state after it; NaN where there is none."""
        for part in (self.reset, self.relabel):
            x = x if part is None else part.values(t, x, parameters)
        return np.where(self.target, x, 0.0)


@dataclass(frozen=True, eq=False)
class Happening:
    """A transition that can be used: its guard, its jump, and times and states (full length) right before it."""

    transition: Transition
    guard: Traced
    jump: Jump
    before: list[tuple[float, np.ndarray]]


def check_transition(
    report: Report, transition: Transition, system: System, fields: Mapping[str, Traced], samples: Samples
) -> Happening | None:
    """Check the guard and the reset of a transition, and both together; None where they cannot be used."""
    guard = check_guard(report, f"guard of transition '{transition.name}'", transition, system, samples)
    jump = _check_jump(report, transition, system, samples)
    if guard is None or jump is None or not {transition.source, transition.target} <= set(fields):
        return None
    before = _states_at_event(transition, guard, fields[transition.source], samples)
    if transition.role != "watched" and transition.reset is not None:
        _check_leaving(report, transition, jump, before, fields[transition.target], samples, system)
    return Happening(transition, guard, jump, before)


def _check_jump(report: Report, transition: Transition, system: System, samples: Samples) -> Jump | None:
    """Check the reset, if there is one; what is wrong with the relabelling is found with the symmetry."""
    into = system.states_of(transition.target)
    target = np.isin(np.arange(len(system.states)), into)
    relabel = None
    if transition.relabel is not None:
        own = next(s for s in system.symmetries if s.name == transition.relabel)
        try:
            relabel = Traced(own.map, system, vector_form(system, "map", "x_image"))
        except ContwalkError:
            return None
    if transition.reset is None:
        return Jump(transition, None, relabel, target)
    needed = set(into) if relabel is None else _read(relabel, into)
    all_needed = len(needed) == len(system.states)
    form = vector_form(system, "reset", "x_plus", None if all_needed else needed)
    what, source = f"reset of transition '{transition.name}'", transition.source
    reset = check_map(report, what, transition.reset, system, samples, form, source)
    return None if reset is None else Jump(transition, reset, relabel, target)


def _read(relabel: Traced, into: Sequence[int]) -> set[int]:
    """The states that a map takes the states `into` from."""
    graph = relabel.program.graph
    inputs = [graph.input("x", i) for i in relabel.existing]
    rows = [jacobian(graph, [leaf.nodes[i] for i in into], inputs) for leaf in relabel.outputs()]
    return {k for leaf in rows for row in leaf for k in row}


def _check_leaving(
    report: Report,
    transition: Transition,
    jump: Jump,
    events: list[tuple[float, np.ndarray]],
    field: Traced,
    samples: Samples,
    system: System,
) -> None:
    """After its own reset a guard that is armed again must be off zero on the right side, or leaving it."""
    what, place = f"reset of transition '{transition.name}'", place_of(transition.reset)
    if not any(t.source == transition.target and t.guard is transition.guard for t in system.transitions):
        report.ok(what, "leads to a mode in which its guard is not armed.", place)
        return
    guard = Traced(transition.guard, system, number_form("guard(t, x, p)"), mode=transition.target)
    after = [_departure(transition, guard, jump, field, t, x, samples) for t, x in events]
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
        at = _onto(guard, t, guard.given(x), samples)
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
    jump: Jump,
    field: Traced,
    t: float,
    x: np.ndarray,
    samples: Samples,
) -> float:
    """Positive where the guard is left behind after the reset; NaN where that has no value."""
    after = jump.values(t, x, samples.values)
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
