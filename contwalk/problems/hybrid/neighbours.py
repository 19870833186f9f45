"""The words on the other side of a limit, and the branches of their orbits.

At a grazing, the orbit itself is an orbit of the neighbouring word too: of one in which the event that is
just touched happens, with no speed, or of one in which the event that arrives with no speed does not. It
solves the neighbour's equations exactly, provided that the transition changes nothing at no speed, as an
impact law does. The same is true where a leg's duration passes zero and two transitions that happen at once
may be exchanged. The branch that leaves is the null direction of the neighbour's equations there, taken the
way in which its own limit grows; its first orbits are simulated to see that the machine goes round in that
word.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError, NotFinite, StartError
from contwalk.numerics.linear import kernel_direction
from contwalk.numerics.spectrum import complement
from contwalk.problems.hybrid import beyond, cutting, limit_points, limits, margin_values
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.following import follows
from contwalk.problems.hybrid.least import least
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.switching import discretized, rotated
from contwalk.problems.hybrid.telling import first_sentence, told_once
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.orbit.word import Leg, Word, continued, imaged_leg
from contwalk.problems.problem import Seed
from contwalk.signatures import folded
from contwalk.system import Transition
from contwalk.system.declarations import ParameterValues

# A transition at no speed that moves the state by more than this part of its variation changes something.
CHANGES = 1e-6
SECANTS = 12
# A leg that lasts less, in parts of the closure, is one of no time where its ends are limits.
VISITED = 1e-5
# Legs begin or cease to last together where their margins are this small.
TOGETHER = 1e-8
# Guards are touched together whose margins are this small, in an orbit that nobody has declared to be its own
# image: one of them is located, the others as well as the orbit is symmetric; rates to the root of that.
# States so far apart, in its variation, are not the same touch.
TOUCHES, TOUCHED, ARRIVED, SAME_TOUCH = ("dip", "rate"), 1e-6, 1e-4, 1e-2
# Directions of a branch before and after an exchange that differ by more make a corner.
CORNER = 1e-5
# A state comes back to wherever it starts from if closing up tells this little of it.
STILL = 1e-9
# How far along the new branch its orbits are looked at, in the metric: the first that is admissible counts.
STEPS = (1e-3, 1e-4, 1e-2)


@dataclass(frozen=True, eq=False)
class Neighbour:
    """An orbit at a limit as one of another word; `grows` is the limit whose margin leaves zero there."""

    problem: DiscretizedOrbit
    z: np.ndarray
    grows: Limit


class _None(Exception):
    """There is no neighbour; the text says what was tried."""


class _Undetermined(_None):
    """There are orbits of the neighbouring word, but no branch of them."""


def found(problem: DiscretizedOrbit, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
    """The branches of neighbouring words that leave a limit, and in words what was found, or tried."""
    try:
        limit, place = _limit_of(problem, point)
        seeds = _leaving(*_turned(problem, np.array(point.unknowns), limit), place, point.label)
    except _Undetermined as reason:
        return (), str(reason)
    except _None as reason:
        simulated, told = beyond.seeds(problem, point)
        return simulated, f"No orbit of another signature passes there: {reason} {told}"
    except (NotFinite, np.linalg.LinAlgError) as error:
        return (), f"No neighbour to switch to: its equations have no solution there ({error})."
    words = dict.fromkeys(_words(cast("DiscretizedOrbit", seed.problem)) for seed in seeds)
    branches = "a branch of their own" if len(seeds) == 1 else f"{len(seeds)} branches of their own"
    return seeds, f"The orbits with signature {' and '.join(words)} leave there: {branches}."


def _words(problem: DiscretizedOrbit) -> str:
    """The signature, over the whole period."""
    return f"[{folded(problem.signature) or 'no events'}]"


def _leaving(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, place: float, label: str) -> list[Seed]:
    """The branches that leave a limit. Where several limits are met there, as by an orbit that is its own
    image, all of them may be passed, or one.

    Raises
    ------
    _None
        If there is none; the text says why the first one tried is none.
    """
    alike = _together(problem, z, limit)
    seeds: list[Seed] = []
    reasons = []
    for changing in ([limit, *alike], *([each] for each in (limit, *alike) if alike)):
        try:
            at = place if changing[0] is limit else _place(problem, z, changing[0])
            neighbour = _all_built(problem, z, changing, at)
            seed = _seed(neighbour, label, _words(neighbour.problem))
            if not any(_one(seed, other) for other in seeds):
                seeds.append(seed)
        except _None as reason:
            reasons.append(reason)
        except StartError as reason:
            reasons.append(
                _None(f"the equations of the itinerary beyond have no solution there: {reason.sentence}")
            )
    if not seeds:
        raise reasons[0]
    return seeds


def _one(a: Seed, b: Seed) -> bool:
    """Whether two branches that leave a point are one: their orbits go through the same word alike."""
    one, other = cast("DiscretizedOrbit", a.problem), cast("DiscretizedOrbit", b.problem)
    mine, lasting, _ = _whole(one, a.z)
    theirs, alike, _ = _whole(other, b.z)
    for k in range(len(one.word)):
        if one.word.rotated(one.system, k) != other.word:
            continue
        shifted = [*mine[k:], *mine[:k]]
        scale = one.mesh.variation
        apart = max(float(np.linalg.norm((x - y) / scale)) for x, y in zip(shifted, theirs, strict=True))
        turned = np.array([*lasting[k:], *lasting[:k]])
        if apart < SAME_TOUCH and float(np.abs(turned - alike).max()) < SAME_TOUCH * one.mesh.total:
            return True
    return False


def _together(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> list[Limit]:
    """The other limits of the kind of one that are met where it is."""
    if limit.test not in TOUCHES:
        return _collapsing(problem, z, limit)
    found = discretized(problem, z).margins(z)
    return [
        other
        for other, share in zip(found.limits, found.relative.tolist(), strict=True)
        if other.test == limit.test and other.acts and (other.leg, other.name) != (limit.leg, limit.name)
        if abs(share) < (TOUCHED if limit.test == "dip" else ARRIVED)
    ]


def _all_built(
    problem: DiscretizedOrbit, z: np.ndarray, changing: Sequence[Limit], place: float
) -> Neighbour:
    """The neighbour beyond all of some limits; `place` is that of the first on its leg, where it turns.

    Raises
    ------
    _None
    """
    first, *others = changing
    if others and first.test not in TOUCHES:
        return _collapsed(problem, z, changing)
    scale = discretized(problem, z).mesh.variation
    touched = [_touched(problem, z, other, scale) for other in others]
    neighbour = _built(problem, z, first, place)
    for other, state in zip(others, touched, strict=True):
        there, unknowns = neighbour.problem, neighbour.z
        again = [o for o in there.limits if (o.test, o.name) == (other.test, other.name)]
        apart = [float(np.linalg.norm(_touched(there, unknowns, o, scale) - state)) for o in again]
        apart = [each if np.isfinite(each) else np.inf for each in apart]
        if not apart or not min(apart) < SAME_TOUCH:
            if other.test == "rate":
                continue  # it has gone with the first: a mode is not visited any more
            raise _None(f"'{first.name}' and '{other.name}' are met at once, and cannot both be passed.")
        nearest = again[int(np.argmin(apart))]
        neighbour = _built(there, unknowns, nearest, _place(there, unknowns, nearest))
    return neighbour


def _touched(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, scale: np.ndarray) -> np.ndarray:
    """Where a guard is touched, or arrives; NaN where it does not turn.

    The phase of the force, as a place on a circle, and the full state in units of `scale`.
    """
    there = discretized(problem, z)
    share = 1.0 if limit.test == "rate" else float(there.margins(z).places[there.limits.index(limit)])
    if not np.isfinite(share):
        return np.full(2 + len(scale), np.nan)
    instant = there.starting_times(z)[limit.leg] + share * z[there.layout.durations][limit.leg]
    phase = 2.0 * np.pi * instant / (there.rounds * there.duration(z)) if there.forced else 0.0
    state = _at(there, z, limit.leg, share) / scale
    return np.array([np.cos(phase), np.sin(phase), *state])


def _place(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> float:
    """Where on its leg a limit is met, 0..1."""
    there = discretized(problem, z)
    place = float(there.margins(z).places[there.limits.index(limit)])
    return _turning(there, z, limit, place) if limit.test == "dip" else place


def _collapsing(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> list[Limit]:
    """The other legs that begin or cease to last where one does: those of its image, of a symmetric orbit."""
    if not _collapses(problem, limit) and limit.test != "past":
        return []
    found = discretized(problem, z).margins(z)
    return [
        other
        for other, share in zip(found.limits, found.relative.tolist(), strict=True)
        if other.leg != limit.leg
        and abs(share) < TOGETHER
        and (other.test == "past" or _collapses(problem, other))
    ]


def corners(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, tangent: np.ndarray) -> bool:
    """Whether the branch has a corner where two events are exchanged: its way before is not its way after.

    `tangent` is that of the branch that arrives. Compared are the parameter and the starts of all other legs,
    across the flow.
    """
    found = discretized(problem, z).margins(z)
    which = found.limits.index(limit)
    if _arrival(found, which, problem.layout.legs) != which:
        return False  # a visit begins or ceases, as the root of the distance
    try:
        if problem.word.image:
            problem, z, limit = _turned(problem, z, limit)
            tangent = kernel_direction(problem.linearize(z).jacobian, filled_magnitudes(problem, z))
        neighbour = _built(problem, z, limit, 0.0)
    except (_None, NotFinite, np.linalg.LinAlgError):
        return False
    there = neighbour.problem
    weights = filled_magnitudes(there, neighbour.z)
    leaving = kernel_direction(there.linearize(neighbour.z).jacobian, weights)
    leaving = leaving * np.sign(limit_points.growth(there, neighbour.z, neighbour.grows, leaving))
    rough = discretized(problem, z)
    arriving = tangent * -np.sign(limit_points.growth(rough, z, limit, tangent))

    if there.layout.sizes != problem.layout.sizes:
        return bool(np.sign(arriving[-1]) != np.sign(leaving[-1]))
    scales = [there.extended(i) for i in range(there.layout.legs)]
    before = _direction_of_orbit(rough, z, arriving, limit.leg, scales, weights[-1])
    after = _direction_of_orbit(there, neighbour.z, leaving, limit.leg, scales, weights[-1])
    return float(np.linalg.norm(before - after)) > CORNER


def _turned(
    problem: DiscretizedOrbit, z: np.ndarray, limit: Limit
) -> tuple[DiscretizedOrbit, np.ndarray, Limit]:
    """The same orbit, beginning elsewhere if it closes up to a symmetry just where the word changes.

    Raises
    ------
    _None
        If there is no other place where it may begin.
    """
    m, i = problem.layout.legs, limit.leg
    # What is inserted may stand anywhere; what is removed or exchanged must not meet the image. The only
    # event that there is has no other place: `_removed` knows it.
    lowest, highest = {"duration": (1, m - 2), "rate": (0, max(m - 2, 0))}.get(limit.test, (0, m - 1))
    if _collapses(problem, limit):
        lowest, highest = 0, m - 1
    if not problem.word.image or lowest <= i <= highest:
        return problem, z, limit
    if lowest > highest:
        raise _None(f"half of the itinerary has {m} events only.")
    place = (lowest + highest + 1) // 2
    there, turned = rotated(problem, z, (i - place) % m)
    return there, turned, replace(limit, leg=place)


def _direction_of_orbit(
    problem: DiscretizedOrbit,
    z: np.ndarray,
    vector: np.ndarray,
    without: int,
    scales: Sequence[np.ndarray],
    weight: float,
) -> np.ndarray:
    """How an orbit changes along a direction, as a unit vector: its legs' starts, and the parameter.

    Along the flow a start moves with the instant of its event, and along pinned directions with the observer:
    both say nothing about the orbit.
    """
    parts = []
    for i in range(problem.layout.legs):
        if i == without:
            continue
        own, scalars = problem.layout.inputs(i, vector)
        direction = (np.append(own, scalars[1]) if problem.forced else own) / scales[i]
        along = [monodromy.flow_direction(problem, z, i), *monodromy.pinned_directions(problem, z, i)]
        across = complement((np.array(along) / scales[i]).T)
        parts.append(across.T @ direction)
    whole = np.concatenate([*parts, [vector[-1] / weight]])
    return whole / max(float(np.linalg.norm(whole)), 1e-300)


def _limit_of(problem: DiscretizedOrbit, point: SpecialPoint) -> tuple[Limit, float]:
    """Which limit a stored point is, and where on its leg, 0..1."""
    z = np.array(point.unknowns)
    there = discretized(problem, z)
    values, k = there.margins(z), limit_points.nearest(there, point)
    k = _arrival(values, k, problem.layout.legs)
    limit, place = values.limits[k], float(values.places[k])
    if not limit.acts:
        raise _None("the event that is met there acts on nothing.")
    return limit, _turning(there, z, limit, place) if limit.test == "dip" else place


def _arrival(found: Margins, which: int, legs: int) -> int:
    """The limit that tells what happens at limit number `which`: of a leg that lasts no time the rate of the
    event that leads into it, where that is zero.

    The guard turns there: the leg is a visit that ceases. It is not passed in no time beyond.
    """
    limit, before = found.limits[which], (found.limits[which].leg - 1) % legs
    if limit.test != "duration":
        return which
    shares = found.relative.tolist()
    rates = [k for k, other in enumerate(found.limits) if (other.leg, other.test) == (before, "rate")]
    return next((k for k in rates if abs(shares[k]) < ARRIVED), which)


def _turning(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, place: float) -> float:
    """Where on its leg a guard turns, by the secant method on its exact rate from nearly there."""
    view, transition = problem.view(z)[limit.leg], limits.transition_of(problem, limit)
    piece, scalars, nodes = view.piece, view.scalars, view.nodes
    watched, values = piece.passage.watched(transition.name, transition.guard), piece.values(scalars)

    def rate(time: float) -> float:
        return float(watched(time, piece.at(nodes, np.array([time]), scalars)[0], values)[1])

    a, b = place, min(place + 1e-4, 1.0)
    fa, fb = rate(a), rate(b)
    for _ in range(SECANTS):
        if fa == fb or abs(b - a) < 1e-15:
            break
        a, fa, b = b, fb, min(max(b - fb * (b - a) / (fb - fa), 0.0), 1.0)
        fb = rate(b)
    return b


def _built(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, place: float) -> Neighbour:
    """The neighbour at a limit.

    Raises
    ------
    _None
    """
    transition = limits.transition_of(problem, limit)
    if limit.test == "dip":
        return _inserted(problem, z, limit, place, transition)
    if limit.test == "rate":
        return _removed(problem, z, limit, transition)
    if limit.test == "past" or _collapses(problem, limit):
        return _collapsed(problem, z, [limit])
    if limit.test == "duration":
        return _gone(problem, z, limit)
    if limit.test == "leaving":
        raise _None(f"'{limit.name}' would happen again at once, for ever: the machine rests there.")
    raise _None(
        f"'{limit.name}' and '{problem.word.legs[limit.leg].name}' happen at once there, and no itinerary "
        "with both is known."
    )


def _unchanged(
    problem: DiscretizedOrbit, transition: Transition, before: np.ndarray, after: np.ndarray
) -> None:
    """Refuse a transition that changes the state although it arrives with no speed."""
    apart = np.abs(after - before) / problem.mesh.variation
    if float(apart.max()) > CHANGES:
        k = int(np.argmax(apart))
        raise _None(
            f"'{transition.name}' changes '{problem.system.state_names[k]}' by {after[k] - before[k]:.4g} "
            "even where it arrives with no speed, so that no orbit through it is near."
        )


def _at(problem: DiscretizedOrbit, z: np.ndarray, i: int, place: float) -> np.ndarray:
    """Full state on leg i."""
    view = problem.view(z)[i]
    return view.full(view.piece.at(view.nodes, np.array([place]), view.scalars)[0])


def _after(problem: DiscretizedOrbit, leg: Leg, x: np.ndarray, t: float, z: np.ndarray) -> np.ndarray:
    """Full state after a transition out of a state at a time."""
    from contwalk.flow.hybrid.motions import applied, hybrid_machine

    assert leg.transition is not None
    return applied(hybrid_machine(problem.system, problem.values_of(z)), leg.transition, t, x)


def _of_legs(
    problem: DiscretizedOrbit,
    word: Word,
    states: Sequence[np.ndarray],
    lasting: Sequence[float],
    start: float,
    z: np.ndarray,
) -> tuple[DiscretizedOrbit, np.ndarray]:
    """A problem and its unknowns from full states at the legs' starts and their durations."""
    other, drifts = problem.of_word(word), z[problem.layout.drifts]
    unknowns = other.assembled(states, lasting, drifts, float(z[-1]), start if word.eventful else 0.0)
    if problem.fitting(z).cuts > 1:
        unknowns = cutting.copied(other, unknowns, start, discretized(problem, z), z)
    return discretized(other, unknowns), unknowns


