"""What lies beyond the guard that an equilibrium reaches: an equilibrium of another mode, rest, or nothing.

Source: M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems,
Springer 2008, sections 5.1 to 5.3. With the guard's margin h, positive on the mode's side, and the branch
x(lambda) of the mode, dh/dlambda = h_lambda - h_x A^-1 f_lambda. Where the other field is zero at the point
as well, the equilibria of the other side have such a rate of their own. Where it is not, the machine is held
at the guard by a part alpha of a field, or of an impulse, w: f + alpha w = 0 and h = 0, so that
alpha h_x A^-1 w is the margin that the equilibrium beyond would have.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.errors import called
from contwalk.numerics.linear import EPSILON, norm_in
from contwalk.problems.equilibrium.boundaries import Boundary, boundaries_of, known, margins
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Seed
from contwalk.system.declarations import ParameterValues

# Equilibria of two modes are one point if they are so near in the metric: half of the digits.
ONE_POINT = EPSILON**0.5
PERSISTENCE, FOLD, REST = "persistence", "fold", "rest"


@dataclass(frozen=True)
class Beyond:
    """What is beyond a boundary.

    Parameters
    ----------
    kind : str, optional
        `persistence`, `fold` or `rest`; None where no sign tells.
    words : str
        The guard, and what is beyond: the end of a sentence.
    mode : str
        The other mode of which an equilibrium is there; empty where there is none.
    seed : Seed, optional
        Its branch.
    """

    kind: str | None
    words: str
    mode: str = ""
    seed: Seed | None = None


def beyond(problem: EquilibriumEquations, z: np.ndarray, weights: np.ndarray, boundary: Boundary) -> Beyond:
    """What is beyond a boundary that a solution lies on; z and the weights have the shape (N + 1,).

    Raises
    ------
    numpy.linalg.LinAlgError
        If the equations are singular there, as where a fold meets the guard.
    """
    own = boundary.rate(problem, z)
    guard = f"the guard of '{boundary.name}'"
    for name in _modes_beyond(problem, boundary):
        other = problem.in_mode(name)
        if not _is_equilibrium(other, z, weights):
            continue
        where = f"{guard}, beyond which the machine is in mode '{name}'"
        rates = _rates_at(other, z, weights)
        seed = _seed(other, z, weights, rates)
        if not rates:
            return Beyond(PERSISTENCE, f"{where}, of which it is an equilibrium as well.", name, seed)
        if own * min(rates) == 0.0:
            return Beyond(
                None, f"{where}, which it touches: on which side it is at rest is not known.", name, seed
            )
        # Both are the machine's on the same side of the parameter, or one on either side.
        kind = PERSISTENCE if own * min(rates) < 0.0 else FOLD
        goes_on = "it goes on" if kind == PERSISTENCE else "both equilibria end"
        return Beyond(kind, f"{where}: {goes_on} there.", name, seed)
    return _held(problem, z, boundary, guard)


def _modes_beyond(problem: EquilibriumEquations, boundary: Boundary) -> Iterator[str]:
    """Modes that the machine may be in beyond, with all states: the guard's own target first."""
    system = problem.system
    mode, target = system.modes[0].name, boundary.transition.target
    if not boundary.acts or boundary.transition.reset is not None:
        return
    reached = [target, *(t.target for t in system.leaving(target) if t.role != "watched")]
    for name in dict.fromkeys(reached):
        if name != mode and len(system.states_of(name)) == problem.states:
            yield name


def _is_equilibrium(other: EquilibriumEquations, z: np.ndarray, weights: np.ndarray) -> bool:
    """Whether a solution is one of another mode's equations: Newton's correction is none."""
    there = other.linearize(z)
    if not there.finite:
        return False
    try:
        step = np.linalg.solve(there.jacobian[:, :-1], there.residual)
    except np.linalg.LinAlgError:
        return bool(np.all(np.abs(there.residual) <= there.levels[0]))
    return norm_in(step, weights[:-1]) <= ONE_POINT


