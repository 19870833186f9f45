"""Whether a motion survives a push: it is simulated, and its end is compared with the solution it left."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.flow.hybrid.motion_events import TIME_UP, MotionEvents, Standpoint
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.numerics.linear import SMALLEST
from contwalk.studies.margins.consistency import placed
from contwalk.studies.margins.solution import Instant, Solution
from contwalk.system import Symmetry, System
from contwalk.system.falling import FALLEN, falls, name_of_fall

# How motions end: reason codes. All but the first are failures.
SURVIVED = "survived"
ENDED = "ended"
ACCUMULATED = "events_accumulate"
LEFT = "left_sequence"
AWAY = "did_not_return"
BEYOND = "beyond_guard"

MEANINGS = {
    SURVIVED: "the motion survives",
    FALLEN: "the machine falls",
    ENDED: "the motion ends: its field or a guard has no value, or steps become too small",
    ACCUMULATED: "infinitely many events happen in a finite time, or far more than on the solution",
    LEFT: "the events at the end are not those of the solution in their order",
    AWAY: "the motion is not back at the solution",
    BEYOND: "the push carries a guard past zero: the machine cannot be there",
}

CHATTER = "chatter"  # what a motion says of itself whose events accumulate

# In so many periods at the end the events must once have been those of the solution.
LAPS = 2

# So many times more hard events within a period than on the solution are chatter: where a model leaves open
# what comes after, such a motion would take as long as all others together.
MANY = 1000


@dataclass(frozen=True)
class Rule:
    """What surviving means.

    Parameters
    ----------
    duration : float
        Seconds to survive for.
    sequence : bool
        Whether the solution's events must happen in their order at the end.
    returns : float, optional
        How near to a state of the solution the motion must be at the end, in units of the states' magnitudes;
        None where it need not. Angles count but for whole turns, neutral states do not count.
    tolerance, method
        Of the integration.
    """

    duration: float
    sequence: bool
    returns: float | None
    tolerance: float
    method: str


@dataclass(eq=False)
class Survival:
    """The test of one solution of a machine."""

    system: System
    solution: Solution
    rule: Rule

    def __post_init__(self) -> None:
        self._falling = name_of_fall(self.system)
        self.machine = hybrid_machine(_falling(self.system), self.solution.parameters)
        self._hard = {t.name for t in self.system.transitions if t.role == "hard"}
        control = Control(self.rule.tolerance, self.solution.magnitudes, self.rule.method, watched=False)
        self._motion = MotionEvents(self.machine, control, {self._falling})
        self._most = MANY * max(sum(len(group) for group in self.solution.cycle), 1)

    def verdict(self, instant: Instant, push: np.ndarray) -> str:
        """How a motion ends that sets out from an instant with a push, shape (n,), added to its state."""
        ended, events = self.followed(instant, push)
        if ended != SURVIVED:
            return ended
        if self.rule.sequence and not self._keeps(events, instant.time + self.rule.duration):
            return LEFT
        if self.rule.returns is not None and not self.distance(self.end.state) <= self.rule.returns:
            return AWAY
        return SURVIVED

    @property
    def end(self) -> Standpoint:
        """Where the last motion was at its end."""
        return self._motion.at

    def followed(self, instant: Instant, push: np.ndarray) -> tuple[str, list[tuple[str, float]]]:
        """As `verdict` of what ends a motion early, and its hard events with their times."""
        pushed = instant.state + push
        begins = instant.time, instant.mode, instant.state
        place = placed(self.machine, *begins, pushed, {self._falling}, instant.last or None)
        if place.beyond:
            return BEYOND, []
        # Where the mode stays the event has just happened, so that its guard is not asked again.
        begin = Standpoint(instant.time, place.mode, place.state, place.last)
        return self.moved(begin, self.rule.duration)

    def moved(self, begin: Standpoint, duration: float) -> tuple[str, list[tuple[str, float]]]:
        """As `followed`, from where a motion stands."""
        motion, events = self._motion, []
        try:
            with np.errstate(all="ignore"):
                for name, time in motion.events(begin, begin.time + duration):
                    if name in self._hard:
                        events.append((name, time))
                        if self._chatters(events):
                            return ACCUMULATED, events
        except (ContwalkError, ArithmeticError):
            return ENDED, events
        if motion.status == self._falling:
            return FALLEN, events
        if motion.status != TIME_UP:
            return ACCUMULATED if motion.status == CHATTER else ENDED, events
        return SURVIVED, events

    def _chatters(self, events: Sequence[tuple[str, float]]) -> bool:
        """Whether `MANY` times the events of a period happen within one; equilibria have none."""
        most = self._most
        return len(events) > most and events[-1][1] - events[-1 - most][1] < self.solution.period

    def _keeps(self, events: Sequence[tuple[str, float]], end: float) -> bool:
        """Whether the events of the solution happen in their order once in the last periods."""
        cycle = self.solution.cycle
        late = [name for name, time in events if time >= end - LAPS * self.solution.period]
        length = sum(len(group) for group in cycle)
        rotations = [(*cycle[k:], *cycle[:k]) for k in range(len(cycle))]
        return any(
            _runs_through(late[first : first + length], rotation)
            for first in range(len(late) - length + 1)
            for rotation in rotations
        )

    def distance(self, state: np.ndarray, course: np.ndarray | None = None) -> float:
        """How far a state is from the nearest one of the solution, or of another course, shape (k, n), in
        units of the magnitudes."""
        off = (self.solution.course if course is None else course) - state
        for place, declared in enumerate(self.system.states):
            if declared.name in self.solution.neutral:
                off[:, place] = 0.0
            elif declared.period:
                off[:, place] -= declared.period * np.floor(off[:, place] / declared.period + 0.5)
        off = np.nan_to_num(off / self.solution.magnitudes, nan=0.0)
        ahead = np.diff(off, axis=0)
        lengths = np.maximum((ahead**2).sum(axis=1), SMALLEST)
        shares = np.clip(-(off[:-1] * ahead).sum(axis=1) / lengths, 0.0, 1.0)
        nearest = np.concatenate([off, off[:-1] + shares[:, None] * ahead])
        return float(np.sqrt((nearest**2).sum(axis=1).min()))


def _falling(system: System) -> System:
    """What moves the machine, and that it falls, in each mode."""
    acting = system.acting
    known = {transition.name for transition in acting}
    return replace(
        system,
        transitions=(*acting, *falls(system)),
        symmetries=tuple(_among(symmetry, known) for symmetry in system.symmetries),
        observables=(),
        signals=(),
        conditions=(),
        study=None,
    )


def _among(symmetry: Symmetry, known: Collection[str]) -> Symmetry:
    """The symmetry as far as it exchanges these events."""
    events = {name: image for name, image in symmetry.events.items() if name in known and image in known}
    return replace(symmetry, events=events)


def _runs_through(names: Sequence[str], groups: Sequence[Sequence[str]]) -> bool:
    """Whether names are those of the groups one after the other, in any order within a group."""
    at = 0
    for group in groups:
        if Counter(names[at : at + len(group)]) != Counter(group):
            return False
        at += len(group)
    return True
