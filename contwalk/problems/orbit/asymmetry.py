"""How far an orbit is from repeating itself, and from being its own image, in units of its range."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import compress

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.itinerary import has_image, imaged_leg
from contwalk.problems.orbit.own_image import ALIKE, NEARLY
from contwalk.problems.orbit.transport import carried_to
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# An orbit whose states move by less, in parts of their magnitudes, is at rest: what differs there is errors.
AT_REST = 1e-6
# Parts of the closure within which an instant is that of a step.
AT_STEP = 1e-14
# One leg may be gone round so many times at most, and be told as once; what is that near to where it began,
# between steps, is looked at.
MOST_REPETITIONS, NEAR = 1000, 1e-2
# Where on one leg states are compared with their images, in parts of what is before the last image; and what
# counts as near at the first of these.
PHASES, NEAR_AT_START = (0.0, 0.25, 0.5, 0.75), 0.03
# Solutions of which it is remembered: of both ends of a step it is asked more than once, and between of the
# guess of a first one.
MOST_KEPT = 3


def of_moving(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    """As `asymmetries`; nothing of an orbit at rest, z of shape (N + 1,), whose images are all itself."""
    mesh, single = problem.mesh, problem.itinerary.single
    at_rest = single and (mesh.variation <= AT_REST * mesh.magnitudes).all()
    return {} if at_rest else asymmetries(problem, z)


def asymmetries(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    """Distances of an orbit, z of shape (N + 1,), from its images, by name: zero where it is its parent's.

    One leg is compared with itself half a closure later; of an orbit that closes up to a symmetry, of which
    each part is a whole, its states with their own images; and with its images under powers of symmetries, a
    part of the closure later. Legs are compared with those that a part of the itinerary later are the same
    ones, or their images.

    Raises
    ------
    NotFinite
        If the motion ends before the closure does.
    """
    return problem.known.at("asymmetries", z, MOST_KEPT, lambda: _measured(problem, z))


def _measured(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    if problem.itinerary.single:
        return _of_one_leg(problem, z)
    found = {f"{times} parts": away for times, away in parts_apart(problem, z)}
    halves = ((symmetry.name, between_halves(problem, z, symmetry)) for symmetry in swapping(problem, z))
    return found | {name: max(away, default=0.0) for name, away in halves}


def nearly_less(problem: DiscretizedOrbit, z: np.ndarray) -> bool:
    """Whether an orbit z, shape (N + 1,), misses but little to repeat itself, or to be its own image.

    The errors of its steps may hide that it does.
    """
    found = [away for _, away in parts_apart(problem, z)]
    found += asymmetries(problem, z).values()
    return any(ALIKE <= away < NEARLY for away in found)


def repetitions(problem: DiscretizedOrbit, z: np.ndarray) -> int:
    """How often an orbit z, shape (N + 1,), runs through itself in its closure."""
    return next((times for times, away in parts_apart(problem, z) if away < ALIKE), 1)


def parts_apart(problem: DiscretizedOrbit, z: np.ndarray) -> Iterator[tuple[int, float]]:
    """Into how many equal parts an orbit may be divided, and by how much it misses to repeat itself; the most
    first. Of one leg only those that are near.

    z has the shape (N + 1,).
    """
    divisions = list(_divisions(problem))
    if not problem.itinerary.single:
        yield from ((times, max(_between_parts(problem, z, times), default=0.0)) for times in divisions)
        return
    if not divisions:
        return
    near = [True] * len(divisions)
    if len(views := problem.view(z)) == 1:  # a look between steps is enough to leave most out
        there = zip(divisions, views[0].full(views[0].at(1.0 / np.array(divisions))), strict=True)
        near = [apart(problem, z, x - problem.turns / times) < NEAR for times, x in there]
    for times in compress(divisions, near):
        yield times, apart(problem, z, state_at(problem, z, 1.0 / times) - problem.turns / times)


# -- one leg -----------------------------------------------------------------------------------------------


def state_at(problem: DiscretizedOrbit, z: np.ndarray, part: float) -> np.ndarray:
    """Full state after a part of the closure: that of a step, as of steps that are alike in parts.

    Shape (n,) of z, shape (N + 1,).
    """
    there, own = problem.explicit(z)
    views, i, share = problem.view(z), 0, part
    if len(views) > 1:
        ends = np.cumsum([view.duration for view in views])
        i = min(int(np.searchsorted(ends, float(ends[-1]) * part)), len(views) - 1)
        share = 1.0 - (float(ends[i]) - float(ends[-1]) * part) / views[i].duration
    step = np.flatnonzero(np.abs(views[i].piece.steps - share) <= AT_STEP)
    if len(step):
        return views[i].full(views[i].nodes[step[-1]])
    return views[i].full(carried_to(there, own, np.zeros(len(own)), share, i)[0])


def apart(
    problem: DiscretizedOrbit, z: np.ndarray, y: np.ndarray, i: int = 0, start: np.ndarray | None = None
) -> float:
    """How far a full state y is from the one at the start of leg i, or another, in units of the range.

    y and `start` have the shape (n,).

    But for where it is along neutral directions: one who drifts along, so that the whole closes, sees its
    parts close elsewhere where the image of a direction is its opposite.

    z has the shape (N + 1,).
    """
    own, scale = list(problem.passages[i].states), problem.mesh.variation
    start = _start(problem, z, i) if start is None else start
    given = y, start, problem.values_of(z), scale, own
    return float(np.linalg.norm(neutrals.apart_at_least(problem.system, problem.pins, *given) / scale))


def _of_one_leg(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    x, itinerary = _start(problem, z, 0), problem.itinerary
    states = _States(problem, z)
    found = dict[str, float]()
    # The force alone is the same again after one of its periods, not after a half: an orbit at rest is
    # no parent's.
    if not problem.forced or problem.subharmonic % (2 * itinerary.closures) == 0:
        found["itself"] = states.apart(0.5, lambda y: y - 0.5 * problem.turns)
    p = ParameterValues(**problem.values_of(z))
    if itinerary.image:
        own = problem.system.symmetry(itinerary.image)
        found["whole"] = states.apart(0.0, lambda y: imaged(own, y, p, itinerary.power))
        if itinerary.order % 2:
            # What is doubled closes up to the symmetry too, and its parent in half the time.
            half = itinerary.power * (itinerary.order + 1) // 2 % itinerary.order
            found["half"] = states.apart(0.5, lambda y: imaged(own, y, p, half))
    for symmetry in problem.system.symmetries:
        order = order_of(symmetry, x, p)
        if itinerary.image or symmetry.role != "spatial" or order is None or order < 2:
            continue
        for power in range(1, order):
            image = partial(imaged, symmetry, parameters=p, power=power)
            found[f"{symmetry.name} {power}"] = states.apart(1.0 / order, image)
    return found


@dataclass
class _States:
    """States of an orbit of one leg at parts of its closure, each computed once."""

    problem: DiscretizedOrbit
    z: np.ndarray
    known: dict[float, np.ndarray] = field(default_factory=dict)

    def at(self, part: float) -> np.ndarray:
        """The full state there. Shape (n,)."""
        if part not in self.known:
            first = part == 0.0
            self.known[part] = (
                _start(self.problem, self.z, 0) if first else state_at(self.problem, self.z, part)
            )
        return self.known[part]

    def apart(self, later: float, image: Callable[[np.ndarray], np.ndarray]) -> float:
        """How far images of states are from those a part of the closure before them.

        At one phase an orbit may be far nearer to its image than elsewhere: what is near at its start is
        looked at all around.
        """
        found = 0.0
        for share in PHASES:
            part = share * (1.0 - later)
            found = max(found, apart(self.problem, self.z, image(self.at(part + later)), start=self.at(part)))
            if found > NEAR_AT_START:
                break
        return found


# -- legs --------------------------------------------------------------------------------------------------


def swapping(problem: DiscretizedOrbit, z: np.ndarray) -> Iterator[Symmetry]:
    """Symmetries that take the first half of a whole orbit's itinerary to the second.

    z has the shape (N + 1,).
    """
    half, rest = divmod(problem.layout.legs, 2)
    if rest or problem.itinerary.image or not problem.itinerary.eventful or np.any(problem.turns):
        return
    first, second = problem.itinerary.legs[:half], problem.itinerary.legs[half:]
    system, p = problem.system, ParameterValues(**problem.values_of(z))
    for symmetry in system.symmetries:
        if symmetry.role != "spatial" or order_of(symmetry, _start(problem, z, 0), p) != 2:
            continue
        if not all(has_image(system, symmetry, leg) for leg in first):
            continue
        if second == tuple(imaged_leg(system, symmetry.name, leg) for leg in first):
            yield symmetry


def between_halves(problem: DiscretizedOrbit, z: np.ndarray, symmetry: Symmetry) -> Iterator[float]:
    """How far each leg's start in the second half is from the image of that in the first.

    z has the shape (N + 1,).
    """
    half, p = problem.layout.legs // 2, ParameterValues(**problem.values_of(z))
    for i in range(half):
        yield apart(problem, z, imaged(symmetry, _start(problem, z, i), p), i + half)


def _divisions(problem: DiscretizedOrbit) -> Iterator[int]:
    """Into how many equal parts an orbit of its itinerary may be divided, the most first."""
    forced, turns = problem.forced, problem.turns
    own = np.array([s.period or 1.0 for s in problem.system.states])
    if problem.itinerary.eventful:
        most = problem.layout.legs
    elif forced:
        most = problem.subharmonic
    else:
        most = min(sum(len(times) for times in problem.mesh.steps), MOST_REPETITIONS)
        most = most if problem.itinerary.single else 2
    for times in range(most, 1, -1):
        whole = not forced or problem.subharmonic % times == 0
        whole = whole and np.allclose(np.round(turns / times / own), turns / times / own)
        if whole and problem.itinerary.has_parts(problem.system, times):
            yield times


def _between_parts(problem: DiscretizedOrbit, z: np.ndarray, times: int) -> Iterator[float]:
    """How far an orbit of an itinerary that repeats itself is from itself after the first of some parts."""
    if not problem.itinerary.eventful:
        yield apart(problem, z, state_at(problem, z, 1.0 / times) - problem.turns / times)
        return
    part, image = problem.layout.legs // times, problem.itinerary.image
    symmetry = problem.system.symmetry(image) if image else None
    p = ParameterValues(**problem.values_of(z))
    turns = np.zeros(problem.states) if symmetry else problem.turns / times
    for i in range(problem.layout.legs - part):
        yield apart(problem, z, imaged(symmetry, _start(problem, z, i + part), p) - turns, i)


def _start(problem: DiscretizedOrbit, z: np.ndarray, i: int) -> np.ndarray:
    """Full state at the start of a leg."""
    return problem.passages[i].full(z[problem.layout.states[i]])