def _whole(problem: DiscretizedOrbit, z: np.ndarray) -> tuple[list[np.ndarray], list[float], float]:
    """Full states at the starts of the legs, durations, and when the first starts."""
    states = [
        passage.full(z[place]) for passage, place in zip(problem.passages, problem.layout.states, strict=True)
    ]
    return states, z[problem.layout.durations].tolist(), float(problem.starting_times(z)[0])


def _inserted(
    problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, place: float, transition: Transition
) -> Neighbour:
    """The event that is touched happens."""
    there, i = discretized(problem, z), limit.leg
    old = problem.word.legs[i]
    if transition.target != old.mode:
        rest = ", ".join(leg.name for leg in problem.word.legs[i:] if leg.name)
        follows = f"the rest of the itinerary ({rest}) does" if rest else "a motion without events does"
        raise _None(
            f"after '{transition.name}' the machine is in mode '{transition.target}', from where {follows} "
            "not follow."
        )
    falls = transition.direction != "rising"
    leg = Leg(old.mode, transition, falls if transition.direction != "both" else _falls(there, z, limit))
    states, lasting, start = _whole(there, z)
    x, t = _at(there, z, i, place), float(there.starting_times(z)[i]) + place * lasting[i]
    after = _after(problem, leg, x, t, z)
    _unchanged(there, transition, x, after)
    word = problem.word.inserted(i, leg)
    first, second = place * lasting[i], (1.0 - place) * lasting[i]
    states = [*states[: i + 1], after, *states[i + 1 :]]
    lasting = [*lasting[:i], first, second, *lasting[i + 1 :]]
    if not problem.word.eventful:
        word, states, lasting = _after_event(there, z, word, i, states, lasting)
        start, i = t, len(word) - 1
    other, unknowns = _of_legs(there, word, states, lasting, start, z)
    return Neighbour(other, unknowns, _own(other, i, "rate"))


