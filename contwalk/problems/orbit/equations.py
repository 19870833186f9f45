"""The equations of an orbit: what ends where the next one starts, guards, phase, period and
pins.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.discretization import SOLVED, STAGES
from contwalk.problems.orbit.layout import ClosureLayout, Segment
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.multipliers import GLOBAL
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.period import period_and_slope
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.orbit.section import Reference
from contwalk.problems.problem import Linearization
from contwalk.system import Neutral

# Numbers of a state's derivatives from which on several residuals take less time than they do.
DEAR = 256


def residual(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """F(z), shape (N,), for far less than with its derivatives."""
    residual = np.zeros(orbit.size)
    for segment, piece in zip(orbit.layout.segments, orbit.segments, strict=True):
        _match(orbit, segment, z, piece.end(PLAIN, *orbit.layout.inputs_of(segment, z)), residual)
    _closed(orbit, z, residual, np.zeros((orbit.size, orbit.size + 1)))
    orbit.effort.spend(STAGES[orbit.mesh.method] * sum(len(piece.steps) - 1 for piece in orbit.segments))
    return residual


def with_derivatives(orbit: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """F(z), DF(z), and the states at the steps of each segment.

    z has the shape (N + 1,), F (N,), DF (N, N + 1), states (s, n_i).
    """
    if orbit.forced and orbit.layout.sum is None:
        period_of(orbit, z)  # asked first: without a period there is no motion to tell of
    residual, jacobian = np.zeros(orbit.size), np.zeros((orbit.size, orbit.size + 1))
    nodes, ended, moved = orbit.passes(z)
    match = _match_in_closure if orbit.in_closure else _match_legs
    match(orbit, z, ended, moved, residual, jacobian)
    _closed(orbit, z, residual, jacobian)
    orbit.effort.spend(cost(orbit))
    return residual, jacobian, nodes


def _match_legs(
    orbit: OrbitData, z: np.ndarray, ended: Any, moved: Any, residual: np.ndarray, jacobian: np.ndarray
) -> None:
    """Write the equations of the ends of all segments, with their derivatives."""
    layout = orbit.layout
    for segment, end, derivatives in zip(layout.segments, ended, moved, strict=True):
        _match(orbit, segment, z, end, residual)
        rows, derivative = segment.ends, layout.along(segment, derivatives)
        n = rows.stop - rows.start
        jacobian[rows] += derivative[:n]
        jacobian[rows, segment.following] -= _identity(n)
        if len(end) > n:
            jacobian[layout.guards + segment.leg] = derivative[n]


def _match_in_closure(
    orbit: OrbitData, z: np.ndarray, ended: Any, moved: Any, residual: np.ndarray, jacobian: np.ndarray
) -> None:
    """As `_match_legs`, of the segments of one leg in times of the closure: they are alike."""
    layout, (m, n, _) = orbit.layout, moved.shape
    assert isinstance(layout, ClosureLayout)
    states, every = slice(0, m * n), np.arange(m)
    starts, left = z[states].reshape(m, n), residual[states].reshape(m, n)
    left[:-1], left[-1] = ended[:-1] - starts[1:], ended[-1] - starts[0]
    left[-1] -= orbit.turns
    blocks = blocks_of(jacobian, m, n)
    blocks[every, :, every] += moved[:, :, :n]
    blocks[every, :, (every + 1) % m] -= _identity(n)
    jacobian[states][:, layout.scalars] += moved[:, :, n:].reshape(m * n, -1)


def blocks_of(jacobian: np.ndarray, m: int, n: int) -> np.ndarray:
    """Derivatives of the ends of m segments by the starts of all, shape (m, n, m, n), as a view of DF."""
    return jacobian[: m * n, : m * n].reshape(m, n, m, n)


def _match(orbit: OrbitData, segment: Segment, z: np.ndarray, end: np.ndarray, residual: np.ndarray) -> None:
    """Write the equations of the end of a segment: it is the next one's start, and a leg's guard is zero
    there.
    """
    layout, rows = orbit.layout, segment.ends
    n = rows.stop - rows.start
    residual[rows] = end[:n] - z[segment.following]
    if segment.last and segment.leg == layout.legs - 1:
        residual[rows] -= orbit.turns[list(orbit.passages[0].states)]
    if len(end) > n:
        residual[layout.guards + segment.leg] = end[n]


def _closed(orbit: OrbitData, z: np.ndarray, residual: np.ndarray, jacobian: np.ndarray) -> None:
    """Write the equations of the closure, of phase or period and of pins, with their gradients."""
    layout = orbit.layout
    if not orbit.eventful and layout.phase is not None:
        residual[layout.phase] = phase(orbit, z, jacobian[layout.phase])
    if layout.sum is not None:
        period, slope = period_of(orbit, z)
        residual[layout.sum] = z[layout.durations].sum() - period
        jacobian[layout.sum, layout.durations] = 1.0
        jacobian[layout.sum, -1] = -slope
    for j, pin in enumerate(orbit.pins):
        residual[layout.held + j] = pinned(orbit, pin, z, jacobian[layout.held + j])
    if layout.times is not None:
        held = np.arange(layout.inside.start, layout.inside.stop)
        residual[held], jacobian[held, held] = z[held] - layout.times[1:], 1.0


def phase(orbit: OrbitData, z: np.ndarray, row: np.ndarray) -> float:
    """What fixes the phase where no event does; its gradient is written into `row`.

    z and the row have the shape (N + 1,).
    """
    if orbit.reference_orbit is not None:
        return _against(orbit, orbit.reference_orbit, z, row)
    if orbit.layout.start is not None:  # forced: it is looked at when the force begins its period
        row[orbit.layout.start] = 1.0
        return float(z[orbit.layout.start])
    assert orbit.section is not None
    row[orbit.layout.states[0]] = orbit.section.normal
    return orbit.section.residual(z[orbit.layout.states[0]])


def period_of(orbit: OrbitData, z: np.ndarray, lift: str = PLAIN, *directions: np.ndarray) -> Any:
    """Duration of the closure of a forced orbit, and its derivative by the free parameter.

    z has the shape (N + 1,).
    """
    own, direction = orbit.line.own, orbit.line.direction
    given = np.concatenate([orbit.line.constants, *directions])
    value, slope = period_and_slope(orbit.system, own, direction, float(z[-1]), given, lift)
    return orbit.forcings * value, orbit.forcings * slope


def _against(orbit: OrbitData, reference: Reference, z: np.ndarray, row: np.ndarray) -> float:
    """How far the phase is from the one nearest to another orbit, over the whole period."""
    total = 0.0
    given = zip(orbit.layout.segments, orbit.segments, reference.points, reference.rows, strict=True)
    for segment, piece, points, rows in given:
        x, moved = piece.along(*orbit.layout.inputs_of(segment, z))
        total += float(np.sum(rows * (x - points)))
        row += orbit.layout.along(segment, np.einsum("sn,snq->q", rows, moved)[None])[0]
    return total


def pinned(orbit: OrbitData, pin: Neutral, z: np.ndarray, row: np.ndarray) -> float:
    """Residual of a pinned direction, at the start of the first leg; its gradient is written
    into `row`.

    z and the row have the shape (N + 1,).
    """
    place = orbit.layout.states[0]
    normal, apart = orbit.held(pin, orbit.first_state(z), orbit.values_of(z))
    row[place] = normal[list(orbit.passages[0].states)]
    if pin.pin is not None and pin.value is not None:
        row[-1] = -orbit.line.slope(pin.value)
    return apart


def cost(orbit: OrbitData) -> int:
    """Right-hand sides of one pass with derivatives, each column counted as one."""
    return orbit.known.on(orbit.mesh, "cost", lambda: _cost(orbit))


def _cost(orbit: OrbitData) -> int:
    stages = STAGES[orbit.mesh.method]
    return sum(
        (len(piece.steps) - 1) * stages * (1 + len(piece.passage.states) + len(piece.passage.columns))
        for piece in orbit.segments
    )


def dear(orbit: OrbitData) -> bool:
    """Whether derivatives cost as much as several residuals: those of a small field cost little more."""
    sizes = [(len(piece.passage.states), len(piece.passage.columns)) for piece in orbit.segments]
    return any(n * (n + columns) >= DEAR for n, columns in sizes)


def levels(orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """What of each residual is rounding, or error of the steps.

    z has the shape (N + 1,), the jacobian (N, N + 1), the levels (N,).
    """
    steps = max(len(times) for times in orbit.mesh.steps)
    terms = np.abs(jacobian) @ np.abs(z)
    for segment in orbit.layout.segments:  # the identity may have cancelled in the Jacobian
        terms[segment.ends] += np.abs(z[segment.following])
    held = slice(orbit.layout.held, orbit.layout.held + len(orbit.pins))
    # A state that is held at zero is known to the rounding of what it is elsewhere.
    terms[held] += np.abs(jacobian[held, : orbit.size]) @ cycle_scales(orbit)[1]
    own = SOLVED * orbit.mesh.tolerance * orbit.equation_scales
    own[orbit.layout.exact] = 0.0
    return own + (8.0 + steps) * EPSILON * terms + 1e-300


def errors(orbit: OrbitData, linearization: Linearization) -> np.ndarray:
    """Estimated error of each equation: that of the steps, beside what it is solved to. Shape (N,)."""
    errors = linearization.levels[0].copy()
    steps = GLOBAL * orbit.mesh.amplified * orbit.mesh.tolerance * orbit.equation_scales
    steps[orbit.layout.exact] = 0.0
    return errors + steps


@cache
def _identity(n: int) -> np.ndarray:
    """The identity; never changed."""
    return np.eye(n)
