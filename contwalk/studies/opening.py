"""The first solution of a branch, and which neutral directions must be held on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import outcomes
from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.opening import Opening
from contwalk.errors import NotFinite, PluginError
from contwalk.problems.equilibrium.equilibrium import Equilibrium, pins_at, solution_at
from contwalk.problems.equilibrium.held_by_force import forced, takes_force
from contwalk.problems.equilibrium.second_direction import second_direction
from contwalk.problems.neutral import constant
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends
from contwalk.problems.problem import Sample
from contwalk.studies.holding_sums import holding_sums
from contwalk.system import System

# How far from a start its branch is looked at, in arclength.
BESIDE = 1e-3


def opened(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    state: np.ndarray,
    settings: Settings,
    path: Ends | None = None,
    at: float | None = None,
    discretization: Discretization | None = None,
) -> Opening | Outcome:
    """The branch of equilibria through the solution near a state, or why there is none.

    Parameters
    ----------
    system : System
    parameters : mapping
        All parameters, the free one among them.
    free : str
        Name of the free parameter, or `path`.
    state : ndarray, shape (n,)
    path : tuple of two mappings, optional
        All parameters at both ends of a path.
    at : float, optional
        Position on the path.
    discretization : Discretization, optional
        Of the orbits that are born on the branch.
    """
    try:
        problem, z = solution_at(system, parameters, free, state, path, at, discretization)
        if free in system.conserved_names and free not in [pin.name for pin in problem.pins]:
            return not_begun.refused(
                f"An equilibrium has one value of '{free}', and is not continued along it.",
                "To follow orbits along it, start at one, with start: {simulate: {state: {...}}}, or "
                "continue the equilibrium along another parameter.",
            )
        begun = begin(problem, z, settings)
        if not isinstance(begun, ContinuationState):
            held = _with_sums_held(problem, z, settings)
            return held or not_begun.no_start(begun.reason, begun.sentence)
        if problem.pins and not _stays_neutral(problem, begun):
            # Neutral at the start only: along the branch it is not, and must not be held.
            problem = problem.with_pins(())
            begun = begin(problem, np.append(begun.sample.z[: problem.states], begun.sample.z[-1]), settings)
            if not isinstance(begun, ContinuationState):
                return not_begun.no_start(begun.reason, begun.sentence)
        return _alone(problem, begun, settings)
    except (PluginError, NotFinite) as error:
        return not_begun.no_start(error.reason, error.sentence)
    except np.linalg.LinAlgError as error:
        return not_begun.no_start(outcomes.reason_of(error), outcomes.singular(error))


def _stays_neutral(problem: Equilibrium, state: ContinuationState) -> bool:
    """Whether the pinned directions are still neutral a little along the branch, and held without force."""
    if _drifts(problem, state):
        return False
    for moved in _around(problem, state):
        n = problem.states
        matrix = problem.jacobian(moved.z)[:n, :n]
        return len(pins_at(problem, moved.z, matrix)) >= len(problem.pins)
    return True


def _around(problem: Equilibrium, state: ContinuationState) -> Iterator[Sample]:
    """Solutions a little along a branch, on both sides of its start, as far as there are any."""
    sample = state.sample
    for sign in (1.0, -1.0):
        guess = sample.z + sign * BESIDE * sample.tangent
        moved = correct(problem, guess, sample.tangent / sample.weights**2, sample.weights)
        if moved.ok:
            yield replace(sample, z=moved.z)


def _is_family(problem: Equilibrium, state: ContinuationState) -> bool:
    """Whether a direction that is held at a start is one of a family of equilibria, beside the start too."""
    return not _drifts(problem, state) and all(
        forced(problem, moved) is None for moved in _around(problem, state)
    )


def _drifts(problem: Equilibrium, state: ContinuationState) -> bool:
    """Whether holding the pinned directions takes a force, at the start or growing along the branch."""
    sample = state.sample
    return forced(problem, sample) is not None or takes_force(problem, sample.z, sample.tangent)


def _off_special(problem: Equilibrium, state: ContinuationState, settings: Settings) -> ContinuationState:
    """A start that is a fold or a Hopf point itself, moved a little along: walking back finds it."""
    sample = state.sample
    if not np.any(np.abs(sample.measures) <= 10.0 * sample.errors):
        return state
    for sign in (1.0, -1.0):
        guess = sample.z + sign * settings.step * sample.tangent
        moved = correct(problem, guess, sample.tangent / sample.weights**2, sample.weights)
        if moved.ok and settings.range[0] <= moved.z[-1] <= settings.range[1]:
            beside = begin(problem, moved.z, settings)
            if isinstance(beside, ContinuationState):
                return beside
    return state


def _degenerate(
    problem: Equilibrium, state: ContinuationState, generator: np.ndarray, settings: Settings
) -> Opening | Outcome:
    """A start with more than one direction of solutions: a branch point, or an undeclared neutral direction.

    The two are told apart a little way on: only a neutral direction is still there. Beside a branch point,
    the walk begins on the branch that the start's own state leads to.
    """
    for change in (1e-3, -1e-3):
        beside = _beside(problem, state.sample, change, settings)
        if beside is not None:
            return Opening(problem, beside)
    z, n = state.sample.z, problem.states
    summed = _with_sums_held(problem, z, settings, generator[:n])
    if summed is not None:
        return summed
    held = problem.with_pins((*problem.pins, constant(generator[:n])), z[:n])
    there = begin(held, np.concatenate([z[: problem.size], [0.0], z[-1:]]), settings)
    if isinstance(there, ContinuationState) and _is_family(held, there):
        return Opening(held, there, _report(problem, generator[:n]))
    return not_begun.no_start(
        "no_convergence",
        "an eigenvalue is zero there, but no branch could be followed from it and there is no family of "
        "equilibria either. More than two branches may meet there, or the solution is a multiple root, as "
        "x = a of (a - x)^3.",
    )


def _alone(problem: Equilibrium, state: ContinuationState, settings: Settings) -> Opening | Outcome:
    """The branch of a first solution that is alone at its parameter, or is made so."""
    direction = second_direction(problem, state.sample.z)
    if direction is None:
        return Opening(problem, _off_special(problem, state, settings))
    return _degenerate(problem, state, direction, settings)


def _with_sums_held(
    problem: Equilibrium, z: np.ndarray, settings: Settings, neutral: np.ndarray | None = None
) -> Opening | Outcome | None:
    """As `holding_sums`: the branch, or why there is none even so."""
    found = holding_sums(problem, z, settings, neutral)
    if found is None:
        return None
    held, state, report = found
    opening = _alone(held, state, settings)
    if isinstance(opening, Outcome):
        return opening
    return replace(opening, message=f"{report} {opening.message}".rstrip())


def _beside(
    problem: Equilibrium, sample: Sample, change: float, settings: Settings
) -> ContinuationState | None:
    """The start of a branch at a slightly different parameter, if the solution is isolated there."""
    z = sample.z.copy()
    z[-1] += change * sample.weights[-1]
    if not settings.range[0] <= z[-1] <= settings.range[1]:
        return None
    beside = begin(problem, z, settings)
    if not isinstance(beside, ContinuationState) or second_direction(problem, beside.sample.z) is not None:
        return None
    return beside


def _report(problem: Equilibrium, direction: np.ndarray) -> str:
    largest = np.argsort(-np.abs(direction))[:4]
    names = problem.system.state_names
    parts = ", ".join(f"{names[i]} {direction[i]:+.3g}" for i in largest if abs(direction[i]) > 1e-6)
    return (
        "An undeclared neutral direction: an eigenvalue is zero along the whole branch, "
        f"in the direction {parts}. It is held at its start and left out of the spectrum; "
        "declare it with neutral=(Neutral(...),) to say so."
    )