def _after_event(
    problem: DiscretizedOrbit,
    z: np.ndarray,
    word: Word,
    i: int,
    states: list[np.ndarray],
    lasting: list[float],
) -> tuple[Word, list[np.ndarray], list[float]]:
    """What begins between events, as beginning right after the event that ends leg i: that leg comes last."""
    symmetry = problem.system.symmetry(word.image) if word.image else None
    p, early = ParameterValues(**problem.values_of(z)), word.legs[: i + 1]
    if symmetry is not None:
        early = tuple(imaged_leg(problem.system, word.image, leg) for leg in early)
    legs = continued((*word.legs[i + 1 :], *early))
    # The last leg goes on as the first one.
    given = [*states[i + 1 :], *(imaged(symmetry, x, p) for x in states[1 : i + 1])]
    joined = [*lasting[i + 1 : -1], lasting[-1] + lasting[0], *lasting[1 : i + 1]]
    return replace(word, legs=legs), given, joined


def _falls(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> bool:
    """Whether a guard of direction `both` comes down to zero: it is positive elsewhere on its leg."""
    values = problem.view(z)[limit.leg].guard_values(limits.transition_of(problem, limit))
    return bool(values[int(np.argmax(np.abs(values)))] > 0.0)


def _removed(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit, transition: Transition) -> Neighbour:
    """The event that arrives with no speed does not happen."""
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    following = (i + 1) % m
    target = transition.target if m == 1 else problem.word.legs[following].mode
    if target != problem.word.legs[i].mode:
        first = _visit(problem, z, i)
        if first is not None:
            return _without_visit(problem, z, first)
        raise _None(
            f"without '{transition.name}' the machine stays in mode '{problem.word.legs[i].mode}', from "
            "where the rest of the itinerary does not follow."
        )
    states, lasting, start = _whole(there, z)
    _unchanged(there, transition, _at(there, z, i, 1.0), _image(there, z, states[following], i))
    if m == 1:
        return _quiet(there, z, transition, start)
    word = problem.word.without(i)
    merged = lasting[i] + lasting[following]
    if following == 0:  # the first leg now begins where the last one did
        kept, times = [states[i], *states[1:i]], [merged, *lasting[1:i]]
        start -= lasting[i]
        place = 0
    else:
        kept = [*states[: i + 1], *states[i + 2 :]]
        times = [*lasting[:i], merged, *lasting[i + 2 :]]
        place = i
    other, unknowns = _of_legs(there, word, kept, times, start, z)
    return Neighbour(other, unknowns, _dip(other, place, transition))


def _visit(problem: DiscretizedOrbit, z: np.ndarray, i: int) -> int | None:
    """The leg, i or the one before, whose event leads into a mode that is left again at once, back again."""
    word, lasting, m = problem.word, z[problem.layout.durations], problem.layout.legs
    for first in (i, (i - 1) % m):
        visited = (first + 1) % m
        back = word.target(visited) == word.legs[first].mode and not word.image
        if m > 1 and back and abs(float(lasting[visited])) < VISITED * problem.duration(z):
            return first
    return None


def _without_visit(problem: DiscretizedOrbit, z: np.ndarray, first: int) -> Neighbour:
    """A mode is not entered in which the orbit is for no time: the events at both its ends do not happen."""
    there, z = rotated(problem, z, first) if first else (discretized(problem, z), z)
    legs, transition = there.word.legs, there.word.legs[0].transition
    assert transition is not None
    states, lasting, start = _whole(there, z)
    _unchanged(there, transition, _at(there, z, 0, 1.0), states[2 % len(legs)])
    if len(legs) == 2:
        return _quiet(there, z, transition, start)
    word = replace(there.word, legs=(replace(legs[2], mode=legs[0].mode), *legs[3:]))
    given = [states[0], *states[3:]], [sum(lasting[:3]), *lasting[3:]]
    other, unknowns = _of_legs(there, word, *given, start, z)
    return Neighbour(other, unknowns, _dip(other, 0, transition))


def _quiet(problem: DiscretizedOrbit, z: np.ndarray, transition: Transition, start: float) -> Neighbour:
    """The only event of a word does not happen: an orbit without events, over the whole cycle."""
    lasting, begin = problem.duration(z), start
    whole = problem.rounds * lasting
    if problem.forced:
        period = whole / problem.subharmonic
        begin = np.ceil(start / period - 1e-12) * period
    share = min((begin - start) / lasting, float(problem.rounds))
    x = _at(problem, z, 0, share) if share <= 1.0 else _image(problem, z, _at(problem, z, 0, share - 1.0), 0)
    word = Word((Leg(problem.word.legs[0].mode),))
    other, unknowns = _of_legs(problem, word, [x], [whole], 0.0, z)
    return Neighbour(other, unknowns, _dip(other, 0, transition))


def _image(problem: DiscretizedOrbit, z: np.ndarray, x: np.ndarray, i: int) -> np.ndarray:
    """What a state is, or was, on the other side of the symmetry that is applied at the end of leg i."""
    name = problem.word.image_at(i)
    symmetry = problem.system.symmetry(name) if name else None
    return imaged(symmetry, x, ParameterValues(**problem.values_of(z)))


def _collapses(problem: DiscretizedOrbit, limit: Limit) -> bool:
    """Whether a leg whose duration vanishes is passed in no time beyond."""
    return limit.test == "duration" and limit_points.collapses(problem, limit.leg)


def _collapsed(problem: DiscretizedOrbit, z: np.ndarray, changing: Sequence[Limit]) -> Neighbour:
    """Legs last no time any more, their guards being past zero where they begin; or they do again."""
    legs = list(problem.word.legs)
    states, lasting, start = _whole(problem, z)
    for each in changing:
        legs[each.leg] = replace(legs[each.leg], collapsed=each.test != "past")
        lasting[each.leg] = 0.0
    i, past = changing[0].leg, changing[0].test != "past"
    other, unknowns = _of_legs(problem, replace(problem.word, legs=tuple(legs)), states, lasting, start, z)
    return Neighbour(other, unknowns, _own(other, i, "past" if past else "duration"))


def _exchanged(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> Neighbour:
    """Two transitions that happen at once happen in the other order."""
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    if m < 2:
        raise _None("the itinerary has one event only.")
    before = (i - 1) % m
    first, second = problem.word.legs[before].transition, problem.word.legs[i].transition
    assert first is not None
    assert second is not None
    origin, target = problem.word.legs[before].mode, problem.word.target(i)
    earlier = [t for t in problem.system.leaving(origin) if _like(t, second)]
    later = [t for t in problem.system.acting if _like(t, first) and t.target == target]
    pairs = [(b, a) for b in earlier for a in later if b.target == a.source]
    if not pairs:
        raise _None(
            f"out of mode '{origin}' no '{second.name}' leads to a mode in which '{first.name}' leads to "
            f"'{target}'."
        )
    b, a = pairs[0]
    states, lasting, start = _whole(there, z)
    t = float(there.starting_times(z)[before]) + lasting[before]
    x = _at(there, z, before, 1.0)
    legs = list(problem.word.legs)
    legs[before] = Leg(origin, b, _direction(b, legs[i]))
    legs[i] = Leg(b.target, a, _direction(a, problem.word.legs[before]))
    middle = _after(problem, legs[before], x, t, z)
    end = _after(problem, legs[i], middle, t, z)
    following = (i + 1) % m
    apart = np.abs(end - states[following]) / there.mesh.variation
    if float(apart.max()) > CHANGES:
        k = int(np.argmax(apart))
        raise _None(
            f"'{second.name}' before '{first.name}' leads to another '{problem.system.state_names[k]}' "
            f"than after it ({end[k]:.6g} and {states[following][k]:.6g}), so that no orbit in that order is "
            "near."
        )
    states[i], lasting[i] = middle, 0.0
    other, unknowns = _of_legs(there, replace(problem.word, legs=tuple(legs)), states, lasting, start, z)
    return Neighbour(other, unknowns, _own(other, i, "duration"))


def _gone(problem: DiscretizedOrbit, z: np.ndarray, limit: Limit) -> Neighbour:
    """A leg that lasts no time: the events at its ends happen in the other order, or do not happen where it
    was a visit in another mode.
    """
    try:
        return _exchanged(problem, z, limit)
    except _None:
        m, legs = problem.layout.legs, problem.word.legs
        first = _visit(problem, z, (limit.leg - 1) % m)
        if first is None or legs[first].mode == legs[(first + 1) % m].mode:
            raise
        return _without_visit(problem, z, first)


def _like(one: Transition, other: Transition) -> bool:
    """Whether two transitions are the same event out of different modes: they have the same guard."""
    return one.guard is other.guard or one.name == other.name


def _direction(transition: Transition, like: Leg) -> bool:
    return like.falls if transition.direction == "both" else transition.direction == "falling"


def _own(problem: DiscretizedOrbit, i: int, test: str) -> Limit:
    return next(
        o for o in problem.limits if o.leg == i and o.test == test and o.name == problem.word.legs[i].name
    )


def _dip(problem: DiscretizedOrbit, i: int, transition: Transition) -> Limit:
    return next(o for o in problem.limits if o.leg == i and o.test == "dip" and o.name == transition.name)


# -- the branch that leaves --------------------------------------------------------------------------------


def _seed(neighbour: Neighbour, label: str, words: str) -> Seed:
    """The branch of a neighbour, facing the way in which its orbits are the machine's.

    Raises
    ------
    _None
    """
    rough, z = neighbour.problem, neighbour.z
    z = newton_on(rough, z, filled_magnitudes(rough, z))
    # Without its slowest event an orbit of many periods may be one of a single period.
    rough, z = least(rough, z)
    there = discretized(rough, z)
    weights = filled_magnitudes(there, z)
    _refuse_undetermined(there, z, weights)
    tangent = kernel_direction(there.linearize(z).jacobian, weights)
    tried = []
    for way in (1.0, -1.0):
        for step in STEPS:
            verdict = _looks(there, z, way * tangent, weights, step)
            if verdict is None:
                break
            tried.append(verdict)
        else:
            continue
        walking = there.adapted_to(z, weights)
        direction = way * tangent
        return Seed(label, z, direction, amplitude(direction), walking, one_sided=True)
    reasons = told_once(tried)
    raise _None(f"orbits with signature {words} solve the equations there, but beside it {reasons}.")


def _refuse_undetermined(problem: DiscretizedOrbit, z: np.ndarray, weights: np.ndarray) -> None:
    """Refuse orbits without events in which a state closes up from wherever it starts.

    A mode that only keeps a state until it is left, as a contact does, says nothing of where it is.

    Raises
    ------
    _Undetermined
    """
    if problem.word.eventful or not problem.forced:
        return
    scaled = problem.linearize(z).jacobian / problem.equation_scales[:, None] * weights
    _, sizes, rows = np.linalg.svd(scaled)
    if sizes[-1] > STILL * sizes[0]:
        return
    place, passage = problem.layout.states[0], problem.passages[0]
    # Of the two directions of solutions, the one in which the parameter stays.
    one, other = rows[-2], rows[-1]
    kept = (one * other[-1] - other * one[-1])[place]
    name = problem.system.state_names[passage.states[int(np.argmax(np.abs(kept)))]]
    raise _Undetermined(
        f"Beyond it the machine stays in mode '{problem.word.legs[0].mode}' for ever, where '{name}' comes "
        f"back to whatever it starts from: at each {problem.free} there is a family of such orbits, and no "
        "branch to follow. Nothing to do."
    )


def _looks(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray, step: float
) -> str | None:
    """Why the orbit a step along a direction is not the machine's; None if it is."""
    guess = z + step * tangent / float(np.linalg.norm(tangent / weights))
    normal = tangent / weights**2
    try:
        there = newton_on(problem, guess, weights, normal)
        margins = problem.margins(there)
        lost = [
            o
            for o, r in zip(margins.limits, margins.relative, strict=True)
            if r < -margin_values.ZERO and o.label != "AZ"
        ]
        if lost:
            return (
                f"'{lost[0].name}' ({lost[0].test}) is violated at {problem.free} = {float(there[-1]):.10g}"
            )
        followed = follows(problem, there)
    except (ContwalkError, np.linalg.LinAlgError) as error:
        return f"Newton's method fails ({first_sentence(str(error))})"
    return None if followed is None else f"a simulation goes another way: {first_sentence(followed)}"