def _rates_at(other: EquilibriumEquations, z: np.ndarray, weights: np.ndarray) -> list[float]:
    """Rates of the margins of another mode that are zero at a solution."""
    there = boundaries_of(other.system)
    at = np.flatnonzero(np.abs(margins(other, there, z, weights)) <= ONE_POINT)
    return [there[k].rate(other, z) for k in at]


def _seed(other: EquilibriumEquations, z: np.ndarray, weights: np.ndarray, rates: list[float]) -> Seed:
    """The branch of another mode's equilibria, towards where they are the machine's."""
    jacobian = other.jacobian(z)
    n = other.size
    along = np.append(np.linalg.solve(jacobian[:, :n], -jacobian[:, n]), 1.0)
    towards = along if not rates or min(rates) > 0.0 else -along

    def reach(change: float) -> np.ndarray:
        return np.abs(along) * abs(change)

    return Seed("BE", z, towards, reach, other, one_sided=bool(rates))


def _held(problem: EquilibriumEquations, z: np.ndarray, boundary: Boundary, guard: str) -> Beyond:
    """What holds the machine at a guard: an impulse of its event, or the field on the other side."""
    if not boundary.acts:
        return Beyond(None, f"{guard}, which is watched: nothing happens there.")
    impulse = _impulse(problem, z, boundary)
    impacts = impulse is not None
    if impulse is None:
        impulse = _field_beyond(problem, z, boundary)
    if impulse is None:
        return Beyond(None, f"{guard}; what holds the machine there is not known.")
    n, gradient = problem.states, boundary.gradient(problem, z)
    pushed = problem.solve_states(z, impulse)
    share = known(float(gradient[:n] @ pushed), gradient[:n] * pushed)
    if share == 0.0:
        return Beyond(None, f"{guard}, which does not push it back: whether it stays there is not known.")
    stays = REST if impacts else PERSISTENCE
    if share < 0.0:
        how = "it comes to rest against it" if impacts else "it goes on between both fields"
        return Beyond(stays, f"{guard}: beyond, {how}.")
    return Beyond(FOLD, f"{guard}: no equilibrium is beyond, and both end there.")


def _impulse(problem: EquilibriumEquations, z: np.ndarray, boundary: Boundary) -> np.ndarray | None:
    """What the event changes the state by for each unit of the guard's rate, shape (n,); None without one.

    At rest that rate is zero, and the change is its limit: the derivative of the reset along the direction
    in which the rate grows most.
    """
    transition = boundary.transition
    reset = transition.reset
    if reset is None:
        return None
    n, p = problem.states, ParameterValues(**problem.values_of(z))
    x = z[:n]

    def after(state: np.ndarray) -> np.ndarray:
        found = state.copy()
        called(f"reset of '{transition.name}'", reset, 0.0, state.copy(), p, found)
        return found

    # The rate of the margin is h_x f, whose gradient at an equilibrium is h_x A.
    rate = boundary.gradient(problem, z)[:n] @ problem.jacobian(z)[:n, :n]
    size = float(rate @ rate)
    if not size > 0.0:
        return None
    arriving = -rate / size  # of rate -1
    step = (
        EPSILON ** (1.0 / 3.0)
        * (1.0 + float(np.max(np.abs(x))))
        / max(float(np.max(np.abs(arriving))), 1e-300)
    )
    change = (after(x + step * arriving) - after(x - step * arriving)) / (2.0 * step) - arriving
    kept = np.max(np.abs(after(x) - x)) <= ONE_POINT * (1.0 + np.max(np.abs(x)))
    return change if kept and np.isfinite(change).all() else None


def _field_beyond(problem: EquilibriumEquations, z: np.ndarray, boundary: Boundary) -> np.ndarray | None:
    """The field of the mode on the other side, shape (n,); None where it has other states."""
    target, system = boundary.transition.target, problem.system
    if boundary.transition.reset is not None or target == system.modes[0].name:
        return None
    if len(system.states_of(target)) != problem.states:
        return None
    field = problem.in_mode(target).linearize(z).residual[: problem.states]
    return field if np.isfinite(field).all() else None
