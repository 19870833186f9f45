"""Values of what must stay positive on an orbit, and instants at which guards are least."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.memory import computed_once, memory_of, remembered
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.limits import transition_of
from contwalk.problems.hybrid.margins import Guarded, Limit, Margins
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.orbit.piece import Piece
from contwalk.system import Transition

# Parts of a guard's largest value: zero to rounding; below zero beyond doubt.
ZERO, BELOW = 1e-9, 1e-7
# A little time, and none, in parts of the closure's.
LITTLE, NO_TIME = 1e-3, 1e-12
# A rate below this part of the guard's largest one is zero but for what the instants of events are known to.
NO_RATE = 1e-7


@dataclass(eq=False)
class _Watch:
    """A guard on a leg of a solution, with the sign with which it is positive."""

    view: GuardedView
    guard: Guarded
    sign: float
    total: float  # duration of the closure

    def __post_init__(self) -> None:
        first, second, last_but_one, last = self.view.ends[self.guard.place]
        self.first, self.last = self.sign * first[0], self.sign * last[0]
        self.first_rate, self.second_rate = self.sign * first[1], self.sign * second[1]
        self.rate_before_last, self.last_rate = self.sign * last_but_one[1], self.sign * last[1]

    @computed_once
    def sampled(self) -> tuple[np.ndarray, np.ndarray]:
        """Instants 0..1, and values there."""
        times, values, _ = self.view.guard(self.guard.transition)
        return times, self.sign * values

    @computed_once
    def scale(self) -> float:
        """Largest value; on a leg that lasts nearly no time, what it changes by in a little more."""
        return max(_largest(*self._sizes, self.view.duration, self.total), 1e-300)

    @computed_once
    def _sizes(self) -> tuple[float, float]:
        return self.view.sizes[self.guard.place]

    @computed_once
    def behind(self) -> int:
        """After so many samples a guard of time alone whose event has led here is before its zero again.

        Until then it goes on past zero: nothing happens there.
        """
        begins = abs(self.first) <= BELOW * self.scale and self.first_rate < 0.0
        if not (self.guard.clock and begins):
            return 0
        back = np.flatnonzero(self.sampled[1] > ZERO * self.scale)
        return int(back[0]) if len(back) else self.samples

    @computed_once
    def fastest(self) -> float:
        """Largest modulus of its rate."""
        return self._sizes[1]

    @computed_once
    def dips(self) -> list[tuple[int, float, float]]:
        """Where it is least: after which sample, at which instant, and its value there.

        A field may switch just where a guard turns: a damper that acts upwards only does where what it damps
        is lowest. The guard's rate there is zero but for rounding, whose sign decides nothing: the leg that
        ends there has the turn. So has an orbit without events that begins where a guard turns. At a hard
        transition there is no turn, and the guard's value there is a limit of its own.
        """
        dips = [dip for dip in self.turns(-1.0) if dip[0] >= self.behind]
        last, still, guard = self.samples - 2, NO_RATE * self.fastest, self.guard
        if abs(self.first_rate) <= still and not guard.own:
            dips = [dip for dip in dips if dip[0] > 0]
            if guard.opens and not guard.known and self.second_rate > 0.0:
                dips.append((0, 0.0, self.first))
        if abs(self.last_rate) <= still and not guard.own:
            dips = [dip for dip in dips if dip[0] < last]
            if guard.closes and self.rate_before_last < 0.0:
                dips.append((last, 1.0, self.last))
        return dips

    def turns(self, way: float) -> list[tuple[int, float, float]]:
        """As `dips`, where it turns that goes down (-1) or up (1) before."""
        found = self.view.turning[self.guard.place]
        way *= self.sign
        return [(k, time, self.sign * value) for k, time, value, rate in found if rate * way > 0.0]

    @property
    def samples(self) -> int:
        """How many instants it is looked at."""
        return self.view.samples(self.guard.place)

    def before(self, k: int, time: float) -> tuple[float, float]:
        """How high it was before it came down to a turn after sample k, or to its end, and at which instant.

        One that has just been zero has left it upwards: that is above, however little. One that has just been
        passed downwards has not been above since.
        """
        left = abs(self.first) < ZERO * self.scale
        if left and not (self.guard.passed and self.first_rate < 0.0):
            return np.inf, 0.0
        tops = [(at, value) for j, at, value in self.turns(1.0) if (j, at) < (k, time)]
        if tops:
            return tops[-1][1], tops[-1][0]
        # What goes on from the leg before, or from the end of an orbit without events, has come down there.
        return np.inf if self.guard.opens and self.guard.known else self.first, 0.0


def margins(problem: LimitedOrbit, z: np.ndarray) -> Margins:
    """Values of all limits at a solution. z has the shape (N + 1,)."""
    views = problem.view(z)
    rows: list[tuple[float, float, float]] = []
    known: dict[tuple[int, str], _Watch] = {}
    total = problem.mesh.total
    for limit, guard in zip(problem.limits, guarded(problem), strict=True):
        i = limit.leg
        view = views[i]
        if limit.test == "duration":
            together = problem.itinerary.legs[i].together
            found = _kept(view.duration, total) if together else view.duration, total, 1.0
        elif limit.test == "condition":
            found = view.conditions[limit.name], 1.0, 1.0
        elif guard is None:
            found = _entered(problem, limit, view)
        else:
            watch = known.get((i, limit.name))
            if watch is None:
                watch = known[i, limit.name] = _Watch(view, guard, _sign_of(guard, view), total)
            if limit.test == "leaving":
                found = _leaving(watch)
            else:
                found = _of_watch(limit.test, watch, view.duration)
        rows.append(found)
    values, scales, places = np.array(rows).reshape(len(rows), 3).T
    return Margins(problem.limits, values, scales, places)


def _kept(duration: float, total: float) -> float:
    """What has to stay positive of the duration of a leg that lasts no time by a symmetry: nothing, as long
    as it does not.
    """
    return np.inf if abs(duration) <= BELOW * total else -abs(duration)


def _entered(problem: LimitedOrbit, limit: Limit, view: GuardedView) -> tuple[float, float, float]:
    """Value, scale and place of how a guard stands where a mode is entered that lasts no time.

    There is no largest value to compare it with: what typical changes of the states make of it is.
    """
    transition = transition_of(problem, limit)
    sign = 1.0 if transition.direction == "falling" else -1.0
    value, slopes = at_entry(view.piece, transition, view.x, view.scalars)
    n = len(view.x)
    scale = float(np.linalg.norm(slopes[:n] * problem.mesh.variation[list(view.piece.passage.states)]))
    if problem.forced:
        scale = float(np.hypot(scale, slopes[n + 1] * problem.mesh.total))
    past = -1.0 if limit.test == "past" else 1.0
    return past * sign * value, max(scale, 1e-300), 0.0


def at_entry(
    piece: Piece, transition: Transition, x: np.ndarray, scalars: np.ndarray
) -> tuple[float, np.ndarray]:
    """A guard at the start of a leg, and its derivatives by the state and the scalars.

    x has the shape (n_i,), scalars (k,), the derivatives (n_i + k,).
    """
    watched = piece.passage.watched(transition.name, transition.guard)
    own = np.eye(len(x), len(x) + len(scalars))
    values, derivative = watched.differentiated(0.0, x, own, piece.values(scalars))
    return float(values[0]), derivative[0]


def _leaving(watch: _Watch) -> tuple[float, float, float]:
    """Value, scale and place of how a guard goes on that its own event has left without rate."""
    fastest = max(watch.fastest, 1e-300)
    if abs(watch.first_rate) > ZERO * fastest or abs(watch.first) > ZERO * watch.scale:
        return np.inf, fastest, 0.0
    view, map_ = watch.view, watch.view.piece.passage.guard_derivative(watch.guard.transition, 2)
    c = map_.constants(view.piece.values(view.scalars))
    return watch.sign * float(map_(0.0, view.x, c)[0]), fastest, 0.0


def guarded(problem: LimitedOrbit) -> tuple[Guarded | None, ...]:
    """The guard that each of the limits of an itinerary's orbits is one of, if a sampled leg has it.

    It is the itinerary that tells, on whichever steps and at whichever values of the parameters.
    """
    known: dict[str, tuple[Guarded | None, ...]] = memory_of(problem.itinerary, "guards of its limits")
    return remembered(known, "", 1, lambda: _all_guarded(problem))


def _all_guarded(problem: LimitedOrbit) -> tuple[Guarded | None, ...]:
    known: dict[tuple[int, str], Guarded] = {}
    found: list[Guarded | None] = []
    for limit in problem.limits:
        key = limit.leg, limit.name
        if limit.test in ("duration", "condition") or problem.itinerary.legs[limit.leg].collapsed:
            found.append(None)
            continue
        if key not in known:
            known[key] = _guarded(problem, limit.leg, transition_of(problem, limit))
        found.append(known[key])
    return tuple(found)


def _guarded(problem: LimitedOrbit, i: int, transition: Transition) -> Guarded:
    """A guard on leg i."""
    system, itinerary, passage = problem.system, problem.itinerary, problem.passages[i]
    leg, before = itinerary.legs[i], itinerary.legs[i - 1]
    own, clock = transition == leg.transition, passage.of_time_alone(transition)
    opens = _goes_on(before.transition) and not (i == 0 and itinerary.image)
    return Guarded(
        transition,
        passage.leaving.index(transition),
        # A clock that counts both ways may have turned its sign after a period of the force.
        leg.falls if own and not clock else None,
        own,
        opens,
        _goes_on(leg.transition),
        opens and any(t.name == transition.name for t in system.leaving(before.mode)),
        clock,
        any(transition.name in system.passed(name, leg.mode) for name in itinerary.at_start(system, i)),
        transition.role == "hard" and not transition.at_entry and transition.direction != "both",
    )


def _goes_on(transition: Transition | None) -> bool:
    """Whether a guard goes on smoothly where a leg ends: with a soft transition, or where a period does."""
    return transition is None or transition.role == "soft"


def largest(values: np.ndarray, rates: np.ndarray, duration: float, total: float) -> float:
    """Largest modulus of a guard on a leg of at least a little time; rates are over the leg's own time.

    Both have the shape (k,).
    """
    return _largest(float(np.abs(values).max()), float(np.abs(rates).max()), duration, total)


def _largest(value: float, rate: float, duration: float, total: float) -> float:
    """As `largest`, of largest moduli."""
    little = LITTLE * total
    if not 0.0 < abs(duration) < little:
        return value
    return max(value, rate * little / abs(duration))


def _sign_of(guard: Guarded, view: GuardedView) -> float:
    """The sign with which a guard is positive on a leg before its event."""
    told = guard.falls is not None or guard.transition.direction != "both"
    values = np.zeros(0) if told else view.guard(guard.transition)[1]
    return _sign(guard.transition, guard.falls, values)


def _sign(transition: Transition, falls: bool | None, values: np.ndarray) -> float:
    """The sign with which a guard is positive before its event."""
    if transition.direction != "both":
        return 1.0 if transition.direction == "falling" else -1.0
    if falls is not None:
        return 1.0 if falls else -1.0
    return 1.0 if values[int(np.argmax(np.abs(values)))] >= 0.0 else -1.0


def _of_watch(test: str, watch: _Watch, duration: float) -> tuple[float, float, float]:
    """Value, scale and place of a limit that a guard has."""
    if test == "rate":
        whole = max(watch.fastest, 1e-300)
        if abs(duration) <= NO_TIME * watch.total:  # over no time a rate is rounding, and so is its sign
            return np.inf, whole, 1.0
        return -watch.last_rate / duration, whole / abs(duration), 1.0
    if test in ("start", "end"):
        return _at_an_end(test == "start", watch, duration)
    scale, guard, samples = watch.scale, watch.guard, watch.samples
    least, place = np.inf, np.nan
    for k, time, value in _fallen(watch) if guard.edges else watch.dips:
        first, last = k == 0, k == samples - 2
        if last and guard.own and abs(watch.last) < ZERO * scale:
            continue  # what turns just before its own event is told by the rate there
        if first and not guard.opens and abs(watch.first) < ZERO * scale and value > -BELOW * scale:
            continue  # it has just been zero, and leaves
        if value < least:
            least, place = value, time
    return least, scale, place


def _at_an_end(start: bool, watch: _Watch, duration: float) -> tuple[float, float, float]:
    """Value, scale and place of the limit that a guard has where a leg starts, or where it ends."""
    scale, place, value = watch.scale, 0.0 if start else 1.0, watch.first if start else watch.last
    # A guard that has just been zero, or that two events share, is no limit of its own there; on a leg
    # without length none can be told from that.
    if abs(duration) <= NO_TIME * watch.total or watch.behind > (0 if start else watch.samples - 1):
        return np.inf, scale, place
    found = np.inf
    if abs(value) > ZERO * scale:
        found = value if not watch.guard.edges else _at_start(watch) if start else _at_end(watch)
    return found, scale, place


def _fallen(watch: _Watch) -> list[tuple[int, float, float]]:
    """As the dips of a guard, each with the way down to it.

    It passes zero on this way where its top is above and its bottom is below: of both the one that is nearer
    to the other side is the margin. Where the top is the start, this has a limit of its own.
    """
    end = watch.samples - 2, 1.0, watch.last
    downs = watch.dips + ([end] if watch.last_rate < 0.0 else [])
    found = []
    for down in downs:
        top, at = watch.before(*down[:2])
        if down[2] >= -top:
            found += [down] if down is not end else []
        elif at > 0.0:
            found.append((int(np.searchsorted(watch.sampled[0], at)) - 1, at, -top))
    return found


def _at_start(watch: _Watch) -> float:
    """The margin of a guard where its mode is entered: it passes zero soon if it is above and comes down."""
    start = watch.first
    if watch.first_rate >= 0.0:
        return start if start > 0.0 else np.inf
    bottom = min([value for _, _, value in watch.dips[:1]] or [watch.last])
    return -start if start < 0.0 or bottom < -start else start


def _at_end(watch: _Watch) -> float:
    """The margin of a guard where its mode is left: it has passed zero if it was above and is below."""
    end = watch.last
    if watch.last_rate >= 0.0:
        return end if end > 0.0 else np.inf
    return end if end >= -watch.before(watch.samples, 1.0)[0] else np.inf
