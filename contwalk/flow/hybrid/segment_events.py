"""A segment by the compiled event integrator, with what is watched located where it has marked a step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from contwalk.flow.events.crossings import Event, crossings
from contwalk.flow.hybrid import event_records as answers
from contwalk.flow.hybrid.event_integrator import METHOD, EventIntegrator
from contwalk.flow.hybrid.guard_status import GuardStatus, leaving_zero
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import Control, MotionSegment, at_once_too_fast, far, part_of, why
from contwalk.flow.hybrid.segment_paths import by_paths, event_of

ROOM = 100
# Memory of integrators that no motion uses now: for each machine, by their mode.
_IDLE: WeakKeyDictionary[HybridMachine, dict[str, list[EventIntegrator]]] = WeakKeyDictionary()
_STATUS = {answers.NOT_FINITE: "not_finite", answers.STEP_TOO_SMALL: "step_too_small"}


class ByEventIntegrator:
    """Segments of one motion.

    Parameters
    ----------
    machine : HybridMachine
    control : Control
        Its method is `event_integrator.METHOD`.
    """

    def __init__(self, machine: HybridMachine, control: Control) -> None:
        self._machine, self._control = machine, control

    @contextmanager
    def _integrator(self, mode: str) -> Iterator[EventIntegrator]:
        """One of a mode, as long as a segment lasts: a motion may be held while another one goes on."""
        idle = _IDLE.setdefault(self._machine, {}).setdefault(mode, [])
        if idle:
            found = idle.pop()
            found.weigh(self._control.weights)
        else:
            found = EventIntegrator(self._machine, self._control.weights, [mode], room=ROOM, marks=True)
        try:
            yield found
        finally:
            idle.append(found)

    def parts(
        self,
        flow: ModeFlow,
        t: float,
        x: np.ndarray,
        t1: float,
        standing: Sequence[GuardStatus],
        last: str | None,
        noise: np.ndarray,
    ) -> Iterator[MotionSegment]:
        """As `by_paths`, which takes over where the integrator is not sure.

        The segment begins after the transition `last`, with these uncertainties of the states, shape (m,).
        """
        with self._integrator(flow.name) as integrator:
            integrator.begin(t, x, flow.name, last, noise=noise)
            yield from self._parts(integrator, flow, t, x, t1, standing)

    def _parts(
        self,
        integrator: EventIntegrator,
        flow: ModeFlow,
        t: float,
        x: np.ndarray,
        t1: float,
        standing: Sequence[GuardStatus],
    ) -> Iterator[MotionSegment]:
        n = len(flow.states)
        nodes, counts = integrator.nodes[flow.name], integrator.places[flow.name].counts
        weights = self._control.weights[flow.states]
        leaving = leaving_zero(standing)
        while t < t1:
            end = t1 if np.isfinite(t1) else t + far(flow, t, x[flow.states], weights)
            if not end > t:
                yield at_once_too_fast(flow, t, x)
                return
            nodes[0, :n] = x[flow.states]
            counts.evaluations = 0
            answer = integrator(end, self._control.tolerance)
            steps = integrator.happened.own_steps
            times, states = integrator.times[: steps + 1].copy(), nodes[: steps + 1, :n].copy()
            if steps:
                seen = self._watched(flow, times, states, integrator.marks[:steps], leaving)
                part = part_of(self._machine, flow, times, states, seen, counts.evaluations)
                t, x, leaving = float(times[-1]), part.states[-1], {}
            if answer in (answers.ARRIVED, answers.AWAY):
                name = integrator.transitions[integrator.itinerary[0]].name
                yield replace(part, transition=name, rising=self._rises(flow, name, t, states[-1]))
                return
            if answer in _STATUS:
                part = part if steps else MotionSegment(flow.name, np.array([t]), x[None])
                yield replace(part, status=_STATUS[answer], reason=why(flow, _STATUS[answer], t))
                return
            if steps:
                yield part
                standing = ()
            if answer == answers.UNSURE:
                yield from by_paths(self._machine, flow, t, x, t1, self._control, standing)
                return
            if answer == answers.TIME_UP and t < t1:
                integrator.begin(t, x, flow.name, None)

    def _watched(
        self,
        flow: ModeFlow,
        times: np.ndarray,
        states: np.ndarray,
        marks: np.ndarray,
        leaving: Mapping[int, int],
    ) -> list[Event]:
        """Crossings of watched guards on the marked steps."""
        if not self._control.watched:
            return []
        events = []
        for step in np.flatnonzero(marks).tolist():
            mark = int(marks[step])
            numbers = [i for i in range(len(flow.guards)) if mark >> min(i, answers.MOST_BITS) & 1]
            numbers = [i for i in numbers if not flow.acting(i)]
            guards = [flow.guards[i] for i in numbers]
            begins = {k: leaving[i] for k, i in enumerate(numbers) if i in leaving} if step == 0 else {}
            own = slice(step, step + 2)
            found = crossings(flow.field, flow.c, flow.p, times[own], states[own], guards, METHOD, begins)
            events += [event_of(self._machine, flow, replace(at, guard=numbers[at.guard])) for at in found]
        return events

    def _rises(self, flow: ModeFlow, name: str, t: float, x: np.ndarray) -> bool:
        """Which way the guard passes zero at its event."""
        number = [transition.name for transition in flow.transitions].index(name)
        guard = flow.guards[number]
        return guard.direction > 0 or (guard.direction == 0 and guard(t, x, flow.p)[1] > 0.0)
