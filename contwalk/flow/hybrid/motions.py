"""Motions of hybrid machines: segments between transitions.

A transition happens where its guard passes zero in its direction. What acts ends a segment, at the instant
that re-stepping finds to rounding; its reset and its relabelling give the state that the next segment begins
with. Of transitions that coincide to rounding the one declared first happens. Those whose guards pass zero
just then follow in segments without length; so do those whose guards are past zero, if they are declared to
act at entry.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from contwalk.flow.events.guard import EPSILON
from contwalk.flow.events.jump_instants import room
from contwalk.flow.hybrid.at_jumps import jumping, next_jump, over
from contwalk.flow.hybrid.blaming import (
    guard_without_rate,
    just_beyond,
    nearly_singular,
    what_jumps,
    why_not_finite,
    why_not_reached,
)
from contwalk.flow.hybrid.chatter import Pace, Verdict
from contwalk.flow.hybrid.clocks import Clocks, right_after
from contwalk.flow.hybrid.event_integrator import METHOD
from contwalk.flow.hybrid.guard_status import (
    BEYOND,
    ENTERING,
    RESTING,
    UNDEFINED,
    GuardStatus,
    guard_statuses,
    happens_at_once,
)
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow, applied, hybrid_machine, landed
from contwalk.flow.hybrid.motion_segment import FAR, Control, MotionSegment, far
from contwalk.flow.hybrid.segment_events import ByEventIntegrator
from contwalk.flow.hybrid.segment_paths import by_paths
from contwalk.python_functions import line_aside, line_of
from contwalk.system import Transition

__all__ = ["HybridMachine", "MotionSegment", "applied", "hybrid_machine", "motion_segments", "parts"]

MOST_STEPS = 100_000

# Where a field does not exist beyond a guard, steps get this near to it, in units of typical changes.
EDGE = 1e-12


def motion_segments(
    machine: HybridMachine,
    t0: float,
    x0: np.ndarray,
    mode: str,
    t1: float,
    control: Control,
    just_after: str | None = None,
    most_steps: int = MOST_STEPS,
    *,
    goes_on: bool = False,
) -> Iterator[MotionSegment]:
    """The segments of a motion from t0 until t1, which may be infinite if the caller stops asking.

    Parameters
    ----------
    machine : HybridMachine
    t0, x0, mode
        Time, full-length state and mode of the start.
    t1 : float
    control : Control
    just_after : str, optional
        The transition that has just led to the start.
    most_steps : int
        Of one segment.
    goes_on : bool
        Whether the motion goes on from where one has been left between events: what jumps at t0 is met then.
        Where a motion begins, what follows counts.

    Yields
    ------
    MotionSegment
        The last one has no transition, or a status that is not `ok`.
    """
    collected: list[MotionSegment] = []
    for part in parts(machine, t0, x0, mode, t1, control, just_after, goes_on=goes_on):
        collected.append(part)
        steps = sum(len(each.times) - 1 for each in collected)
        ends = part.transition is not None or part.status != "ok" or not part.times[-1] < t1
        if not ends and steps >= most_steps:
            reason = f"A segment in mode '{part.mode}' has taken {steps} steps and met no transition."
            reason += nearly_singular(machine, part.mode, float(part.times[-1]), part.states[-1])
            reason += what_jumps(machine, part)
            yield replace(_joined(collected), status="too_many_steps", reason=reason)
            return
        if ends:
            yield _joined(collected)
            collected = []


def _joined(collected: list[MotionSegment]) -> MotionSegment:
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
    control: Control,
    last: str | None = None,
    *,
    noise: np.ndarray | None = None,
    clocks: Clocks | None = None,
    goes_on: bool = False,
) -> Iterator[MotionSegment]:
    """As `motion_segments`, but a long one comes in parts of some steps: all but its last end in no event.

    A motion that goes on begins with uncertainties `noise` of its states, shape (n,), by default those of
    their rounding, and with `clocks` that know what has happened at its first instant.
    """
    integrator = ByEventIntegrator(machine, control) if control.method == METHOD else None
    t, x, pace = float(t0), machine.existing(mode, x0), Pace(float(t0), t1)
    flow = machine.mode(mode)
    begins = not goes_on and clocks is None
    if begins and last:
        t = right_after(flow, t, last)
    noise, clocks = EPSILON * np.abs(x) if noise is None else noise, clocks or Clocks(t)
    standing, verdict = _stands(flow, t, x, noise, control.weights, last, clocks)
    while t < t1 or verdict.status != "ok":
        if verdict.status != "ok":
            reason = verdict.reason + _blame(verdict, machine, flow, t, x)
            yield replace(_instant(flow, t, x), status=verdict.status, reason=reason)
            return
        segment = _without_time(flow, t, x, standing, None if begins else clocks, goes_on)
        if segment is None:
            segment, jump = _instant(flow, t, x), next_jump(flow, t, goes_on=goes_on)
            if jump is not None and not jump.low < t1:
                jump = None
            end = t1 if jump is None else jump.low
            if integrator is None:
                found = by_paths(machine, flow, t, x, end, control, standing)
            else:
                found = integrator.parts(flow, t, x, end, standing, last, noise)
            for part in found if jump is None or end - t > room(t) else ():
                segment = _explained(machine, flow, _at_edge(flow, part, control.weights), control.weights)
                if segment.transition is None:
                    yield segment
            if segment.transition is None:
                if jump is None or segment.status != "ok":
                    return
                segment = over(machine, flow, jump, segment, control.method)
                yield segment
                t, x, last, begins, goes_on = jump.high, segment.states[-1], None, False, True
                noise = EPSILON * np.abs(x)
                standing, verdict = _stands(flow, t, x, noise, control.weights, None, clocks)
                continue
        begins = goes_on = False
        last = name = str(segment.transition)
        t, happening = float(segment.times[-1]), machine.transition(name, flow.name)
        clocks.record(t, flow, name)
        before, earlier = segment.states[-1], noise
        x, noise = landed(machine, happening, t, before)
        noise = np.where(_kept(flow, name, t, before, x), np.maximum(noise, earlier), noise)
        flow = machine.mode(happening.target)
        standing, verdict = _stands(flow, t, x, noise, control.weights, name, clocks)
        if verdict.status == "ok":
            verdict = pace.verdict(t, name, [d for i, d in enumerate(standing) if flow.acting(i)])
        blame = _blame(verdict, machine, flow, t, x, (happening, before))
        if not np.isfinite(before).all():
            blame = why_not_reached(machine, happening, segment)
        yield replace(
            segment,
            after=x,
            status=verdict.status,
            reason=verdict.reason + blame,
            accumulation=verdict.accumulation,
        )
        if verdict.status != "ok" or t1 - t <= room(t):  # at its end, but for rounding
            return


def _kept(flow: ModeFlow, name: str, t: float, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The states that an event leaves as they were, and that its guard does not depend on; of full length."""
    number = next(i for i, transition in enumerate(flow.transitions) if transition.name == name)
    y, kept = before[flow.states], before == after
    gradient = flow.guards[number].slopes(t, y, flow.p, np.zeros(len(y))).gradient[1:]
    kept[flow.states] &= gradient == 0.0
    return kept


