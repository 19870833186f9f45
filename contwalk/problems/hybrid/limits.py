"""Limits: what must stay positive for an orbit to be one that the machine can move on.

| test | what it is | label where it passes zero |
|---|---|---|
| `dip` | least value of a guard inside a leg, at an instant where its rate is zero | GR |
| `rate` | rate at which the leg's own guard arrives | GR `terminal` |
| `duration` | duration of a leg | OC |
| `start`, `end` | a guard that is not the leg's own, at its ends | OC, of a watched one AZ |
| `condition` | a declared condition at an event | AZ |
| `past` | how far the guard of a leg that lasts no time is past zero | OC |

Of a soft transition there are none: the field switches continuously there.

A grazing is `terminal` where the guard is the one that ends the leg: the leg then ends earlier. All guards
have the sign with which they are positive on an admissible orbit. Every limit that passes zero is a special
point like any other: a solution of the orbit's equations together with one or two more, exact derivatives
included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError, UnsupportedOperation
from contwalk.flow.events.guard_derivatives import MOST_ORDER
from contwalk.memory import computed_once
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.margins import KINDS, Guarded, Limit, Margins
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.orbit import augmented
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.orbit.watching import Watched
from contwalk.problems.orbit.word import imaged_leg
from contwalk.problems.problem import Located, Sample
from contwalk.system import System, Transition

LABELS = tuple(KINDS)
AT_START = ("start", "leaving", "past")
# Margins larger than this are not those that a special point is a zero of.
HIDDEN = 1e-6
# Limits that do not show at a point are looked for so far beside it, in the metric, and are those nearer
# than this.
BESIDE, NEAR = 1e-4, 1e-2
# Parts of a guard's largest value: zero to rounding; below zero beyond doubt.
ZERO, BELOW = 1e-9, 1e-7
# A little time, and none, in parts of the closure's.
LITTLE, NO_TIME = 1e-3, 1e-12
# Of what typical changes of the states make of a guard: its rounding, a rate that is no more than that, and
# what one that turns within a little time changes by at most in the closure's.
ROUNDED, STILL, SLOWLY = 1e-13, 1e-8, 0.1
# A rate below this part of the guard's largest one is zero but for what the instants of events are known to.
NO_RATE = 1e-7
# An instant that lies beyond this part of a segment is looked at from its start.
AFTER = 0.1


def transition_of(problem: DiscretizedOrbit, limit: Limit) -> Transition:
    """The transition that a limit is about, out of its leg's mode."""
    return problem.system.transition(limit.name, problem.word.legs[limit.leg].mode)


def limits_of(problem: DiscretizedOrbit) -> tuple[Limit, ...]:
    """All limits of a word's orbits, in a fixed order."""
    system, word, found = problem.system, problem.word, []
    for i, leg in enumerate(word.legs):
        if leg.collapsed:
            assert leg.transition is not None
            found += _of_collapsed(system, leg.mode, leg.transition, i)
        else:
            found += limits_of_leg(system, leg.mode, leg.transition, word.leading_in(system, i), i)
    return tuple(found)


def _of_collapsed(system: System, mode: str, own: Transition, i: int) -> list[Limit]:
    """The limits of a collapsed leg: its own guard is past zero, and none that is declared before it is."""
    found = [Limit("OC", "crossing", own.name, i, "past")]
    for other in system.leaving(mode):
        if other == own:
            break
        if other.level:
            found.append(Limit("OC", "crossing", other.name, i, "start"))
    return found + _conditions(system, own, i)


def _conditions(system: System, own: Transition, i: int) -> list[Limit]:
    names = [condition.name for condition in system.conditions if condition.at == own.name]
    return [Limit("AZ", name, name, i, "condition", False) for name in names]


