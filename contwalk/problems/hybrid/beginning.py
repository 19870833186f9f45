"""From a state to an orbit: simulate, read the word off the motion, and cut it into legs.

A motion has returned when an event finds it where an earlier one of the same kind did. The word is what
happened in between; nobody has to type it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contwalk.errors import NotFinite, StartError, called
from contwalk.flow.hybrid import Arc, HybridMachine, applied, arcs, hybrid_machine
from contwalk.problems.hybrid import families
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.mirrors import Span, carries
from contwalk.problems.hybrid.resting import check_moves
from contwalk.problems.hybrid.word import Leg, Word
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.recurrence import recurrent
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

TOLERANCE = 1e-9
# What a return misses by, in units of the variation: of a motion that has settled; at all.
SETTLED, NEARLY = 1e-5, 0.2
# A part of a lap that misses by less than so many times as much is the lap.
ROUND = 100.0
# Laps that each last so much less than the one before accumulate.
SHRINKS = 0.95
ROUNDING = 1e-9
# Events that are looked back; events and steps that are simulated at most.
LOOK_BACK, MOST_EVENTS, MOST_STEPS = 64, 1000, 500_000
# Periods of the forcing without an event before an orbit without events is looked for.
QUIET = 4
# How long to simulate at once, in units of what the fastest state needs to change by its own size; steps
# without an event after which there will be none, for a start that is said to be on an orbit and otherwise.
STRETCH, FIRST_PATIENCE, PATIENCE = 300.0, 2_000, 20_000
LEAST = 1e-3
# A return that is as good as this times the best one so far is as good.
AS_GOOD = 0.5

Path = tuple[Mapping[str, float], Mapping[str, float]]


@dataclass(frozen=True, eq=False)
class Lap:
    """A motion that (nearly) comes back, or comes to the image of where it was.

    `magnitudes` are the largest of each state; `returned` is the state after the last event and
    the image, `origin` the one that the motion began with.
    """

    stretches: tuple[Span, ...]
    magnitudes: np.ndarray
    missed: float
    returned: np.ndarray
    image: str = ""
    origin: np.ndarray | None = None

    @property
    def word(self) -> Word:
        """The word that was read off."""
        return Word(tuple(stretch.leg for stretch in self.stretches), self.image)


def lap_from(
    system: System,
    parameters: Mapping[str, float],
    state: np.ndarray,
    mode: str | None = None,
    at: str | None = None,
    until: float | str | None = "settled",
    time: float = 0.0,
    after: str | None = None,
    least: float = 0.0,
) -> Lap:
    """One lap of the orbit that a motion leads to.

    Parameters
    ----------
    mode : str, optional
        In which the motion begins, the first one by default.
    at : str, optional
        The state is the one right before this transition.
    after : str, optional
        The state is the one right after this transition.
    least : float
        Seconds that a lap lasts at least.
    until : float, "settled" or None
        Seconds to simulate before looking for a return; `settled` waits until returns agree closely; None
        takes the first that comes near: the state is on an orbit, perhaps an unstable one.

    Raises
    ------
    NotFinite, StartError
        If the motion ends, comes to rest, accumulates events, or does not come back.
    """
    machine = hybrid_machine(system, parameters)
    mode = mode or system.modes[0].name
    x = np.array(state, dtype=float)
    if at is not None:
        happening = machine.transition(at, None if len(system.sources(at)) == 1 else mode)
        x, mode, after = applied(machine, happening, time, x), happening.target, at
    search = _Search(system, parameters, None if until == 0 else until, least)
    if after is not None:
        search.first = False  # the first arc is a whole leg
    search.origin = x
    for arc in _motion(machine, time, x, mode, after, search):
        lap = search.add(arc)
        if lap is not None:
            return lap
    return search.given_up()


def _motion(
    machine: HybridMachine, t: float, x: np.ndarray, mode: str, last: str | None, search: _Search
) -> Iterator[Arc]:
    """Arcs of the motion, in stretches short enough to notice that nothing happens.

    A stretch ends between events: right after one, a new start would not know what of a guard is rounding.
    """
    quiet = 0
    while True:
        weights = search.weights(x)
        length = search.stretch(machine, t, x, mode, weights)
        for arc in arcs(machine, t, x, mode, t + length, TOLERANCE, weights, just_after=last):
            yield arc
            search.check_moves(machine, arc)
            if arc.status != "ok" or search.exhausted:
                return
            t = float(arc.times[-1])
            if arc.transition is None:
                quiet += len(arc.times)
                x, last = arc.states[-1], None
            else:
                assert arc.after is not None
                quiet, x, last = 0, arc.after, arc.transition
                mode = machine.transition(arc.transition, arc.mode).target
        if not search.waits(quiet):
            return


class _Search:
    """Looks for a return while a motion is simulated."""

    def __init__(
        self, system: System, parameters: Mapping[str, float], until: float | str | None, least: float = 0.0
    ) -> None:
        self.system, self.parameters, self.until, self.least = system, dict(parameters), until, least
        self.period = 0.0
        if system.period is not None:
            self.period = float(called("period", system.period, ParameterValues(**parameters)))
            if not (np.isfinite(self.period) and self.period > 0.0):
                raise StartError(
                    f"The period of '{system.name}' is {system.lasting(self.period)} there.",
                    "It must be positive.",
                )
        self.turns = np.array([s.period or 0.0 for s in system.states])
        self.stretches: list[Span] = []
        self.low = np.full(len(system.states), np.inf)
        self.high = -self.low
        self.best: Lap | None = None
        self.patience = 0  # events until the best lap is taken, if it is one up to an image
        self.begun: tuple[float, np.ndarray] | None = (
            None  # time and state at the start of a leg that goes on
        )
        self.steps = 0
        self.first = True
        self.origin: np.ndarray | None = None
        self.ended: Arc | None = None
        self.last_state: tuple[float, np.ndarray, str] | None = None

    def weights(self, x: np.ndarray) -> np.ndarray:
        """Typical magnitudes as far as they are known."""
        seen = np.where(np.isfinite(self.low), 0.5 * (self.high - self.low), 0.0)
        reached = np.where(np.isfinite(self.low), np.maximum(np.abs(self.low), np.abs(self.high)), 0.0)
        known = np.maximum(seen, LEAST * np.maximum(np.abs(x), reached))
        largest = float(known.max())
        # What is zero, or nothing against the others, will be more than that.
        return np.where(known > ROUNDING * largest, known, LEAST * largest if largest > 0.0 else 1.0)

    def stretch(
        self, machine: HybridMachine, t: float, x: np.ndarray, mode: str, weights: np.ndarray
    ) -> float:
        """How long to simulate before it is noticed that nothing happens."""
        if self.period:
            return QUIET * self.period
        flow = machine.mode(mode)
        rates = np.abs(flow.field(t, x[flow.states], flow.c)) / weights[flow.states]
        fastest = float(np.max(rates, initial=0.0))
        return STRETCH / fastest if fastest > 0.0 else STRETCH

    def check_moves(self, machine: HybridMachine, arc: Arc) -> None:
        """Raise where the motion of an autonomous system has come to rest without an event."""
        if not self.period and arc.transition is None and arc.status in ("ok", "too_many_steps"):
            reached = np.maximum(np.abs(self.low), np.abs(self.high))
            check_moves(self.system, machine.mode(arc.mode), arc, reached)

    def waits(self, steps: int) -> bool:
        """Whether to go on although nothing has happened for so many steps."""
        return steps < (PATIENCE if self.until is not None or self.first else FIRST_PATIENCE)

    @property
    def exhausted(self) -> bool:
        """Whether so many events, or steps, have passed that there will be no return."""
        return len(self.stretches) > MOST_EVENTS or self.steps > MOST_STEPS

    def add(self, arc: Arc) -> Lap | None:
        """Take an arc in; the lap that it closes, if it does."""
        self.steps += len(arc.times)
        self.low = np.minimum(self.low, arc.states.min(axis=0))
        self.high = np.maximum(self.high, arc.states.max(axis=0))
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
            leg = Leg(arc.mode, transition, not arc.rising)
            start, x = self.begun or (float(arc.times[0]), arc.states[0])
            lasting = float(arc.times[-1]) - start
            self.stretches.append(Span(leg, start, x, lasting, arc.states[-1]))
        self.first, self.begun = False, None
        # Laps end with hard transitions, where there are any.
        hard = any(s.leg.transition is not None and s.leg.transition.role == "hard" for s in self.stretches)
        return self._closed(arc) if self.stretches and not (transition.role == "soft" and hard) else None

    def _closed(self, arc: Arc) -> Lap | None:
        """The shortest lap that ends with this arc's event."""
        if isinstance(self.until, int | float) and float(arc.times[-1]) < float(self.until):
            return None
        shorter: list[Lap] = []
        for back in range(1, min(LOOK_BACK, len(self.stretches)) + 1):
            for image in self.images:
                lap = self._returned(arc, back, image)
                if lap is None:
                    continue
                if lap.missed < SETTLED and not self._accumulates(back):
                    return self._shortest(lap, shorter)
                shorter.append(lap)
                if lap.missed < NEARLY and (self.best is None or lap.missed < AS_GOOD * self.best.missed):
                    self.best = lap
                if self.until is None and self.best is not None and not self.best.image:
                    return self.best
        return self._first_image()

    def _first_image(self) -> Lap | None:
        """Where the first return is wanted, one up to an image, after a whole lap was looked at too."""
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

    def _returned(self, arc: Arc, back: int, image: str) -> Lap | None:
        """The lap over the last stretches, if the same event happened before them, or its image."""
        assert arc.after is not None
        count = len(self.stretches)
        first, scale = self.stretches[count - back], self.weights(arc.after)
        mode, event, after = (
            self.system.transition(str(arc.transition), arc.mode).target,
            arc.transition,
            arc.after,
        )
        if image:
            symmetry = self.system.symmetry(image)
            mode, event = symmetry.modes.get(mode, mode), symmetry.events.get(str(event), event)
            after = imaged(symmetry, after, ParameterValues(**self.parameters))
        if first.leg.mode != mode or self._led_in(count - back) not in (None, event):
            return None
        if float(arc.times[-1]) - first.start < self.least:
            return None
        apart = after - first.state
        turned = self.turns > 0.0
        apart[turned] -= np.round(apart[turned] / self.turns[turned]) * self.turns[turned]
        along = families.directions(self.system, self.neutral, first.state, self.parameters)
        missed = float(np.linalg.norm(families.across(apart, along, scale) / scale))
        lasted = float(arc.times[-1]) - first.start
        if self.period:
            laps = lasted / self.period * (2 if image else 1)  # of half a cycle: half periods
            missed = max(missed, abs(laps - round(laps)) / 0.05) if round(laps) > 0 else np.inf
        stretches = tuple(self.stretches[count - back :])
        if image and missed < NEARLY and not self._carries(image, stretches, lasted, scale):
            return None
        return Lap(stretches, scale, missed, after, image, self.origin)

    def _carries(self, image: str, stretches: Sequence[Span], lasted: float, scale: np.ndarray) -> bool:
        """Whether the machine is its own image after half a cycle: there the forcing is at another phase."""
        machine, later = hybrid_machine(self.system, self.parameters), 0.0
        if self.period:
            later = 0.5 * self.period * round(2.0 * lasted / self.period)
        return carries(machine, self.system.symmetry(image), stretches, later, scale)

    @cached_property
    def neutral(self) -> list[Neutral]:
        """Directions along which a motion may return elsewhere: those that the first stretch keeps."""
        if not self.system.neutral:
            return []
        machine, first = hybrid_machine(self.system, self.parameters), self.stretches[0]
        given = first.leg.mode, first.start, first.state, self.weights(first.state)
        return [neutral for neutral in self.system.neutral if families.commutes(machine, neutral, *given)]

    def _accumulates(self, back: int) -> bool:
        """Whether the last events came in ever shorter time: they return to a point, not to an orbit."""
        durations = [stretch.duration for stretch in self.stretches[-3 * back :]]
        if len(durations) < 3 * back:
            return False
        first, second, third = (sum(durations[k * back : (k + 1) * back]) for k in range(3))
        return third < SHRINKS * second and second < SHRINKS * first

    def _shortest(self, lap: Lap, shorter: list[Lap]) -> Lap:
        """The shortest lap that a longer one repeats: one that alternates looks settled there later."""
        for part in shorter:
            whole = part.word.unfolded(self.system)
            times, rest = divmod(len(lap.word), len(whole))
            # The part is the end of the lap; where it is half of a whole, the other half came before it.
            whole = whole.rotated(self.system, len(part.word) % len(whole))
            alike = not rest and not lap.image and lap.word == whole.repeated(times)
            if alike and part.missed < ROUND * max(lap.missed, 0.1 * SETTLED):
                return part
        return lap

    def _led_in(self, k: int) -> str | None:
        """The transition that leads into stretch k; None where it is not known."""
        return self.stretches[k - 1].leg.name if k > 0 else None

    def _strobed(self, arc: Arc) -> Lap | None:
        """An orbit without events: of a forced system, the motion is the same again after some periods."""
        if not self.period:
            return None
        if isinstance(self.until, int | float) and float(arc.times[-1]) < float(self.until):
            return None
        from contwalk.problems.hybrid.quiet import strobes

        scale = self.weights(arc.states[-1])
        return strobes(self.system, self.parameters, arc, self.period, scale, self.until is None)

    def given_up(self) -> Lap:
        """The best return, where the motion ended or went on without an exact one.

        Raises
        ------
        NotFinite, StartError
        """
        if self.best is not None and self.ended is not None:
            return self.best
        where = "" if self.last_state is None else f" at t = {self.system.lasting(self.last_state[0])}"
        if self.ended is not None:
            error = NotFinite if self.ended.status == "not_finite" else StartError
            raise error(
                f"The simulation ends{where}: {self.ended.reason or self.ended.status}",
                "Start elsewhere, or mend the plugin.",
            )
        if not self.period and self.last_state is not None and not self.stretches:
            return self._smooth()
        remedy = "Simulate for longer with until: SECONDS, or start from another state."
        if self.until is not None:  # else it is the first near return that was looked for
            remedy += " Where it is near an orbit that may be unstable, until: 0 takes its first near return."
        raise StartError(
            f"The simulation did not come back to where it was{where}: it has not settled, settles on a "
            "motion that is not periodic, or meets no more events.",
            remedy,
        )

    def _smooth(self) -> Lap:
        """An orbit of an autonomous system that meets no event."""
        assert self.last_state is not None
        _, x, mode = self.last_state
        if mode != self.system.modes[0].name:
            raise StartError(
                f"The simulation stays in mode '{mode}' without an event.", "Start from another state."
            )
        found = recurrent(self.system, self.parameters, x)
        stretch = Span(Leg(mode), 0.0, found.state, found.period, found.state)
        return Lap((stretch,), found.variation, 0.0, found.state)