def _instant(flow: ModeFlow, t: float, x: np.ndarray) -> MotionSegment:
    """A segment without length."""
    return MotionSegment(flow.name, np.array([t]), x[None])


# -- where a motion begins or goes on ------------------------------------------------------------------------


def _stands(
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    noise: np.ndarray,
    weights: np.ndarray,
    last: str | None,
    clocks: Clocks,
) -> tuple[list[GuardStatus], Verdict]:
    """How the guards stand, and whether the motion can go on after the transition `last`."""
    y = x[flow.states]
    for what, values in (("state", y), ("field", flow.field(t, y, flow.c))):
        if not np.isfinite(values).all():
            begins = f"after transition '{last}'" if last else "at the start"
            reason = f"The {what} of mode '{flow.name}' is not finite {begins}, t = {t:.10g}."
            return [], Verdict("not_finite", reason)
    through = flow.passed(last) | clocks.gone_through(flow)
    own = flow.left_at_zero(last) | clocks.happened(t, flow) | through
    standing = guard_statuses(flow, t, y, noise[flow.states], weights[flow.states], own, through)
    clocks.stand(flow, standing)
    for number, (transition, guard) in enumerate(zip(flow.transitions, standing, strict=True)):
        if guard.kind == UNDEFINED and transition.role != "watched":
            return standing, Verdict(
                "not_finite", f"The guard of transition '{transition.name}' is not finite at t = {t:.10g}."
            )
        again = guard.kind == RESTING or happens_at_once(flow, number, guard)
        if transition.name == last and again:
            return standing, Verdict("sticking", _sticks(transition.name, t, guard))
    return standing, Verdict()


