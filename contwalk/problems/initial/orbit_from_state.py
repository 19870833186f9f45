"""The problem and the vector of unknowns that belong to a state on, or near, a periodic orbit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.flow.method import choose
from contwalk.flow.path import ErrorControl
from contwalk.problems import neutral as neutrals
from contwalk.problems.conserving import with_own_values
from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid import families
from contwalk.problems.initial.magnitudes import magnitudes_on
from contwalk.problems.orbit.asymmetry import apart, state_at
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.cutting import first_cuts
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.own_image import OWN_IMAGE, carries
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.orbit.shooting import Mesh, arrived, velocity
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

# A direction is neutral if it is so at a parameter that differs by this part of itself too.
BESIDE = 1e-3

# Tolerance of the first look at a motion.
ROUGH = 1e-7


def orbit_at(
    system: System,
    line: ParameterLine,
    at: float | None,
    state: np.ndarray,
    period: float | None,
    discretization: Discretization | None = None,
    subharmonic: int = 1,
    pins: Sequence[Neutral] | None = None,
) -> tuple[PeriodicOrbit, np.ndarray]:
    """The problem of the orbit through a state, discretised for it, and its unknowns; not yet a solution.

    Parameters
    ----------
    line, at
        The line of parameters, and the place on it; by default that of the point that it was made from.
    state : ndarray, shape (n,)
    period : float or None
        Seconds; None for a forced system, whose own period it is. A multiple of that makes a subharmonic.
    subharmonic : int
        Periods of a forced system that the orbit lasts, where `period` does not tell.
    pins : sequence of Neutral, optional
        Neutral directions to hold; by default those of the system that are neutral there.

    Raises
    ------
    NotFinite
        If the motion from the state ends within one period.
    """
    x = np.asarray(state, dtype=float)
    line = started(system, line, at, x, system.modes[0].name)
    value = line.place(at)
    if system.period is not None:
        own = period_at(system, line.at(value))
        subharmonic = subharmonic if period is None else max(round(period / own), 1)
    if pins is None:
        pins = _neutral(system, line, value, x)
    problem = PeriodicOrbit(
        system,
        line.parameters,
        line.free,
        line.ends,
        pins=pins,
        reference=x,
        subharmonic=subharmonic,
        discretization=discretization,
    )
    durations = [] if problem.forced else [float(period or 0.0)]
    scalars = np.array([*durations, *[0.0] * len(pins), value])
    values = np.concatenate([scalars, problem.line.constants])
    _check_moves(problem, x, values)
    turns, mesh = _once_round(problem, x, values)
    z = np.concatenate([x, scalars])
    return cut(problem.closing(turns).on(mesh, None), z, mesh.magnitudes)


def started(system: System, line: ParameterLine, at: float | None, x: np.ndarray, mode: str) -> ParameterLine:
    """The line with a start's own values of conserved quantities, where no others are given.

    x is the state of the start, shape (n,).
    """
    if not system.conserved:
        return line
    own = with_own_values(system, line.at(line.place(at)), x, mode)
    return line.filled({name: own[name] for name in system.conserved_names})


def _neutral(system: System, line: ParameterLine, at: float, x: np.ndarray) -> list[Neutral]:
    """The declared directions that motions through a state come in families along, beside it as well.

    One that is neutral at a start only is none of the branch.
    """
    if not system.neutral:
        return []
    parameters = line.at(at)
    beside = dict(parameters)
    for name in line.moving_names:
        beside[name] += BESIDE * (abs(beside[name]) or 1.0)
    scale = np.maximum(np.abs(x), float(np.abs(x).max()) or 1.0)
    machines = [hybrid_machine(system, values) for values in (parameters, beside)]
    mode, found = system.modes[0].name, list[Neutral]()
    for neutral in system.neutral:
        if not all(families.commutes(machine, neutral, mode, 0.0, x, scale) for machine in machines):
            continue
        together = neutrals.directions(system, [*found, neutral], x, parameters)
        sizes = np.linalg.svd(together / scale[:, None], compute_uv=False)
        if sizes[-1] > families.DEPENDENT * sizes[0]:
            found.append(neutral)
    return found


def _check_moves(problem: PeriodicOrbit, x: np.ndarray, values: np.ndarray) -> None:
    """An autonomous system's orbit does not begin at an equilibrium.

    Raises
    ------
    StartError
        If the field vanishes at the state.
    """
    if not problem.forced and not np.any(velocity(problem.passages[0], x, 0.0, values)):
        raise StartError(
            "The field is zero at the start: an equilibrium, which is no periodic orbit.",
            "Start at another state, or continue the equilibrium with start: {state: {...}}.",
        )


def _once_round(problem: PeriodicOrbit, x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, Mesh]:
    """By how much angles grow in one period, in whole turns, and the steps of a first look at the motion."""
    field = problem.passages[0].field(PLAIN)
    largest = float(np.abs(x).max())
    size = np.maximum(np.abs(x), 1e-3 * largest if largest > 0.0 else 1.0)
    choice = choose(field, field.constants(values), 0.0, x, 1.0, ErrorControl(ROUGH, size))
    path = arrived(choice.path, problem.passages[0], values)
    own = np.array([s.period or 0.0 for s in problem.system.states])
    grown = path.states[-1] - path.states[0]
    turns = np.where(own > 0.0, np.round(np.divide(grown, own, out=np.zeros_like(grown), where=own > 0)), 0.0)
    ranges = magnitudes_on(problem.system.states, path.states, ROUGH)
    return turns * own, Mesh((path.times,), choice.method, ROUGH, ranges, ranges)


def cut(problem: PeriodicOrbit, z: np.ndarray, magnitudes: np.ndarray) -> tuple[PeriodicOrbit, np.ndarray]:
    """The same orbit in as many segments as the growth of deviations asks for; `problem` has one.

    z has the shape (N + 1,); `magnitudes` are those of the states, shape (n,).
    """
    cuts, n = first_cuts(problem, z), problem.states
    m = len(cuts)
    # On the problem's own steps: where deviations grow that much, other steps lead elsewhere.
    there = problem.layout.joined(problem.view(z)[0].at(cuts), z[n:], cuts)
    weights = problem.layout.joined(np.tile(magnitudes * np.sqrt(m), m), np.abs(z[n:]), 1.0)
    return problem.adapted_to(there, weights), there


def symmetric(
    problem: PeriodicOrbit, z: np.ndarray, weights: np.ndarray
) -> tuple[PeriodicOrbit, np.ndarray] | None:
    """The same orbit closed up to a spatial symmetry that it has, so that a part of it is integrated.

    None where it has none. `z` is a solution that closes fully; it and the weights have the shape (N + 1,).
    """
    n, p = problem.states, ParameterValues(**problem.values_of(z))
    x = problem.starts(z)[0]
    for symmetry in problem.system.symmetries:
        order = order_of(symmetry, x, p)
        if symmetry.role != "spatial" or order is None or order < 2 or np.any(problem.turns):
            continue
        later = state_at(problem, z, 1.0 / order)
        for power in range(1, order):
            image = imaged(symmetry, later, p, power)
            if apart(problem, z, image) > OWN_IMAGE or not carries(problem, z, symmetry, power, 1.0 / order):
                continue
            other = problem.closing(np.zeros(n), symmetry.name, power, order)
            scalars = problem.scalars(z).copy()
            scalars[:-1] /= order  # period and drifts
            part = np.concatenate([x, scalars])
            single = np.concatenate([weights[:n] / np.sqrt(problem.mesh.segments), np.abs(scalars)])
            return cut(other.adapted_to(part, single), part, single[:n])
    return None