def orbit_of(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    lap: Lap,
    path: Path | None = None,
    at: float | None = None,
    discretization: Discretization | None = None,
) -> tuple[HybridOrbit, np.ndarray]:
    """The problem of a lap's word, discretised for it, and the lap as its unknowns."""
    values = at_start(parameters, path, at)
    pins = _neutral(system, values, free, lap, path) if system.neutral else []
    lap = _placed(system, pins, lap, values)
    problem = HybridOrbit(
        system, lap.word, parameters, free, path, pins, lap.stretches[0].state, discretization=discretization
    )
    value = parameters[free] if at is None else at
    layout = problem.layout
    lasting = np.array([stretch.duration for stretch in lap.stretches])
    drifts, states = _drifting(problem, lap, values)
    z = problem.assembled(states, lasting, drifts, value)
    if layout.start is not None and system.period is not None:
        period = float(called("period", system.period, ParameterValues(**problem.values_of(z))))
        whole = problem.rounds * float(lasting.sum())
        problem = problem.of_word(lap.word, max(round(whole / period), 1))
        z[layout.start] = lap.stretches[0].start % period if problem.word.eventful else 0.0
    problem = problem.turning(_turns(system, lap))
    return problem.adapted_to(z, problem.weighted(lap.magnitudes)), z


