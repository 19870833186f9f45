"""Looking for a return while a motion is simulated: where an event finds it as an earlier one did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.motion_segment import MotionSegment
from contwalk.flow.hybrid.motions import HybridMachine, hybrid_machine
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid import families
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.hybrid.mirrors import Span, carries
from contwalk.problems.initial.coming_to_rest import check_moves
from contwalk.problems.initial.decaying import decaying
from contwalk.problems.initial.event_free import strobes
from contwalk.problems.initial.volume import Volume
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues
from contwalk.system.variables import declared_scales

# What a return misses by, in units of the variation: of a motion that has settled; at all.
SETTLED, NEARLY = 1e-5, 0.2
# A part of a recurrence that misses by less than so many times as much is the recurrence.
ROUND = 100.0
# The durations of recurrences that accumulate tend to less than this part of the last of them: to zero, but
# for rounding (a geometric series), or seemingly to half of it where they fall as 1/n.
SHRINKS = 0.75
# Two recurrences that are all there is last alike: the second is not shorter by more than this part.
ALIKE = 0.05
ROUNDING = 1e-9
# Events that are looked back.
LOOK_BACK = 64
# Steps within which a return is found or given up, and those that an event costs beside its own: it is
# located, happens, and is compared with earlier ones. A time that is to pass first may cost so much more.
MOST_STEPS, EVENT, BEFORE = 500_000, 25, 20
# The same where the first near return is looked for: a motion that is near an orbit comes back soon.
FIRST_STEPS = 200_000
# Periods of the forcing without an event before an orbit without events is looked for: no whole number, so
# that no event of a clock is cut off.
QUIET = 4.618
# How long to simulate at once, in units of what the fastest state needs to change by its own size; steps
# without an event after which there will be none, for a start that is said to be on an orbit and otherwise.
STRETCH, FIRST_PATIENCE, PATIENCE = 300.0, 2_000, 20_000
LEAST = 1e-3
# A return that is as good as this times the best one so far is as good.
AS_GOOD = 0.5


@dataclass(frozen=True, eq=False)
class _Arrival:
    """Where an event leads, or its image under a mirror: earlier stretches are compared with it."""

    time: float
    mode: str
    event: str
    after: np.ndarray
    scale: np.ndarray
    image: str


class Search:
    """Looks for a return while a motion is simulated."""

    # Other values of the parameters: a symmetry of the machine is one for these as well.
    elsewhere: Mapping[str, float] | None = None

    def __init__(
        self, system: System, parameters: Mapping[str, float], until: float | str | None, least: float = 0.0
    ) -> None:
        self.system, self.parameters, self.until, self.least = system, dict(parameters), until, least
        self.period = 0.0
        if system.period is not None:
            self.period = period_at(system, parameters)
        self.turns = np.array([s.period or 0.0 for s in system.states])
        self.stretches: list[Span] = []
        self.hard = False  # whether any of them ends with a hard transition
        self.low = np.full(len(system.states), np.inf)
        self.high = -self.low
        self.best: HybridRecurrence | None = None
        self.shrinking = 0.0  # duration of the first recurrence of those that accumulate
        self.settled: dict[tuple[int, str], set[int]] = {}  # when recurrences of a kind have come back
        self.patience = 0  # events until the best recurrence is taken, if it is one up to an image
        self.begun: tuple[float, np.ndarray] | None = (
            None  # time and state at the start of a leg that goes on
        )
        self.work = 0  # steps since a return has been looked for
        self.events = 0
        self.since = 0.0  # when that began
        self.volume = Volume()
        self.looking = not isinstance(until, int | float)
        self.first = True
        self.origin: np.ndarray | None = None
        self.note = ""  # on the start
        self.ended: MotionSegment | None = None
        self.last_state: tuple[float, np.ndarray, str] | None = None

    def weights(self, x: np.ndarray) -> np.ndarray:
        """Typical magnitudes of the states as far as they are known, shape (n,)."""
        seen = np.where(np.isfinite(self.low), 0.5 * (self.high - self.low), 0.0)
        reached = np.where(np.isfinite(self.low), np.maximum(np.abs(self.low), np.abs(self.high)), 0.0)
        known = np.maximum(seen, LEAST * np.maximum(np.abs(x), reached))
        largest = float(known.max())
        # What is zero, or nothing against the others, will be more than that.
        filled = np.where(known > ROUNDING * largest, known, LEAST * largest if largest > 0.0 else 1.0)
        # Of what has hardly moved the plugin knows more.
        scales = declared_scales(self.system.states)
        return np.where(seen <= LEAST * scales, scales, filled)

    def stretch(
        self, machine: HybridMachine, t: float, x: np.ndarray, mode: str, weights: np.ndarray
    ) -> float:
        """Seconds to simulate before it is noticed that nothing happens; states and weights are (n,)."""
        if self.period:
            return QUIET * self.period
        flow = machine.mode(mode)
        rates = np.abs(flow.field(t, x[flow.states], flow.c)) / weights[flow.states]
        fastest = float(np.max(rates, initial=0.0))
        return STRETCH / fastest if fastest > 0.0 else STRETCH

    def check_moves(self, machine: HybridMachine, arc: MotionSegment) -> None:
        """Raise where the motion of an autonomous system has come to rest without an event."""
        if not self.period and arc.transition is None and arc.status in ("ok", "too_many_steps"):
            reached = np.maximum(np.abs(self.low), np.abs(self.high))
            check_moves(self.system, machine.mode(arc.mode), arc, reached)

    def waits(self, steps: int) -> bool:
        """Whether to go on although nothing has happened for so many steps."""
        return steps < (PATIENCE if self.until is not None or self.first else FIRST_PATIENCE)

    @property
    def exhausted(self) -> bool:
        """Whether a return, or the time from which on it is looked for, has cost what it may."""
        return self.work > self._most * (1 if self.looking else BEFORE)

    @property
    def _most(self) -> int:
        return FIRST_STEPS if self.until is None else MOST_STEPS

    @property
    def keeps_volumes(self) -> bool:
        """Whether the motion does not settle within a search: volumes of states stay what they are in it."""
        return self.looking and self.volume.kept(self._span)

    @property
    def _span(self) -> float:
        """Seconds that a search lasts at most, as it has gone so far."""
        now = self.since if self.last_state is None else self.last_state[0]
        return (now - self.since) * self._most / max(self.work, 1)

    def hopeless(self, machine: HybridMachine, arc: MotionSegment) -> bool:
        """Whether to end the search after an arc: it has cost what it may, or nothing can settle."""
        if self.looking:
            self.volume.add(machine, arc, self.events)
        return self.exhausted or (self.keeps_volumes and self.volume.seen_all(machine))

    def _spend(self, arc: MotionSegment) -> None:
        """Count an arc's work; anew, once the time has passed that was asked for."""
        if not self.looking and float(arc.times[-1]) >= float(self.until or 0.0):
            self.looking, self.work, self.events, self.since = True, 0, 0, float(arc.times[0])
        happens = int(arc.transition is not None)
        self.events += happens
        self.work += len(arc.times) + EVENT * happens

    def see(self, arc: MotionSegment) -> None:
        """Take in how far the states go on an arc."""
        self.low = np.minimum(self.low, arc.states.min(axis=0))
        self.high = np.maximum(self.high, arc.states.max(axis=0))

    def add(self, arc: MotionSegment) -> HybridRecurrence | None:
        """Take an arc in; the recurrence that it closes, if it does."""
        self._spend(arc)
        self.see(arc)
        self.last_state = float(arc.times[-1]), arc.states[-1], arc.mode
        if arc.status != "ok":
            self.ended = arc
            return None
        if arc.transition is None:
            if not self.first and self.begun is None:  # the leg goes on
                self.begun = float(arc.times[0]), arc.states[0]
            return self._strobed(arc)
        transition = self.system.transition(arc.transition, arc.mode)
        if not self.first:
            leg = Leg(arc.mode, transition, not arc.rising, arc.collapsed)
            start, x = self.begun or (float(arc.times[0]), arc.states[0])
            lasting = float(arc.times[-1]) - start
            self.stretches.append(Span(leg, start, x, lasting, arc.states[-1]))
            self.hard = self.hard or transition.role == "hard"
        self.first, self.begun = False, None
        # Recurrences end with hard transitions, where there are any.
        return self._closed(arc) if self.stretches and not (transition.role == "soft" and self.hard) else None

    def _closed(self, arc: MotionSegment) -> HybridRecurrence | None:
        """The shortest recurrence that ends with this arc's event."""
        if not self.looking:
            return None
        shorter: list[HybridRecurrence] = []
        arrivals = [self._arrival(arc, image) for image in self.images]
        misses = np.array([self._misses(arrival) for arrival in arrivals])
        for back in np.flatnonzero((misses < NEARLY).any(axis=0)):
            for arrival, missed in zip(arrivals, misses[:, back], strict=True):
                if not (missed < ROUND * SETTLED or self._better(missed)):
                    continue
                part = self.stretches[-1 - back :]
                if not any(stretch.duration > 0.0 for stretch in part):  # transitions at one instant
                    continue
                recurrence = self._recurrence(arrival, part, float(missed))
                if recurrence is None:
                    continue
                if self._better(missed):
                    self.best = recurrence
                if recurrence.missed < SETTLED:
                    if self._accumulates(len(recurrence.stretches)):
                        return self._first_image()  # so do longer recurrences, of which less is known
                    decays = not self.period and decaying(
                        self.system, self.stretches, len(recurrence.stretches), arrival.scale
                    )
                    if self._again(recurrence) and not decays:
                        self._refuse_chatter(recurrence)
                        return self._shortest(recurrence, shorter)
                shorter.append(recurrence)
                if self.until is None and self.best is not None and not self.best.image:
                    return self.best
        return self._first_image()

    def _again(self, recurrence: HybridRecurrence) -> bool:
        """Whether the recurrence before came back as well: irregular motions come near by chance."""
        now, back = len(self.stretches), len(recurrence.stretches)
        times = self.settled.setdefault((back, recurrence.image), set())
        times.add(now)
        return self.until is None or now - back in times

    def _refuse_chatter(self, recurrence: HybridRecurrence) -> None:
        """A recurrence may pass through transitions that accumulate, where rounding ends them.

        Raises
        ------
        StartError
            If one in it follows itself ever sooner, down to rounding.
        """
        whole = sum(stretch.duration for stretch in recurrence.stretches)
        for three in zip(
            recurrence.stretches, recurrence.stretches[1:], recurrence.stretches[2:], strict=False
        ):
            first, second, third = (stretch.duration for stretch in three)
            same = len({stretch.leg.name for stretch in three}) == 1
            if same and first > second > third and third < ROUNDING * whole:
                lasts, ends = (self.system.lasting(time) for time in (third, three[-1].start))
                raise StartError(
                    f"Transition '{three[0].leg.name}' accumulates: it follows itself ever sooner, "
                    f"{lasts} later at t = {ends}, and only rounding ends that.",
                    "The plugin must declare a mode for what comes after.",
                )

    def _better(self, missed: float) -> bool:
        """Whether a recurrence is nearly one, and the best so far."""
        return missed < (NEARLY if self.best is None else AS_GOOD * self.best.missed)

    def _first_image(self) -> HybridRecurrence | None:
        """Where the first return is wanted, one up to an image, after a whole one was looked at too."""
        if self.until is not None or self.best is None:
            return None
        self.patience = self.patience or len(self.stretches) + len(self.best.stretches)
        return self.best if len(self.stretches) >= self.patience else None

    @cached_property
    def images(self) -> tuple[str, ...]:
        """Up to what a motion may return: nothing, or a mirror that is its own inverse."""
        mirrors = [s for s in self.system.symmetries if s.role == "spatial"]
        p, x = ParameterValues(**self.parameters), np.zeros(len(self.system.states))
        return ("", *(s.name for s in mirrors if order_of(s, x, p) == 2))

    def _arrival(self, arc: MotionSegment, image: str) -> _Arrival:
        """The event that ends an arc, or its image."""
        assert arc.after is not None
        event, after = str(arc.transition), arc.after
        mode, scale = self.system.transition(event, arc.mode).target, self.weights(after)
        if image:
            symmetry = self.system.symmetry(image)
            mode, event = symmetry.modes.get(mode, mode), symmetry.events.get(event, event)
            after = imaged(symmetry, after, ParameterValues(**self.parameters))
        return _Arrival(float(arc.times[-1]), mode, event, after, scale, image)

    def _misses(self, arrival: _Arrival) -> np.ndarray:
        """By what each of the last stretches misses to begin where an event leads, the last one first.

        Infinite where it began with another event.
        """
        count = len(self.stretches)
        recent = self.stretches[: -LOOK_BACK - 1 : -1]
        alike = np.array(
            [
                first.leg.mode == arrival.mode and self._led_in(count - back) in (None, arrival.event)
                for back, first in enumerate(recent, 1)
            ]
        )
        apart = arrival.after - np.array([first.state for first in recent])
        apart = apart - whole_turns(apart, self.turns)
        if self.neutral:
            for k in np.flatnonzero(alike):
                along = neutrals.directions(self.system, self.neutral, recent[k].state, self.parameters)
                apart[k] = neutrals.across(apart[k], along, arrival.scale)
        missed = np.linalg.norm(apart / arrival.scale, axis=1)
        lasted = arrival.time - np.array([first.start for first in recent])
        if self.period:
            periods = lasted / self.period * (2 if arrival.image else 1)  # of half a cycle: half periods
            missed = np.maximum(missed, np.abs(periods - np.round(periods)) / 0.05)
            alike &= np.round(periods) > 0
        return np.where(alike & (lasted >= self.least), missed, np.inf)

    def _recurrence(
        self, arrival: _Arrival, stretches: Sequence[Span], missed: float
    ) -> HybridRecurrence | None:
        """The recurrence over some stretches that end where they began, or at the image of that."""
        lasted = arrival.time - stretches[0].start
        if arrival.image and not self._carries(arrival.image, stretches, lasted, arrival.scale):
            return None
        return HybridRecurrence(
            tuple(stretches), arrival.scale, missed, arrival.after, arrival.image, self.origin
        )

    def _carries(self, image: str, stretches: Sequence[Span], lasted: float, scale: np.ndarray) -> bool:
        """Whether the machine is its own image after half a cycle: there the forcing is at another phase."""
        values = [self.parameters] if self.elsewhere is None else [self.parameters, self.elsewhere]
        periods = 0.5 * round(2.0 * lasted / self.period) if self.period else 0.0
        return carries(self.system, values, self.system.symmetry(image), stretches, periods, scale)

    @cached_property
    def neutral(self) -> list[Neutral]:
        """Directions along which a motion may return elsewhere: those that the first stretch keeps."""
        if not self.system.neutral:
            return []
        machine, first = hybrid_machine(self.system, self.parameters), self.stretches[0]
        given = first.leg.mode, first.start, first.state, self.weights(first.state)
        return [neutral for neutral in self.system.neutral if families.commutes(machine, neutral, *given)]

    def _accumulates(self, back: int) -> bool:
        """Whether recurrences last ever shorter, down to nothing: they return to a point, not to an orbit.

        What the durations tend to follows from three of them, whose differences are a geometric series. Later
        the differences are nothing but rounding.
        """
        recent = self.stretches[-3 * back :]
        lasting = [stretch.duration for stretch in recent[len(recent) % back :]]
        lengths = [sum(lasting[k : k + back]) for k in range(0, len(lasting), back)]
        changes = np.diff(lengths)
        if len(lengths) < 3:
            return bool(np.any(changes < -ALIKE * lengths[-1]))
        before, last = changes
        if before < last < 0.0 and lengths[2] - last**2 / (last - before) < SHRINKS * lengths[2]:
            self.shrinking = max(self.shrinking, lengths[2])
            return True
        return lengths[2] < 0.5 * self.shrinking

    def _shortest(self, recurrence: HybridRecurrence, shorter: list[HybridRecurrence]) -> HybridRecurrence:
        """The shortest recurrence that a longer one repeats: what alternates looks settled later."""
        for part in shorter:
            whole = part.itinerary.unfolded(self.system)
            times, rest = divmod(len(recurrence.itinerary), len(whole))
            # The part is the end of the recurrence; where it is half of a whole, the other half came first.
            whole = whole.rotated(self.system, len(part.itinerary) % len(whole))
            alike = not rest and not recurrence.image and recurrence.itinerary == whole.repeated(times)
            if alike and part.missed < ROUND * max(recurrence.missed, 0.1 * SETTLED):
                return part
        return recurrence

    def _led_in(self, k: int) -> str | None:
        """The transition that leads into stretch k; None where it is not known."""
        return self.stretches[k - 1].leg.name if k > 0 else None

    def _strobed(self, arc: MotionSegment) -> HybridRecurrence | None:
        """An orbit without events: of a forced system, the motion is the same again after some periods."""
        if not (self.period and self.looking):
            return None
        scale = self.weights(arc.states[-1])
        return strobes(self.system, self.parameters, arc, self.period, scale, self.until is None)
