"""Motions of hybrid machines: arcs between transitions.

A transition happens where its guard passes zero in its direction. What acts ends an arc, at the instant that
re-stepping finds to rounding; its reset and its relabelling give the state that the next arc begins with. Of
transitions that coincide to rounding the one declared first happens. Those whose guards are past zero then,
or pass it at once, follow in arcs without length.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.chatter import Pace, Verdict
from contwalk.flow.departure import BEYOND, ENTERING, LEAVING, RESTING, UNDEFINED, Departure, departures
from contwalk.flow.events import Crossing, Event, crossings
from contwalk.flow.guard import EPSILON
from contwalk.flow.hybrid_machine import HybridMachine, ModeFlow, applied, hybrid_machine, landed
from contwalk.flow.verbs import adaptive, along

__all__ = ["Arc", "HybridMachine", "applied", "arcs", "hybrid_machine", "parts"]

FIRST_STEPS, STEPS_AT_ONCE = 12, 50
MOST_STEPS = 100_000

# Events whose instants differ by less than so many roundings coincide.
COINCIDE = 8.0

# Errors of guards are at most this part of what typical changes of the states make of them: with larger ones
# their turns would not be resolved.
RESOLVED = 1e-4

# An end in infinity is replaced by one so many times away as the motion needs to pass through its magnitudes.
FAR = 1e4


@dataclass(frozen=True, eq=False)
class Arc:
    """A smooth piece of a motion, in one mode, between two events.

    Parameters
    ----------
    mode : str
    times : ndarray, shape (s + 1,)
        Ends of the integrator's steps: `along` on them gives the states again, bitwise. An arc without
        length, between transitions that happen at once, has one instant.
    states : ndarray, shape (s + 1, n)
        Of full length; states that do not exist in the mode are 0.
    transition : str, optional
        The one that ended it; None where the time was up, or where `status` says why it ended.
    after : ndarray, shape (n,), optional
        The state after the transition, with which the next arc begins.
    watched : list of Event
        Crossings of watched transitions inside.
    evaluations : int
    status : str
        `ok`, or why the motion cannot go on: `not_finite`, `step_too_small`, `too_many_steps`; `chatter`:
        transitions accumulate; `sticking`: a transition is not left behind after it has happened.
    reason : str
        A sentence for a status that is not `ok`.
    accumulation : float, optional
        The instant at which transitions accumulate, where it is known.
    rising : bool
        Whether the guard of the transition rose through zero.
    """

    mode: str
    times: np.ndarray
    states: np.ndarray
    transition: str | None = None
    after: np.ndarray | None = None
    watched: list[Event] = field(default_factory=list)
    evaluations: int = 0
    status: str = "ok"
    reason: str = ""
    accumulation: float | None = None
    rising: bool = False


def arcs(
    machine: HybridMachine,
    t0: float,
    x0: np.ndarray,
    mode: str,
    t1: float,
    tolerance: float,
    weights: np.ndarray,
    method: str = "dop853",
    just_after: str | None = None,
    most_steps: int = MOST_STEPS,
) -> Iterator[Arc]:
    """The arcs of a motion from t0 until t1, which may be infinite if the caller stops asking.

    Parameters
    ----------
    machine : HybridMachine
    t0, x0, mode
        Time, full-length state and mode of the start.
    t1 : float
    tolerance : float
        Local error of each step, in units of `weights`.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    method : str
        One of `flow.METHODS`.
    just_after : str, optional
        The transition that has just led to the start.
    most_steps : int
        Of one arc.

    Yields
    ------
    Arc
        The last one has no transition, or a status that is not `ok`.

    Raises
    ------
    StartError
        If a guard is past zero at the start.
    """
    collected: list[Arc] = []
    for part in parts(machine, t0, x0, mode, t1, tolerance, weights, method, just_after):
        collected.append(part)
        steps = sum(len(each.times) - 1 for each in collected)
        ends = part.transition is not None or part.status != "ok" or not part.times[-1] < t1
        if not ends and steps >= most_steps:
            reason = f"An arc in mode '{part.mode}' has taken {steps} steps and met no transition."
            yield replace(_joined(collected), status="too_many_steps", reason=reason)
            return
        if ends:
            yield _joined(collected)
            collected = []


def _joined(collected: list[Arc]) -> Arc:
    if len(collected) == 1:
        return collected[0]
    return replace(
        collected[-1],
        times=np.concatenate([collected[0].times, *(part.times[1:] for part in collected[1:])]),
        states=np.concatenate([collected[0].states, *(part.states[1:] for part in collected[1:])]),
        watched=[event for part in collected for event in part.watched],
        evaluations=sum(part.evaluations for part in collected),
    )


def parts(
    machine: HybridMachine,
    t0: float,
    x0: np.ndarray,
    mode: str,
    t1: float,
    tolerance: float,
    weights: np.ndarray,
    method: str = "dop853",
    just_after: str | None = None,
) -> Iterator[Arc]:
    """As `arcs`, but a long arc comes in parts of some steps: all but its last have no transition."""
    control = _Control(tolerance, np.asarray(weights, dtype=float), method)
    t, x, pace = float(t0), machine.existing(mode, x0), Pace(float(t0), t1)
    flow = machine.mode(mode)
    standing, verdict = _stands(flow, t, x, EPSILON * np.abs(x), just_after)
    if just_after is None:
        _refuse_beyond(flow, standing)
    if verdict.status != "ok":
        yield replace(_instant(flow, t, x), status=verdict.status, reason=verdict.reason)
        return
    while t < t1:
        number = _at_once(flow, standing)
        if number is None:
            arc = None
            for arc in _integrated(machine, flow, t, x, t1, control, standing):
                if arc.transition is None:
                    yield arc
            if arc is None or arc.transition is None:
                return
        else:
            rising = standing[number].side > 0
            arc = replace(_instant(flow, t, x), transition=flow.transitions[number].name, rising=rising)
        name = str(arc.transition)
        t = float(arc.times[-1])
        x, noise = landed(machine, name, t, arc.states[-1])
        flow = machine.mode(machine.transition(name).target)
        standing, verdict = _stands(flow, t, x, noise, name)
        if verdict.status == "ok":
            verdict = pace.verdict(t, name, [d for i, d in enumerate(standing) if flow.acting(i)])
        yield replace(
            arc,
            after=x,
            status=verdict.status,
            reason=verdict.reason,
            accumulation=verdict.accumulation,
        )
        if verdict.status != "ok":
            return


@dataclass(frozen=True, eq=False)
class _Control:
    """How steps are controlled; arguments as for `arcs`."""

    tolerance: float
    weights: np.ndarray
    method: str


def _instant(flow: ModeFlow, t: float, x: np.ndarray) -> Arc:
    """An arc without length."""
    return Arc(flow.name, np.array([t]), x[None])


# -- where a motion begins or goes on ------------------------------------------------------------------------


def _stands(
    flow: ModeFlow, t: float, x: np.ndarray, noise: np.ndarray, last: str | None
) -> tuple[list[Departure], Verdict]:
    """How the guards stand, and whether the motion can go on after the transition `last`."""
    y = x[flow.states]
    for what, values in (("state", y), ("field", flow.field(t, y, flow.c))):
        if not np.isfinite(values).all():
            begins = f"after transition '{last}'" if last else "at the start"
            reason = f"The {what} of mode '{flow.name}' is not finite {begins}, t = {t:.10g}."
            return [], Verdict("not_finite", reason)
    standing = departures(flow, t, y, noise[flow.states], () if last is None else (last,))
    for transition, guard in zip(flow.transitions, standing, strict=True):
        if guard.kind == UNDEFINED:
            return standing, Verdict(
                "not_finite", f"The guard of transition '{transition.name}' is not finite at t = {t:.10g}."
            )
        if transition.name == last and guard.kind in (ENTERING, BEYOND, RESTING):
            return standing, Verdict("sticking", _sticks(transition.name, t, guard))
    return standing, Verdict()


def _sticks(name: str, t: float, guard: Departure) -> str:
    how = f"is {guard.value:.6g} there, past zero already"
    if guard.kind == ENTERING:
        how = "is zero there and goes on in the same direction"
        if guard.rate != 0.0:
            how += f" (its rate is {guard.rate:.6g})"
    elif guard.kind == RESTING:
        how = "stays zero"
    return (
        f"Transition '{name}' at t = {t:.10g} does not leave its guard behind: it {how}, so that it "
        "would happen again at once. The plugin must declare a mode for what happens there, or correct "
        "the reset."
    )


def _refuse_beyond(flow: ModeFlow, standing: Sequence[Departure]) -> None:
    for i, guard in enumerate(standing):
        if guard.kind == BEYOND and flow.acting(i):
            name = flow.transitions[i].name
            side, passes = ("positive", "falls") if guard.value < 0.0 else ("negative", "rises")
            raise StartError(
                f"The guard of transition '{name}' is {guard.value:.6g} at the start, past zero already: the "
                f"transition happens where it {passes} through zero.",
                f"Start where it is {side}, or in another mode than '{flow.name}'. If the state is the one "
                f"right before the transition, say so: at: {name}.",
            )


def _at_once(flow: ModeFlow, standing: Sequence[Departure]) -> int | None:
    """The transition that happens without any time passing."""
    for i, guard in enumerate(standing):
        if guard.kind in (ENTERING, BEYOND) and flow.acting(i):
            return i
    return None


# -- up to the next transition -------------------------------------------------------------------------------


def _integrated(
    machine: HybridMachine,
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    t1: float,
    control: _Control,
    standing: Sequence[Departure],
) -> Iterator[Arc]:
    """Parts of an arc; the last one has the transition that ended it, or a status."""
    y, weights, method = x[flow.states], control.weights[flow.states], control.method
    leaving = {i: guard.side for i, guard in enumerate(standing) if guard.kind == LEAVING}
    resolving = flow.code.resolving(implicit=method.startswith("radau"))
    c, n = flow.constants(resolving), len(y)
    span = far(flow, t, y, weights) / FAR
    scales = flow.scales(t, y, weights, span) * min(1.0, RESOLVED / control.tolerance)
    sizes, most = np.concatenate([weights, scales]), FIRST_STEPS
    while t < t1:
        end = t1 if np.isfinite(t1) else t + far(flow, t, y, weights)
        values = [guard(t, y, flow.p)[0] for guard in flow.guards]
        start = np.concatenate([y, values])
        path = adaptive(resolving, c, t, start, end, control.tolerance, sizes, method, max_steps=most)
        times = path.times
        states = along(flow.field, flow.c, times, y, method)
        assert states.shape[1] == n
        found = crossings(flow.field, flow.c, flow.p, times, states, flow.guards, method, leaving)
        acting = [crossing for crossing in found if flow.acting(crossing.guard)]
        first = _first(acting)
        if first is not None:
            times = np.append(times[: first.step + 1], first.time)
            states = np.append(states[: first.step + 1], first.state[None], axis=0)
            if times[-1] == times[-2]:
                times, states = np.delete(times, -2), np.delete(states, -2, axis=0)
        part = Arc(
            flow.name,
            times,
            machine.full(flow.name, states),
            watched=[_event(machine, flow, at) for at in _seen(flow, found, first)],
            evaluations=path.evaluations,
        )
        if first is not None:
            yield replace(part, transition=flow.transitions[first.guard].name, rising=first.rising)
            return
        if path.status not in ("ok", "too_many_steps"):
            yield replace(part, status=path.status, reason=_why(flow, path.status, float(times[-1])))
            return
        yield part
        t, y, leaving, most = float(times[-1]), states[-1], {}, STEPS_AT_ONCE


def _first(acting: Sequence[Crossing]) -> Crossing | None:
    """The earliest; of those that coincide with it the one declared first."""
    if not acting:
        return None
    earliest = acting[0].time
    room = COINCIDE * EPSILON * abs(earliest)
    return min((each for each in acting if each.time <= earliest + room), key=lambda each: each.guard)


def _seen(flow: ModeFlow, found: Sequence[Crossing], first: Crossing | None) -> list[Crossing]:
    """Crossings of watched transitions, up to the one that ends the arc."""
    end = np.inf if first is None else first.time
    return [at for at in found if not flow.acting(at.guard) and at.time <= end]


def _event(machine: HybridMachine, flow: ModeFlow, at: Crossing) -> Event:
    state = machine.full(flow.name, at.state)
    return Event(flow.transitions[at.guard].name, at.time, at.rising, state, state, flow.name)


def far(flow: ModeFlow, t: float, y: np.ndarray, weights: np.ndarray) -> float:
    """A long time: at its present speed the motion would pass through its magnitudes many times."""
    speed = float(np.max(np.abs(flow.field(t, y, flow.c)) / weights, initial=0.0))
    return FAR / speed if np.isfinite(speed) and speed > 1e-4 else FAR


def _why(flow: ModeFlow, status: str, t: float) -> str:
    words = {"not_finite": "is not finite beyond", "step_too_small": "asks for steps below rounding at"}
    return f"The field of mode '{flow.name}' {words[status]} t = {t:.10g}."