def limits_of_leg(system: System, mode: str, own: Transition | None, before: str, i: int) -> list[Limit]:
    """The limits of leg i, in a mode, ended by `own` or nothing, led into by the one named `before`."""
    found: list[Limit] = []
    for other in system.leaving(mode):
        if other.role == "soft":
            continue
        acts = other.role != "watched"
        found.append(Limit("GR", "terminal" if other == own else "interior", other.name, i, "dip", acts))
        if other != own and own is not None:
            label, kind = ("AZ", other.name) if other.role == "watched" else ("OC", "crossing")
            found.append(Limit(label, kind, other.name, i, "start", acts))
            found.append(Limit(label, kind, other.name, i, "end", acts))
        if other.role == "hard" and other.name == before:
            found.append(Limit("GR", "interior", other.name, i, "leaving"))
    if own is None:
        return found
    if own.role == "hard":
        found.append(Limit("GR", "terminal", own.name, i, "rate"))
        found.append(Limit("OC", "crossing", own.name, i, "duration"))
    return found + _conditions(system, own, i)


# -- values ------------------------------------------------------------------------------------------------


@dataclass(eq=False)
class _Watch:
    """A guard on a leg of a solution, with the sign with which it is positive."""

    view: LegView
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
        found = self.view.turning(self.guard.place)
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


def margins(problem: DiscretizedOrbit, z: np.ndarray) -> Margins:
    """Values of all limits at a solution."""
    views = problem.view(z)
    rows: list[tuple[float, float, float]] = []
    known: dict[tuple[int, str], _Watch] = {}
    total = problem.mesh.total
    for limit, guard in zip(problem.limits, problem.guarded, strict=True):
        i = limit.leg
        view = views[i]
        if limit.test == "duration":
            found = view.duration, total, 1.0
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


def _entered(problem: DiscretizedOrbit, limit: Limit, view: LegView) -> tuple[float, float, float]:
    """Value, scale and place of how a guard stands where a mode is entered that lasts no time.

    There is no largest value to compare it with: what typical changes of the states make of it is.
    """
    transition = transition_of(problem, limit)
    sign = 1.0 if transition.direction == "falling" else -1.0
    value, slopes = _at_entry(view.piece, transition, view.x, view.scalars)
    n = len(view.x)
    scale = float(np.linalg.norm(slopes[:n] * problem.mesh.variation[list(view.piece.passage.states)]))
    if problem.forced:
        scale = float(np.hypot(scale, slopes[n + 1] * problem.mesh.total))
    past = -1.0 if limit.test == "past" else 1.0
    return past * sign * value, max(scale, 1e-300), 0.0


def _at_entry(
    piece: Piece, transition: Transition, x: np.ndarray, scalars: np.ndarray
) -> tuple[float, np.ndarray]:
    """A guard at the start of a leg, and its derivatives by the state and the scalars."""
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


def guarded(problem: DiscretizedOrbit) -> tuple[Guarded | None, ...]:
    """The guard that each of the limits of a word's orbits is one of, if a sampled leg has it."""
    known: dict[tuple[int, str], Guarded] = {}
    found: list[Guarded | None] = []
    for limit in problem.limits:
        key = limit.leg, limit.name
        if limit.test in ("duration", "condition") or problem.word.legs[limit.leg].collapsed:
            found.append(None)
            continue
        if key not in known:
            known[key] = _guarded(problem, limit.leg, transition_of(problem, limit))
        found.append(known[key])
    return tuple(found)


def _guarded(problem: DiscretizedOrbit, i: int, transition: Transition) -> Guarded:
    """A guard on leg i."""
    system, word, passage = problem.system, problem.word, problem.passages[i]
    leg, before = word.legs[i], word.legs[i - 1]
    own, clock = transition == leg.transition, passage.of_time_alone(transition)
    opens = _goes_on(before.transition) and not (i == 0 and word.image)
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
        transition.name in system.passed(word.leading_in(system, i), leg.mode),
        transition.role == "hard" and not transition.at_entry and transition.direction != "both",
    )


def _goes_on(transition: Transition | None) -> bool:
    """Whether a guard goes on smoothly where a leg ends: with a soft transition, or where a period does."""
    return transition is None or transition.role == "soft"


def largest(values: np.ndarray, rates: np.ndarray, duration: float, total: float) -> float:
    """Largest modulus of a guard on a leg of at least a little time; rates are over the leg's own time."""
    return _largest(float(np.abs(values).max()), float(np.abs(rates).max()), duration, total)


