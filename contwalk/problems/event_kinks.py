"""Guards and resets that are smooth by pieces only, at the states where their event happens.

The equations of an orbit ask for a guard and a reset where their event is, and nowhere else. Where one of
their choices changes between two solutions of a branch, both pieces are evaluated at one place between: a
jump of the state after the event, or of the guard, parts the branch; a jump of slopes parts its multipliers.
Only slopes along the surface of the guard count: no motion has its event beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from contwalk.fields.switching import Inputs, Switching
from contwalk.problems.kink import EventKink, JumpThroughZero, Kink, Met, SteepKink
from contwalk.problems.kinks import JUMPS, PARTS, Course, directions, located, straight

# A state this near to a jump, against its size, is on it: on which side is left to rounding.
ON = 1e-9
# A direction along which the guard changes by less than this part of what it does along others keeps to it.
KEPT = 1e-9

# How far from a place slopes are looked at, in parts of the way to it, and by how much more a slope without
# bound is larger at each than at the one before: one that goes as a power of the distance.
NEARER, STEEPER = (1e-4, 1e-6, 1e-8), 1.5

Direction = Mapping[tuple[str, int], float]


@dataclass(frozen=True)
class EndMap:
    """What happens at an event, as a function of the state there and of what else it depends on.

    Parameters
    ----------
    switching : Switching
        Of the state after the event and, where there is a guard, of that as the last output.
    guarded : bool
    acts : bool
        Whether the motion depends on it.
    through_zero : bool
        Whether it matters only where it jumps through zero: what is told (a condition, say), and guards of
        other events.
    evaluate : callable
        Inputs of the program at places, shape (k, m): the states come first.
    sizes : ndarray
        How large the states are.
    blame : callable
        What it is that jumps between two places (`the reset of transition 'hit'`), and the plugin's line.
    """

    switching: Switching
    guarded: bool
    acts: bool
    evaluate: Callable[[np.ndarray], Inputs]
    sizes: np.ndarray
    blame: Callable[[np.ndarray, np.ndarray], tuple[str, str]]
    through_zero: bool = False


def between(event: EndMap, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What jumps between two places, in their order."""
    given = event.switching, lambda _, places: event.evaluate(places), a, b, lambda before, after: ""
    if not np.any(straight(*given).changes()):
        return ()
    course = straight(*given, PARTS)
    found = []
    for k in np.flatnonzero(np.any(course.changes(), axis=1)).tolist():
        low, high = located(course, k)
        kink = _steep(event, course, low, high) or _told(event, course.at(np.array([low, high])))
        if kink is not None:
            found.append(Met(kink, low))
    return tuple(found)


def on_a_jump(event: EndMap, at: np.ndarray, moving: np.ndarray) -> Kink | None:
    """The jump that a place lies on; `moving`: which of its numbers motions differ by, as a mask."""
    sizes = np.abs(at)
    sizes[: len(event.sizes)] = np.maximum(sizes[: len(event.sizes)], event.sizes)
    aside = ON * np.where(moving, sizes, 0.0) * np.cos(1.0 + np.arange(len(at)))
    kinks = [met.kink for met in between(event, at - aside, at + aside)]
    return next((kink for kink in kinks if kink.order == 0), None)


def through_zero(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Whether numbers jump through zero, or onto it, by their pieces on either side of one place.

    Each has values and their first derivatives, shape (2 or more, outputs). Numbers that are both near to
    zero are apart by rounding alone.
    """
    level = np.max(np.abs([*one[:2], *other[:2]]), axis=0)
    apart = np.abs(one[0] - other[0]) > JUMPS[0] * level
    return np.asarray(apart & (one[0] * other[0] <= 0.0))


def _steep(event: EndMap, course: Course, low: float, high: float) -> SteepKink | None:
    """The place between two neighbouring ones if a slope grows there without bound, as a root's at zero."""
    if event.through_zero:
        return None
    for side, ways in (
        (low, [-low * part for part in NEARER]),
        (high, [(1.0 - high) * part for part in NEARER]),
    ):
        places = course.at(side + np.array(ways))
        slopes = np.abs([_slopes(event, place) for place in places])
        with np.errstate(invalid="ignore"):
            grow = np.all(slopes[1:] > STEEPER * slopes[:-1], axis=0)
        if np.any(grow & (slopes[0] > 0.0)):
            of, where = event.blame(*course.at(np.array([low, high])))
            return SteepKink(1, where, of)
    return None


def _slopes(event: EndMap, place: np.ndarray) -> np.ndarray:
    """Derivatives of all outputs at a place in a direction in which every unknown moves."""
    switching, at = event.switching, _single(event, place)
    along = directions(switching, at, event.sizes)
    slopes: np.ndarray = switching.pieces(at, switching.held(at, along), along, 1)[0, 1]
    return slopes


def _told(event: EndMap, places: np.ndarray) -> Kink | None:
    """What jumps between two neighbouring places; None if nothing does that matters."""
    switching = event.switching
    before, after = (_single(event, place) for place in places)
    along = directions(switching, before, event.sizes)
    one, other = switching.beside(before, before, after, along)
    if event.through_zero:
        if not np.any(through_zero(one, other)):
            return None
        of, where = event.blame(*places)
        return JumpThroughZero(0, where, of, event.acts)
    if not (np.all(np.isfinite(one[:2])) and np.all(np.isfinite(other[:2]))):
        return None
    level = np.max(np.abs([*one[:2], *other[:2]]), axis=0)
    order = 0
    if not np.any(np.abs(one[0] - other[0]) > JUMPS[0] * level):
        order = 1
        one, other = switching.beside(before, before, after, _kept(event, before, after, along))
        if not np.any(np.abs(one[1] - other[1]) > JUMPS[1] * level):
            return None
    of, where = event.blame(*places)
    return EventKink(order, where, of)


def _single(event: EndMap, place: np.ndarray) -> Inputs:
    return event.evaluate(place[None])


def _kept(event: EndMap, before: Inputs, after: Inputs, along: Direction) -> Direction:
    """A direction along the surface of the guard, as it is on the first side."""
    if not event.guarded:
        return along
    switching = event.switching
    other = {name: size * float(np.cos(3.0 * k)) for k, (name, size) in enumerate(along.items())}
    rates = [switching.beside(before, before, after, each)[0][1][-1] for each in (along, other)]
    if abs(rates[1]) <= KEPT * abs(rates[0]):
        return other
    return {name: along[name] - rates[0] / rates[1] * other[name] for name in along}