def _neutral(
    system: System, values: dict[str, float], free: str, lap: Lap, path: Path | None
) -> list[Neutral]:
    """The directions that are neutral along a lap, and so along its branch.

    Raises
    ------
    StartError
        If one is neutral where the branch begins, and not beside it.
    """
    pins = families.active(hybrid_machine(system, values), lap)
    others = [dict(end) for end in path] if path else [{**values, free: _beside(values[free])}]
    for other in others:
        kept = families.active(hybrid_machine(system, other), lap)
        lost = [pin.name for pin in pins if pin not in kept]
        if lost:
            raise StartError(
                f"The direction '{lost[0]}' is neutral where the branch begins, and not along '{free}': "
                "orbits are not isolated there.",
                "Begin elsewhere, such as at the other end of the path.",
            )
    return pins


def _beside(value: float) -> float:
    """A value of a parameter near another one, at which what holds for that one only does not."""
    return 1.01 * value if value else 0.01


def at_start(parameters: Mapping[str, float], path: Path | None, at: float | None) -> dict[str, float]:
    """All parameters where the branch begins; `at` is a place on the path."""
    if path is None:
        return dict(parameters)
    begin, end = path
    return {name: begin[name] + float(at or 0.0) * (end[name] - begin[name]) for name in begin}


def _placed(system: System, pins: Sequence[Neutral], lap: Lap, parameters: dict[str, float]) -> Lap:
    """The lap moved along pinned directions to where the motion began: translations only."""
    if lap.origin is None or not pins:
        return lap
    first = lap.stretches[0].state
    along = families.directions(system, pins, first, parameters)
    if not np.array_equal(along, families.directions(system, pins, lap.origin, parameters)):
        return lap
    held = [system.state_names.index(pin.pin) for pin in pins if pin.pin is not None and pin.value is None]
    if len(held) < len(pins):
        return lap
    try:
        shift = along @ np.linalg.solve(along[held], (lap.origin - first)[held])
    except np.linalg.LinAlgError:
        return lap
    moved = tuple(
        replace(stretch, state=stretch.state + shift, end=stretch.end + shift) for stretch in lap.stretches
    )
    return replace(lap, stretches=moved, returned=lap.returned + shift)


def _drifting(
    problem: HybridOrbit, lap: Lap, parameters: dict[str, float]
) -> tuple[np.ndarray, list[np.ndarray]]:
    """The drifts with which a lap closes, and its legs' first states as one sees them who drifts along."""
    first, states = lap.stretches[0], [stretch.state for stretch in lap.stretches]
    if not problem.pins:
        return np.zeros(0), states
    along = families.directions(problem.system, problem.pins, first.state, parameters)
    apart, scale = lap.returned - first.state, lap.magnitudes
    shares, *_ = np.linalg.lstsq(along / scale[:, None], apart / scale, rcond=None)
    drifts = -shares / sum(stretch.duration for stretch in lap.stretches)
    moved = []
    for stretch in lap.stretches:
        own = families.directions(problem.system, problem.pins, stretch.state, parameters)
        moved.append(stretch.state + (stretch.start - first.start) * own @ drifts)
    return drifts, moved


def _turns(system: System, lap: Lap) -> np.ndarray:
    """What angles grow by in a closure, in whole periods."""
    own = np.array([s.period or 0.0 for s in system.states])
    apart = lap.returned - lap.stretches[0].state
    return np.round(np.divide(apart, own, out=np.zeros_like(apart), where=own > 0.0)) * own