def _blame(
    verdict: Verdict,
    machine: HybridMachine,
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    landing: tuple[Transition, np.ndarray] | None = None,
) -> str:
    """The plugin's line, where something is not finite."""
    return why_not_finite(machine, flow.name, t, x, landing) if verdict.status == "not_finite" else ""


def _sticks(name: str, t: float, guard: GuardStatus) -> str:
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


def _at_edge(flow: ModeFlow, part: MotionSegment, weights: np.ndarray) -> MotionSegment:
    """The part, ended by the transition on whose guard the field ceases to exist."""
    if part.status not in ("not_finite", "step_too_small"):
        return part
    t, x = float(part.times[-1]), part.states[-1][flow.states]
    room = EDGE * flow.scales(t, x, weights[flow.states], 1.0)
    for i, guard in enumerate(flow.guards):
        value, rate, _ = guard(t, x, flow.p).tolist()
        nears = value * rate < 0.0 and guard.direction in (0, 1 if rate > 0.0 else -1)
        if flow.acting(i) and nears and abs(value) <= room[i]:
            name = flow.transitions[i].name
            return replace(part, transition=name, rising=rate > 0.0, status="ok", reason="")
    return part


def _explained(
    machine: HybridMachine, flow: ModeFlow, part: MotionSegment, weights: np.ndarray
) -> MotionSegment:
    """The part that cannot go on, with the guard and the plugin's line that have no value just beyond."""
    if part.status not in ("not_finite", "step_too_small"):
        return part
    t, x = float(part.times[-1]), part.states[-1]
    found = just_beyond(machine, flow, t, x, far(flow, t, x[flow.states], weights[flow.states]) / FAR)
    unsloped = guard_without_rate(flow, t, x)
    if found is None and unsloped is not None:
        reason = (
            f"The guard of transition '{unsloped.name}'{line_aside(unsloped.guard)} has a value and no rate "
            f"at t = {t:.10g}, as the root of something that is zero there. Write it without the root, such "
            "as x**2 + y**2 - r**2."
        )
        return replace(part, status="not_finite", reason=reason)
    if found is None:
        blame = nearly_singular(machine, flow.name, t, x)
        place = line_of(machine.system.mode(flow.name).field).removesuffix(": ")
        blame = blame or (f" It is the function at {place}." if place else "")
        return replace(part, reason=part.reason + blame)
    blame = why_not_finite(machine, flow.name, *found.at)
    if found.guard is None:
        return replace(part, reason=part.reason + blame)
    reason = f"The guard of transition '{found.guard}' is not finite beyond t = {t:.10g}.{blame}"
    return replace(part, status="not_finite", reason=reason)


def _without_time(
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    standing: Sequence[GuardStatus],
    clocks: Clocks | None,
    goes_on: bool,
) -> MotionSegment | None:
    """The segment without length that a transition ends right where the motion is; None if none happens.

    `clocks` are None where a motion begins, and no jump at that instant counts.
    """
    number = next((i for i, guard in enumerate(standing) if happens_at_once(flow, i, guard)), None)
    if number is not None:
        rises, collapsed = standing[number].side > 0, standing[number].kind == BEYOND
    elif clocks is not None and (jumps := jumping(flow, t, x, clocks, goes_on=goes_on)):
        (number, rises), collapsed = jumps, False
    else:
        return None
    name = flow.transitions[number].name
    return replace(_instant(flow, t, x), transition=name, rising=rises, collapsed=collapsed)
