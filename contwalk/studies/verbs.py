"""The verbs of the Python interface: continue a branch, switch at a branch point, iterate over points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk import quantities
from contwalk.branch import Branch, Outcome, SpecialPoint
from contwalk.continuation.kinds import kind_of
from contwalk.continuation.marks import observer_of
from contwalk.continuation.pseudo_arclength import Point, walk
from contwalk.continuation.settings import Mark, Settings
from contwalk.continuation.state import begin, turned
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram
from contwalk.diagram.events import Plan
from contwalk.diagram.opening import Opening
from contwalk.errors import StartError, interruptible
from contwalk.labels import MEANINGS
from contwalk.numerics.threads import each_on_one_thread, one_thread
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.problem import Problem
from contwalk.problems.restoring import problem_of
from contwalk.studies.opening import opened
from contwalk.system.declarations import nearest

if TYPE_CHECKING:  # compiled flows are imported only where orbits are computed
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

_DIRECTIONS = {"both": (1.0, -1.0), "forward": (1.0,), "backward": (-1.0,)}


@interruptible()
@one_thread()
def continue_branch(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit,
    state: str | Sequence[float] | Mapping[str, float],
    range: tuple[float, float] | None = None,
    direction: str = "both",
    marks: Mapping[str, Sequence[float | str]] | None = None,
    period: float | None = None,
    until: float | str | None = None,
    **settings: Any,
) -> Branch:
    """The branch of equilibria, or of periodic orbits, through the solution near a state.

    Parameters
    ----------
    problem : Equilibrium, PeriodicOrbit or HybridOrbit
        Orbits of a machine with events may be asked for as either: a `PeriodicOrbit` takes the events that
        the motion meets, a `HybridOrbit` names them.
    state : str, sequence or mapping
        A named equilibrium of the system, n numbers, or values by name.
    range : tuple of float
        Values of the free parameter at which the branch ends. By default the bounds that the plugin declares
        for it; along a path, 0 and 1.
    direction : str
        `both`, `forward` (growing parameter) or `backward`.
    marks : mapping, optional
        Name of the free parameter, of an observable, or `period`, to values, or the itinerary `extremum`.
    period : float, optional
        Of orbits: seconds from the state back to it, nearly. Needed unless the system is forced.
    until : float or "settled", optional
        Of orbits: simulate from the state first, and take the orbit that the motion settles on.
    **settings
        Further fields of `continuation.settings.Settings`, such as `max_points`.

    Raises
    ------
    StartError
        If no solution is found near the state.
    """
    chosen = _settings(problem, range, marks, settings)
    opening = _opened(problem, state, chosen, period, until)
    parameters = dict(opening.problem.line.parameters)
    start = Start(problem.system, problem.free, parameters, opening, "continue_branch")
    return _single(start, Plan(chosen, frozenset(), 0, direction_signs(direction)))


@interruptible()
@one_thread()
def switch_branch(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit,
    branch: Branch,
    point: str | SpecialPoint,
    range: tuple[float, float] | None = None,
    marks: Mapping[str, Sequence[float | str]] | None = None,
    **settings: Any,
) -> Branch:
    """The branch that leaves a special point: through a branch point, or born at HB or PD; both directions.

    Parameters
    ----------
    problem : Equilibrium, PeriodicOrbit or HybridOrbit
        The problem that `branch` belongs to.
    branch : Branch
    point : str or SpecialPoint
        A special point, as `BP1`.
    range, marks, **settings
        As for `continue_branch`.

    Raises
    ------
    StartError
        If no other branch leaves that point.
    """
    special = branch.special(point) if isinstance(point, str) else point
    pinned = [pin.name for pin in problem.pins]
    # Its orbits may close up to a symmetry, the given problem's fully; it may have found neutral directions.
    if branch.info.problem != "equilibrium" or pinned != list(branch.info.settings.get("pins", ())):
        state = np.array(list(special.state.values()))
        problem = problem_of(problem.system, branch.info, state, problem.discretization)
    kind = kind_of(problem, special)
    seed = None if kind is None else next(iter(kind.seeds(problem, special)), None)
    if seed is None:
        raise StartError(
            f"No other branch leaves {special.name} of {branch.name}.",
            f"Branches leave {_left(problem)}.",
        )
    # What is watched along the new branch: of cycles that are born at a Hopf point more than of equilibria.
    born: Any = seed.problem
    chosen = _settings(born, range, marks, settings, float(special.unknowns[-1]))
    begun = begin(seed.problem, seed.z, chosen, seed.tangent, seed.reach)
    opening = Opening(seed.problem, begun, one_sided=seed.one_sided)  # type: ignore[arg-type]  # a seed lies on the branch already
    parent = (branch.name, special.s)
    start = Start(problem.system, problem.free, dict(problem.parameters), opening, special.name, parent, 1, 1)
    return _single(start, Plan(chosen, frozenset(), 0))


def _left(problem: Problem) -> str:
    """The points that other branches leave, in words."""
    kinds = {kind.label: None for kind in problem.point_types if kind.daughters}
    *others, last = (f"{MEANINGS.get(label, 'point')}s ({label})" for label in kinds)
    return f"{', '.join(others)} and {last}" if others else last


def points(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit,
    state: str | Sequence[float] | Mapping[str, float],
    range: tuple[float, float] | None = None,
    forward: bool = True,
    period: float | None = None,
    until: float | str | None = None,
    **settings: Any,
) -> Iterator[Point]:
    """The bare iterator: solutions one by one, special points in their places, until the branch ends.

    Each `Point` has `state.sample` (z, eigenvalues, unstable, observables, ...) and `special`, the record of
    a special point or None.

    Parameters
    ----------
    problem, state, range, period, until, **settings
        As for `continue_branch`.
    forward : bool
        Whether it begins towards a growing parameter.
    """
    chosen = _settings(problem, range, None, settings)
    with one_thread():
        opening = _opened(problem, state, chosen, period, until)
    begun = opening.state if forward else turned(opening.state)
    yield Point(begun)
    observer = observer_of(problem)
    sign = 1.0 if forward else -1.0
    found = walk(opening.problem, begun, chosen, observer, sign, chosen.max_points - 1)
    for event in each_on_one_thread(found):
        if isinstance(event, Point):
            yield event


def _opened(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit,
    state: str | Sequence[float] | Mapping[str, float],
    settings: Settings,
    period: float | None,
    until: float | str | None,
) -> Opening:
    """The first solution of a branch.

    Raises
    ------
    StartError
        If there is none near the state.
    """
    x = _state(problem, state)
    given = problem.system, problem.parameters, problem.free, x, settings, problem.line.ends
    if isinstance(problem, Equilibrium):
        opening = opened(*given, discretization=problem.discretization)
    else:
        from contwalk.studies.opening_orbits import opened_orbit

        if period is None and until is None and problem.system.period is None:
            raise StartError(
                "An orbit of an autonomous system needs its period, or a simulation that finds it.",
                "Give period=SECONDS, or until='settled'.",
            )
        opening = opened_orbit(
            *given,
            discretization=problem.discretization,
            period=period,
            until=until,
            subharmonic=problem.subharmonic,
            pins=problem.pins or None,
        )
    if isinstance(opening, Outcome):
        raise StartError(opening.message)
    _check_events(problem, opening.problem)
    # The value of a conserved quantity is known now where it is the start's own.
    _check_within(problem.free, opening.state.sample.parameter, settings.range)
    return opening


def _check_events(problem: Problem, found: Problem) -> None:
    """Refuse a first solution with other events than the itinerary that was asked for."""
    if problem.kind != "hybrid_orbit":
        return
    asked, met = _events(problem), _events(found)
    if not any(met[i:] + met[:i] == asked for i in range(max(len(met), 1))):
        raise StartError(
            f"The solution near this state meets {', '.join(met) or 'no event'}, and "
            f"{', '.join(asked) or 'no event'} is asked for.",
            "Give a state whose motion meets these, or a PeriodicOrbit, which takes what the motion meets.",
        )


def _events(problem: Any) -> list[str]:
    """The events of a whole period, by name; an equilibrium has none."""
    itinerary = getattr(problem, "itinerary", None)
    legs = () if itinerary is None else itinerary.unfolded(problem.system).legs
    return [leg.name for leg in legs if leg.name]


def _check_within(name: str, value: float, range: tuple[float, float]) -> None:
    low, high = range
    if not low <= value <= high or not low < high:
        raise StartError(
            f"The start has {name} = {value:g}, the range is ({low:g}, {high:g}).",
            "Give the lower end first, and a range that contains the start.",
        )


def _single(start: Start, plan: Plan) -> Branch:
    diagram = Diagram([start], plan)
    for _ in diagram.events():
        pass
    return diagram.branches[0]


def _settings(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit,
    range: tuple[float, float] | None,
    marks: Mapping[str, Sequence[float | str]] | None,
    settings: dict[str, Any],
    start: float | None = None,
) -> Settings:
    chosen = marks_of(marks)
    known = [f.name for f in fields(Settings) if f.name not in ("range", "marks")]
    for name in settings:
        if name not in known:
            raise StartError(
                f"There is no setting '{name}'.", f"Known: {', '.join(known)}. {nearest(name, known)}".strip()
            )
    own = () if problem.meshed is None else (quantities.PERIOD,)
    watched = [problem.free, *problem.observable_names, *own]
    for name in (*[mark.name for mark in chosen], *settings.get("stop_at", {})):
        if not quantities.known(name, watched):
            raise StartError(
                f"'{name}' is not watched along the branch, so it cannot be marked.",
                f"Known: {', '.join(watched)}. {nearest(name, watched)}".strip(),
            )
    low, high = problem.line.range(problem.system) if range is None else (float(range[0]), float(range[1]))
    value = problem.parameters.get(problem.free, low) if start is None else start
    _check_within(problem.free, low if isnan(value) else value, (low, high))
    return Settings(range=(low, high), marks=chosen, **settings)


def marks_of(marks: Mapping[str, Sequence[float | str]] | None) -> tuple[Mark, ...]:
    """Marked values as the engine looks for them."""
    return tuple(
        Mark(name, tuple(float(v) for v in values if v != "extremum"), "extremum" in values)
        for name, values in (marks or {}).items()
    )


def direction_signs(direction: str) -> tuple[float, ...]:
    """The signs of arclength that a direction stands for.

    Raises
    ------
    StartError
        If there is no such direction.
    """
    if direction not in _DIRECTIONS:
        raise StartError(f"The direction is {direction!r}.", f"Allowed: {', '.join(_DIRECTIONS)}.")
    return _DIRECTIONS[direction]


def _state(
    problem: Equilibrium | PeriodicOrbit | HybridOrbit, state: str | Sequence[float] | Mapping[str, float]
) -> np.ndarray:
    if isinstance(state, str):
        return problem.system.named_states(state, problem.parameters)[0]
    if isinstance(state, Mapping):
        missing = [name for name in problem.system.state_names if name not in state]
        if missing:
            raise StartError(f"The state lacks {', '.join(missing)}.", "Give every state.")
        return np.array([float(state[name]) for name in problem.system.state_names])
    values = np.asarray(state, dtype=float)
    if values.shape != (problem.states,):
        raise StartError(
            f"The state has shape {values.shape}.",
            f"It must have {problem.states} entries: {', '.join(problem.system.state_names)}.",
        )
    return values
