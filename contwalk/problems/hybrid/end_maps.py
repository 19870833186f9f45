"""The maps at the ends of an orbit's legs, looked at for jumps of guards and resets, and of their slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.errors import NO_LINE, ContwalkError, NotFinite, PluginError
from contwalk.fields.blame import first_switched
from contwalk.fields.switching import Inputs, Switching
from contwalk.problems.event_kinks import EndMap, between, on_a_jump
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.kink import Kink, Met
from contwalk.problems.orbit.passage import Passage

Written = Callable[[Any, Any, Any, Any], None]


def passed(problem: LimitedOrbit, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What events pass on the way from one orbit to another.

    b need not be a solution: what has no motion passes nothing. Of soft transitions, which may come and go,
    those of one orbit alone are left out.

    a and b have the shape (N + 1,).
    """
    if not _any(problem, a):
        return ()
    try:
        views = [_ended(problem.view(z)) for z in (a, b)]
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return ()
    if [view.piece.passage for view in views[0]] != [view.piece.passage for view in views[1]]:
        views = [[view for view in each if not view.piece.passage.leg.soft] for each in views]
    met = [
        found
        for before, after in zip(*views, strict=True)
        for found in between(_event(problem, before), place_of(before), place_of(after))
    ]
    return tuple(sorted(met, key=lambda found: found.share))


def lying(problem: LimitedOrbit, z: np.ndarray) -> tuple[Kink, ...]:
    """The jumps at which events of an orbit are, to rounding: at every state of their guard, perhaps.

    z has the shape (N + 1,).
    """
    if not _any(problem, z):
        return ()
    found = [
        on_a_jump(_event(problem, view), place_of(view), _moving(view)) for view in _ended(problem.view(z))
    ]
    return tuple(dict.fromkeys(kink for kink in found if kink is not None))


def _any(problem: LimitedOrbit, z: np.ndarray) -> bool:
    """Whether an event of an orbit, soft ones among them, has a map that is smooth by pieces only."""
    return any(passage.end_switching is not None for passage in passages_of(problem, z))


def passages_of(problem: LimitedOrbit, z: np.ndarray) -> tuple[Passage, ...]:
    """The kinds of an orbit's legs, those that soft transitions end among them where z has a motion.

    z has the shape (N + 1,).
    """
    try:
        return tuple(view.piece.passage for view in problem.view(z))
    except (ContwalkError, np.linalg.LinAlgError):
        return problem.passages


def _ended(views: tuple[GuardedView, ...]) -> list[GuardedView]:
    return [view for view in views if view.piece.passage.end_switching is not None]


def place_of(view: GuardedView, *, start: bool = False) -> np.ndarray:
    """All that a map at a leg's end depends on, or at its start: the state, scalars, and parameters.

    Shape (k,).
    """
    return np.concatenate([view.x if start else view.end, view.piece.values(view.scalars)])


def _moving(view: GuardedView) -> np.ndarray:
    """Which of these numbers differ from motion to motion: states and instants."""
    passage = view.piece.passage
    names = _names(passage)
    return np.array([name in ("u", "T", "s") for name, _ in names])


def _names(passage: Passage) -> list[tuple[str, int]]:
    given = [(group, i) for group, size in passage.groups.items() for i in range(size)]
    return [*[("u", k) for k in range(len(passage.states))], *given]


def _event(problem: LimitedOrbit, view: GuardedView) -> EndMap:
    passage = view.piece.passage
    switching = passage.end_switching
    assert switching is not None
    guarded = passage.leg.transition is not None
    return map_at(problem, passage, switching, functions_at_end(passage), guarded=guarded)


def map_at(
    problem: LimitedOrbit,
    passage: Passage,
    switching: Switching,
    functions: Sequence[tuple[str, Written]],
    *,
    guarded: bool = False,
    acts: bool = True,
    through_zero: bool = False,
    share: float = 1.0,
) -> EndMap:
    """What is computed at an instant 0..1 of a leg, by a program made of a plugin's functions."""
    line, names = problem.line, _names(passage)
    start, free = names.index(("T", 0)), names.index(("l", 0))

    def evaluate(places: np.ndarray) -> Inputs:
        return {**dict(zip(names, places.T, strict=True)), ("t", 0): np.full(len(places), share)}

    def at(place: np.ndarray) -> tuple[tuple[float, list[float]], dict[str, float]]:
        """Time and state at a place, and all that the plugin's functions read by name."""
        t = float(share * place[start] + place[start + 1]) if passage.forced else 0.0
        known = line.at(float(place[free])) | dict(passage.system.mode(passage.leg.mode).constants)
        return (t, passage.full(place[: len(passage.states)]).tolist()), known

    def blame(one: np.ndarray, other: np.ndarray) -> tuple[str, str]:
        (before, known), (after, then) = at(one), at(other)
        for of, function in functions:
            where = first_switched(function, before, after, known, then)
            if where != NO_LINE:
                return of, where
        return f"what happens at '{passage.leg.name}'", NO_LINE

    sizes = problem.mesh.magnitudes[list(passage.states)]
    return EndMap(switching, guarded, acts, evaluate, sizes, blame, through_zero)


def functions_at_end(passage: Passage) -> list[tuple[str, Written]]:
    """What the map at the end is made of: the guard, the reset, and that with each map that follows it."""
    transition = passage.leg.transition
    found: list[tuple[str, Written]] = []
    if transition is not None:
        found.append((f"the guard of transition '{transition.name}'", written(transition.guard)))
    before = None if transition is None else transition.reset
    if transition is not None and before is not None:
        found.append((f"the reset of transition '{transition.name}'", before))
    for name in (None if transition is None else transition.relabel, *passage.closing.images):
        if name:
            before = after(passage.system.symmetry(name).map, before)
            found.append((f"the map of symmetry '{name}'", before))
    return found


def written(number: Callable[[Any, Any, Any], Any]) -> Written:
    """A number in the form of a field."""

    def field(t: Any, x: Any, p: Any, out: Any) -> None:
        out[0] = number(t, x, p)

    return field


def after(image: Written, before: Written | None) -> Written:
    """A map that is applied to what another one writes."""

    def both(t: Any, x: Any, p: Any, out: Any) -> None:
        given = x
        if before is not None:
            given = np.full(len(x), 0.0, dtype=object)
            before(t, x, p, given)
        image(t, given, p, out)

    return both