def _largest(value: float, rate: float, duration: float, total: float) -> float:
    """As `largest`, of largest moduli."""
    little = LITTLE * total
    if not 0.0 < abs(duration) < little:
        return value
    return max(value, rate * little / abs(duration))


def _sign_of(guard: Guarded, view: LegView) -> float:
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
        per_second = duration if duration != 0.0 else 1.0
        return -watch.last_rate / per_second, whole / abs(per_second), 1.0
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


def guard_scales(problem: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """Largest value of each leg's own guard on it, shape (m,); 1 where there is none."""
    scales = np.ones(problem.layout.legs)
    for i, (leg, view) in enumerate(zip(problem.word.legs, problem.view(z), strict=True)):
        if leg.transition is None:
            continue
        if leg.collapsed:  # what is zero is its duration
            scales[i] = problem.mesh.total
            continue
        found = view.guard_values(leg.transition)
        largest = float(np.abs(found).max())
        scales[i] = largest if np.isfinite(largest) and largest > 0.0 else 1.0
    return scales


def nearest(problem: DiscretizedOrbit, point: SpecialPoint) -> int:
    """The limit that a special point is one of: the smallest margin under its label, and kind where
    it has one.

    `problem` has the point's steps.
    """
    z = np.array(point.unknowns)
    found = problem.margins(z)

    def fits(limit: Limit) -> bool:
        return limit.label == point.label and (limit.label == "OC" or limit.kind == point.kind)

    fitting = [k for k, limit in enumerate(found.limits) if fits(limit)]
    off = {k: abs(float(found.relative[k])) for k in fitting if np.isfinite(found.values[k])}
    best = min(off, key=lambda k: (off[k], found.limits[k].rank), default=None)
    if best is None or off[best] > HIDDEN:
        # A guard that is zero at a leg's start or end is left out of the margins just there.
        left_out = [k for k in fitting if k not in off and found.limits[k].test in ("start", "end")]
        shown = _beside(problem, z, np.array(point.tangent), left_out)
        best = min(shown, key=lambda k: (shown[k], found.limits[k].rank), default=best)
    if best is None:
        raise StartError(f"{point.label} at {dict(point.parameters)} is no limit of these orbits.", "")
    return best


def _beside(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, which: list[int]
) -> dict[int, float]:
    """How far from zero some limits are a little beside a point, on both sides; those that are nowhere near
    it are left out, and those that are zero there as well.
    """
    weights = filled_magnitudes(problem, z)
    off: dict[int, float] = {}
    step = BESIDE * tangent / float(np.linalg.norm(tangent / weights))
    for there in (z + step, z - step) if which else ():
        values = problem.margins(there)
        for k in which:
            share = abs(float(values.relative[k]))
            if np.isfinite(values.values[k]) and share < NEAR:
                off[k] = min(share, off.get(k, np.inf))
    return off


# -- locating ----------------------------------------------------------------------------------------------


def located(problem: DiscretizedOrbit, which: int, sample: Sample) -> Located | None:
    """The point near a sample at which limit number `which` passes zero."""
    limit = problem.limits[which]
    try:
        system = _system(problem, which, limit, sample)
        return None if system is None else augmented.solved(problem, system, sample)
    except (np.linalg.LinAlgError, UnsupportedOperation):
        return None


def _system(
    problem: DiscretizedOrbit, which: int, limit: Limit, sample: Sample
) -> augmented.Augmented | None:
    """The orbit's equations with those of the limit."""
    for leg in _doubtful(problem, limit):
        if _vanishes(problem, leg, sample):
            return _vanishing(problem, which, leg, sample)
    i, size = limit.leg, problem.size
    start, scale = sample.z, sample.weights
    share = 1.0
    if limit.test == "dip":
        share = float(problem.margins(sample.z).places[which])
        if not np.isfinite(share):
            return None
        duration = float(sample.z[problem.layout.durations][i])
        start, scale = np.append(start, share * duration), np.append(scale, abs(duration))

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[: size + 1]
        own = there.linearize(z)
        values, rows = _rows(there, limit, y, share)
        jacobian = np.zeros((size + len(values), len(y)))
        jacobian[:size, : size + 1] = own.jacobian
        jacobian[size:] = rows
        return np.concatenate([own.residual, values]), jacobian

    def vectors(there: Any, y: np.ndarray) -> dict:
        seconds = float(y[-1]) if limit.test == "dip" else float(y[there.layout.durations][i])
        return {"limit": which, "seconds": 0.0 if limit.test in AT_START else seconds}

    return augmented.Augmented(evaluate, start, scale, vectors)


def _doubtful(problem: DiscretizedOrbit, limit: Limit) -> tuple[int, ...]:
    """The legs that may have vanished where a limit is met: its own, or the one that its event leads to."""
    own = problem.word.legs[limit.leg].name == limit.name
    if limit.test == "rate" or (limit.test == "dip" and own):
        return limit.leg, (limit.leg + 1) % problem.layout.legs
    return (limit.leg,) if limit.test == "duration" else ()


def _vanishes(problem: DiscretizedOrbit, i: int, sample: Sample) -> bool:
    """Whether leg i, at whose start its own guard is zero, too, is nearly none.

    Then guard and rate at its end are zero wherever it lasts no time: its equation says nothing there.
    """
    transition, duration = problem.word.legs[i].transition, float(sample.z[problem.layout.durations][i])
    if transition is None or abs(duration) > LITTLE * problem.mesh.total or collapses(problem, i):
        return False
    view = problem.view(_solution(problem, sample))[i]  # of a guess no guard is zero
    _, values, rates = view.guard(transition)
    most = largest(values, rates, view.duration, problem.mesh.total)
    typical = _typical(problem, i, transition, sample)
    # One that passes zero with a rate is near it all along a short leg; rates are over the leg's own time.
    turns = abs(float(rates[0])) * problem.mesh.total <= SLOWLY * typical * abs(view.duration)
    return turns and abs(float(values[0])) <= max(BELOW * most, ROUNDED * typical)


def _solution(problem: DiscretizedOrbit, sample: Sample) -> np.ndarray:
    """The solution nearest to a sample, which may be a guess."""
    try:
        return newton_on(problem, sample.z, sample.weights)
    except StartError:
        return sample.z


def _typical(problem: DiscretizedOrbit, i: int, transition: Transition, sample: Sample) -> float:
    """What typical changes of the states make of a guard where leg i begins."""
    piece, (x, scalars) = problem.pieces[i], problem.layout.inputs(i, sample.z)
    own = problem.layout.inputs(i, sample.weights)[0]
    return float(np.abs(_at_entry(piece, transition, x, scalars)[1][: len(x)]) @ own)


def typical(view: LegView, transition: Transition, magnitudes: np.ndarray) -> float:
    """What changes of the states by their magnitudes make of a guard where a leg begins."""
    slopes = _at_entry(view.piece, transition, view.x, view.scalars)[1][: len(view.x)]
    return float(np.abs(slopes) @ magnitudes[list(view.piece.passage.states)])


def collapses(problem: DiscretizedOrbit, i: int) -> bool:
    """Whether leg i is passed in no time where it does not last: its guard acts at entry, and moves there.

    One that has led into the leg as well is zero there, whatever the orbit; and one that acts in the leg
    before, too, happens earlier than what ends that one.
    """
    leg, word, system = problem.word.legs[i], problem.word, problem.system
    own = leg.transition
    if own is None or not own.level:
        return False
    before = word.legs[i - 1]
    if i == 0 and word.image:
        before = imaged_leg(system, word.image, before)
    armed = any(t.guard is own.guard or t.name == own.name for t in system.leaving(before.mode))
    return not armed and leg.name not in system.left_at_zero(before.name, leg.mode)


def _vanishing(problem: DiscretizedOrbit, which: int, i: int, sample: Sample) -> augmented.Augmented:
    """The equations of an orbit whose leg i lasts no time, between zeros of a guard that turns there.

    Its duration is zero, and so is the first of the guard's derivatives along the motion at its start that is
    not zero however long the leg lasts: the rate, the second one of a guard that begins without rate, the
    third one of a contact that is left where its force is zero. Legs that vanish with it have no duration
    either: those of its image, where nobody has declared the symmetry. Of the orbit's own equations as many
    say nothing new there, mostly those of the guards at the ends of these legs: they are unfolded by unknowns
    that are zero.
    """
    size, gone = problem.size, [i, *_vanishing_with(problem, i, sample)]
    transition = problem.word.legs[i].transition
    assert transition is not None
    order = _first_derivative(problem, i, transition, sample)

    def conditions(there: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The orbit's equations with those of the legs that have gone."""
        own, lasting = there.linearize(z), np.array(gone) + there.layout.durations.start
        value, slopes = _starting(there, i, transition, z, order)
        rows = np.vstack([np.eye(size + 1)[lasting], there.layout.spread(i, slopes[None])])
        return np.concatenate([own.residual, z[lasting], [value]]), np.vstack([own.jacobian, rows])

    unfolding = _redundant(
        conditions(problem, sample.z)[1], problem.equation_scales, sample.weights, len(gone)
    )

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = conditions(there, y[: size + 1])
        columns = np.zeros((len(residual), len(gone)))
        columns[:size] = there.equation_scales[:, None] * unfolding
        return residual + columns @ y[size + 1 :], np.hstack([jacobian, columns])

    around = _around(problem, gone)

    def vectors(there: Any, y: np.ndarray) -> dict:
        seconds = float(y[there.layout.durations][there.limits[which].leg])
        return {"limit": which, "seconds": seconds, "vanishing": around}

    start, scale = (np.append(v, np.full(len(gone), w)) for v, w in ((sample.z, 0.0), (sample.weights, 1.0)))
    return augmented.Augmented(evaluate, start, scale, vectors)


def _around(problem: DiscretizedOrbit, gone: Sequence[int]) -> tuple[int, ...]:
    """The limits that pass zero where legs vanish: of the events at both ends of each, on it and beside it.

    Solutions beside that point are hardly known: of all equations only one tells whether the leg lasts.
    """
    legs, m = problem.word.legs, problem.layout.legs
    beside = {(i + k) % m: {legs[i].name, legs[(i - 1) % m].name} for i in gone for k in (-1, 0, 1)}
    return tuple(k for k, limit in enumerate(problem.limits) if limit.name in beside.get(limit.leg, ()))


def _redundant(jacobian: np.ndarray, rows: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """Combinations of an orbit's equations that say nothing new beside further ones, shape (N, count)."""
    scaled = jacobian * columns
    scaled[: len(rows)] /= rows[:, None]
    sizes = np.linalg.norm(scaled, axis=1)
    scaled /= np.where(sizes > 0.0, sizes, 1.0)[:, None]
    left = np.linalg.svd(scaled)[0][: len(rows), -count:]
    lengths = np.linalg.norm(left, axis=0)
    if not np.all(lengths > 0.0):
        raise np.linalg.LinAlgError("None of the orbit's equations says nothing new.")
    return left / lengths


def _vanishing_with(problem: DiscretizedOrbit, i: int, sample: Sample) -> list[int]:
    """The other legs that vanish, and last as long as leg i."""
    lasting = sample.z[problem.layout.durations]
    return [
        k
        for k in range(problem.layout.legs)
        if k != i
        and abs(lasting[k] - lasting[i]) < LITTLE * abs(lasting[i])
        and _vanishes(problem, k, sample)
    ]


def _first_derivative(problem: DiscretizedOrbit, i: int, transition: Transition, sample: Sample) -> int:
    """The order of the first derivative of a guard by time that is not zero where a short leg begins, however
    long it lasts: after a release from rest it is not the rate.

    A guard that is zero again after T has begun with the derivative -b T / (k + 1) of order k, b the next
    one.

    Raises
    ------
    UnsupportedOperation
        If derivatives become too large before one is not zero.
    LinAlgError
        If all of them are zero.
    """
    z = _solution(problem, sample)
    lasting, typical = abs(float(z[problem.layout.durations][i])), _typical(problem, i, transition, sample)
    value = float(_starting(problem, i, transition, z, 1)[0])
    for order in range(1, MOST_ORDER):
        following = float(_starting(problem, i, transition, z, order + 1)[0])
        rounding = STILL * typical / problem.mesh.total**order
        if abs(value) >= max(LITTLE * abs(following) * lasting, rounding):
            return order
        value = following
    raise np.linalg.LinAlgError(f"All derivatives of '{transition.name}' are zero where its segment begins.")


def _starting(
    problem: DiscretizedOrbit, i: int, transition: Transition, z: np.ndarray, order: int
) -> tuple[float, np.ndarray]:
    """A guard's derivative by time of an order where leg i begins, with derivatives by the leg's inputs."""
    piece, (x, scalars) = problem.pieces[i], problem.layout.inputs(i, z)
    n = len(x)
    # Over the leg's own time they would be zero with it.
    scalars = np.append(1.0, scalars[1:])
    map_ = piece.passage.guard_derivative(transition, order)
    values, derivative = map_.linearized(0.0, x, map_.constants(piece.values(scalars)))
    value, slopes = float(values[0]), derivative[0].copy()
    slopes[n] = 0.0
    return value, slopes


def _rows(
    problem: DiscretizedOrbit, limit: Limit, y: np.ndarray, share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Residuals of a limit's equations, and their derivatives by all unknowns."""
    i, size, layout = limit.leg, problem.size, problem.layout
    if limit.test == "duration":
        row = np.zeros((1, len(y)))
        row[0, layout.durations.start + i] = 1.0
        return y[layout.durations.start + i, None], row
    z, piece = y[: size + 1], problem.pieces[i]
    x, scalars = layout.inputs(i, z)
    if limit.test == "condition":
        map_ = piece.passage.condition(problem.named_conditions[limit.name])
        piece, x, scalars = _ending(problem, i, z)
        end, moved = piece.before_differentiated(PLAIN, x, scalars)
        values, derivative = piece.through_map(map_, end, moved, piece.values(scalars))
        return values, layout.along(layout.segments_of(i)[-1], derivative)
    transition = transition_of(problem, limit)
    if limit.test == "leaving":
        map_ = piece.passage.guard_derivative(transition, 2)
        c = map_.constants(piece.values(scalars))
        value, derivative = map_.linearized(0.0, x, c)
        return value, layout.spread(i, derivative)
    watched = piece.passage.watched(transition.name, transition.guard)
    if limit.test in ("start", "past"):
        there, slopes = _at_entry(piece, transition, x, scalars)
        return np.array([there]), layout.spread(i, slopes[None])
    if limit.test == "dip":
        return _touching(problem, i, y, share, watched)
    piece, x, scalars = _ending(problem, i, z)
    end, moved = piece.before_differentiated(PLAIN, x, scalars)
    values, derivative = watched.differentiated(1.0, end, moved, piece.values(scalars))
    k = 1 if limit.test == "rate" else 0
    return values[k : k + 1], layout.along(layout.segments_of(i)[-1], derivative[k : k + 1])


def _ending(problem: DiscretizedOrbit, i: int, z: np.ndarray) -> tuple[Piece, np.ndarray, np.ndarray]:
    """The last segment of leg i, with its state and scalars."""
    layout = problem.layout
    last = sum(layout.cuts[: i + 1]) - 1
    return problem.segments[last], *layout.inputs_of(layout.segments[last], z)


def _touching(
    problem: DiscretizedOrbit, i: int, y: np.ndarray, share: float, watched: Watched
) -> tuple[np.ndarray, np.ndarray]:
    """A guard and its rate at the last unknown, an instant of leg i near a share of it, with derivatives.

    The motion is that of the segment in which it lies, from its start up to there.
    """
    layout, size = problem.layout, problem.size
    first = sum(layout.cuts[:i])
    # One at the very start of a segment is looked at from the one before: motions of no time tell no rate.
    within = [
        k for k, own in enumerate(layout.segments_of(i)) if own.begin < share - AFTER * (own.end - own.begin)
    ]
    number = first + max(within, default=0)
    segment, piece = layout.segments[number], problem.segments[number]
    x, scalars = layout.inputs_of(segment, y[: size + 1])
    n, lasting = len(x), float(y[layout.durations.start + i])
    share = (share - segment.begin) / (segment.end - segment.begin)
    inside = piece.steps[1:][piece.steps[1:] < share - 1e-12] / max(share, 1e-12)
    piece = Piece(piece.passage, np.concatenate([[0.0], inside, [1.0]]), piece.method, piece.fixed)
    since = y[-1] - segment.begin * lasting if number > first else y[-1]
    scalars = np.concatenate([[since], scalars[1:]])
    end, moved = piece.before_differentiated(PLAIN, x, scalars)
    values, derivative = watched.differentiated(1.0, end, moved, piece.values(scalars))
    by_time = derivative[:, n].copy()
    derivative[:, n] = 0.0
    rows = layout.along(segment, derivative)
    if number > first:  # a longer leg lets its segment begin later
        rows[:, layout.durations.start + i] -= segment.begin * by_time
    return values, np.hstack([rows, by_time[:, None]])


def growth(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, direction: np.ndarray) -> float:
    """How fast along a direction a leg's duration grows, or its guard goes past zero where it begins."""
    row = float(_rows(problem, limit, z, 0.0)[1][0] @ direction)
    if limit.test == "duration":
        return row
    return row if transition_of(problem, limit).direction == "rising" else -row


# -- in words ----------------------------------------------------------------------------------------------


def place_of(problem: DiscretizedOrbit, limit: Limit, located: Located) -> str:
    """Where in the cycle a limit is met."""
    leg = problem.word.legs[limit.leg]
    event = problem.word.leading_in(problem.system, limit.leg)
    begins = "the start of the period" if problem.forced else "the orbit's start"
    before = f"'{event}'" if event else begins
    after = problem.system.lasting(float(located.vectors["seconds"]), ".10g")
    if limit.test == "duration":
        return f"'{limit.name}' follows {before} at once: between them mode {leg.mode} lasts no time"
    if limit.test == "condition":
        return f"'{limit.name}' is zero at '{leg.name}'"
    if limit.test == "rate":
        return (
            f"'{limit.name}' arrives with no rate, {after} after {before}, in mode {leg.mode}: "
            "multipliers that grow beyond all bounds do so as the inverse of its rate"
        )
    if limit.test == "past":
        return (
            f"'{limit.name}' follows {before} at once up to here: its guard is zero where "
            f"mode {leg.mode} begins"
        )
    if limit.test == "leaving":
        return f"'{limit.name}' is not left again: right after it, in mode {leg.mode}, its guard has no rate"
    return f"'{limit.name}' is touched {after} after {before}, in mode {leg.mode}"


def sentence(problem: DiscretizedOrbit, located: Located) -> str:
    """What fails beyond a limit, and what is nearest to it."""
    there = located.problem if located.problem is not None else problem
    limit = problem.limits[int(located.vectors["limit"])]
    found = there.margins(located.z)
    others = [
        (float(r), o, float(v))
        for k, (r, o, v) in enumerate(zip(found.relative, found.limits, found.values, strict=True))
        if k != int(located.vectors["limit"]) and np.isfinite(v) and o.test != "duration"
    ]
    text = f"At {problem.free} = {float(located.z[-1]):.12g} {place_of(there, limit, located)}."
    violated = dict.fromkeys(o.name for r, o, _ in others if r < -ZERO)
    if violated:
        text += f" Not admissible before: {', '.join(violated)}."
    kept = [entry for entry in others if entry[0] >= -ZERO and entry[1].name != limit.name]
    if kept:
        _, nearest, value = min(kept, key=lambda entry: entry[0])
        text += f" Nearest beside it: '{nearest.name}' ({nearest.test}) with a margin of {value:.4g}."
    return text
