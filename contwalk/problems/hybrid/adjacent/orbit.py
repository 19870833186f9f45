"""An orbit at a limit as one of an adjacent itinerary, and what such orbits are put together from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.problems.hybrid import cut_legs
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary, Leg, continued, imaged_leg
from contwalk.system import Transition
from contwalk.system.declarations import ParameterValues

# A transition at no speed that moves the state by more than this part of its variation changes something.
CHANGES = 1e-6


@dataclass(frozen=True, eq=False)
class AdjacentOrbit:
    """An orbit at a limit as one of another itinerary.

    Parameters
    ----------
    problem : LimitedOrbit
    z : ndarray, shape (N + 1,)
    grows : Limit
        The one whose margin leaves zero there.
    tangent : ndarray, shape (N + 1,), optional
        Of the branch that leaves, where several do that solve the equations.
    """

    problem: LimitedOrbit
    z: np.ndarray
    grows: Limit
    tangent: np.ndarray | None = None


class NoAdjacentOrbit(Exception):
    """There is no neighbour; the text says what was tried."""


class Undetermined(NoAdjacentOrbit):
    """There are orbits of the neighbouring itinerary, but no branch of them."""


def refuse_change(
    problem: LimitedOrbit, transition: Transition, before: np.ndarray, after: np.ndarray
) -> None:
    """Refuse a transition that changes the state although it arrives with no speed.

    Both states have shape (n,).
    """
    apart = np.abs(after - before) / problem.mesh.variation
    if float(apart.max()) > CHANGES:
        k = int(np.argmax(apart))
        raise NoAdjacentOrbit(
            f"'{transition.name}' changes '{problem.system.state_names[k]}' by {after[k] - before[k]:.4g} "
            "even where it arrives with no speed, so that no orbit through it is near."
        )


def state_on_leg(problem: LimitedOrbit, z: np.ndarray, i: int, place: float) -> np.ndarray:
    """Full state on leg i.

    z has shape (N + 1,), the state shape (n,).
    """
    view = problem.view(z)[i]
    return view.full(view.piece.at(view.nodes, np.array([place]), view.scalars)[0])


def after_transition(problem: LimitedOrbit, leg: Leg, x: np.ndarray, t: float, z: np.ndarray) -> np.ndarray:
    """Full state after a transition out of a state at a time.

    States have shape (n,), z shape (N + 1,).
    """
    from contwalk.flow.hybrid.motions import applied, hybrid_machine

    assert leg.transition is not None
    return applied(hybrid_machine(problem.system, problem.values_of(z)), leg.transition, t, x)


def assembled(
    problem: LimitedOrbit,
    itinerary: Itinerary,
    states: Sequence[np.ndarray],
    lasting: Sequence[float],
    start: float,
    z: np.ndarray,
) -> tuple[LimitedOrbit, np.ndarray]:
    """A problem and its unknowns from full states at the legs' starts and their durations.

    States have shape (n,) each, z shape (N + 1,).
    """
    other, drifts = problem.of_itinerary(itinerary), z[problem.layout.drifts]
    unknowns = other.assembled(states, lasting, drifts, float(z[-1]), start if itinerary.eventful else 0.0)
    if problem.fitting(z).cuts > 1:
        unknowns = cut_legs.copied(other, unknowns, start, discretized(problem, z), z)
    return discretized(other, unknowns), unknowns


@dataclass(frozen=True, eq=False)
class Opened:
    """An orbit on fine steps, as it is taken apart at an instant at which its itinerary changes.

    Parameters
    ----------
    orbit : LimitedOrbit
    z : ndarray, shape (N + 1,)
    states : list of ndarray, shape (n,) each
        Full states at the starts of the legs.
    lasting : list of float
        Durations of the legs.
    start : float
        When the first one starts.
    t : float
        The instant.
    x : ndarray, shape (n,)
        The full state there, before what happens.
    """

    orbit: LimitedOrbit
    z: np.ndarray
    states: list[np.ndarray]
    lasting: list[float]
    start: float
    t: float
    x: np.ndarray

    def after(self, leg: Leg, x: np.ndarray | None = None) -> np.ndarray:
        """Full state after what ends a leg there, out of its state or another one. Shapes (n,)."""
        return after_transition(self.orbit, leg, self.x if x is None else x, self.t, self.z)


def opened(problem: LimitedOrbit, z: np.ndarray, i: int, place: float = 1.0) -> Opened:
    """An orbit taken apart on its leg i, by default at the end. z has shape (N + 1,)."""
    there = discretized(problem, z)
    states, lasting, start = starts_and_durations(there, z)
    t = float(there.starting_times(z)[i]) + place * lasting[i]
    return Opened(there, z, states, lasting, start, t, state_on_leg(there, z, i, place))


def starts_and_durations(problem: LimitedOrbit, z: np.ndarray) -> tuple[list[np.ndarray], list[float], float]:
    """Full states at the starts of the legs, durations, and when the first starts.

    States have shape (n,) each, z shape (N + 1,).
    """
    states = [
        passage.full(z[place]) for passage, place in zip(problem.passages, problem.layout.states, strict=True)
    ]
    return states, z[problem.layout.durations].tolist(), float(problem.starting_times(z)[0])


def starting_after(
    problem: LimitedOrbit,
    z: np.ndarray,
    itinerary: Itinerary,
    i: int,
    states: list[np.ndarray],
    lasting: list[float],
) -> tuple[Itinerary, list[np.ndarray], list[float]]:
    """What begins between events, as beginning right after the event that ends leg i: that leg comes last.

    The states have shape (n,) each, z shape (N + 1,).
    """
    symmetry = problem.system.symmetry(itinerary.image) if itinerary.image else None
    p, early = ParameterValues(**problem.values_of(z)), itinerary.legs[: i + 1]
    if symmetry is not None:
        early = tuple(imaged_leg(problem.system, itinerary.image, leg) for leg in early)
    legs = continued((*itinerary.legs[i + 1 :], *early))
    # The last leg goes on as the first one.
    given = [*states[i + 1 :], *(imaged(symmetry, x, p) for x in states[1 : i + 1])]
    joined = [*lasting[i + 1 : -1], lasting[-1] + lasting[0], *lasting[1 : i + 1]]
    return replace(itinerary, legs=legs), given, joined


def across_symmetry(problem: LimitedOrbit, z: np.ndarray, x: np.ndarray, i: int) -> np.ndarray:
    """What a state is, or was, on the other side of the symmetry that is applied at the end of leg i.

    The state has shape (n,), z shape (N + 1,).
    """
    name = problem.itinerary.image_at(i)
    symmetry = problem.system.symmetry(name) if name else None
    return imaged(symmetry, x, ParameterValues(**problem.values_of(z)))


def own_limit(problem: LimitedOrbit, i: int, test: str) -> Limit:
    """The limit of one test that the event which ends leg i has itself."""
    return next(
        o
        for o in problem.limits
        if o.leg == i and o.test == test and o.name == problem.itinerary.legs[i].name
    )


def minimum_of(problem: LimitedOrbit, i: int, transition: Transition) -> Limit:
    """The minimum on leg i of the guard of another transition."""
    return next(o for o in problem.limits if o.leg == i and o.test == "dip" and o.name == transition.name)


def alike(one: Transition, other: Transition) -> bool:
    """Whether two transitions are the same event out of different modes: they have the same guard."""
    return one.guard is other.guard or one.name == other.name


def falling_as(transition: Transition, like: Leg) -> bool:
    """Whether a transition's guard falls at the event that ends a leg."""
    return like.falls if transition.direction == "both" else transition.direction == "falling"
