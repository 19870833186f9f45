"""Conditions solved beside equations, in the plane that the equations leave free.

Where F(z) = 0 has N independent equations of N + k unknowns, its solutions near a place are a sheet of k
dimensions. On it k conditions have a solution: the special point.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contwalk.numerics.linear import SMALLEST
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.finding import CannotTell
from contwalk.verification.passage import COARSER, EPSILON, TIGHT, CannotIntegrate

# A condition, of shape (), at a place; smooth near a solution.
Condition = Callable[[Evaluation], float]


@dataclass(frozen=True)
class Held:
    """A condition that a component of z along a direction keeps its value.

    Parameters
    ----------
    origin, gradient : ndarray, shape (N + k,)
    """

    origin: np.ndarray
    gradient: np.ndarray

    def __call__(self, at: Evaluation) -> float:
        return float(self.gradient @ (at.z - self.origin))


# Steps of this size are as long as differences need; a singular value below this part of the largest is zero.
ROUGH = EPSILON**0.5


@dataclass(frozen=True)
class Solution:
    """Where equations and conditions hold.

    Parameters
    ----------
    at : Evaluation
    moved, error : ndarray, shape (N + k,)
        From the record's place, and how exactly that is known.
    spread : ndarray, shape (r,)
        How exactly the eigenvalues of the spectrum are known.
    first : ndarray, shape (N + k,)
        The first Newton step: where the record's own place says that the solution is.
    """

    at: Evaluation
    moved: np.ndarray
    error: np.ndarray
    spread: np.ndarray
    first: np.ndarray


class Sheet:
    """The solutions of some equations near the record's place, to first order.

    Parameters
    ----------
    equations : Equations
    relative : float
        The coarser tolerance of motions; by default the tightest but one.

    Raises
    ------
    CannotTell
        If the equations are not independent there.
    """

    def __init__(self, equations: Equations, relative: float = COARSER * TIGHT) -> None:
        self.equations, self.relative = equations, relative
        self.begin = equations.at(equations.z, relative)
        left, values, right = np.linalg.svd(self.begin.jacobian * equations.sizes)
        self.free = len(equations.free)
        rank = equations.rank
        if values[rank - 1] < ROUGH * values[0]:
            raise CannotTell("The equations have several solutions there, one beside the other.")
        self.left = left[:, :rank].T
        self.along = equations.sizes[:, None] * right[rank:].T

    def rounding(self, at: Evaluation) -> np.ndarray:
        """How far rounding of the equations carries their solution, shape (N + k,)."""
        rows = np.vstack([self.left @ at.jacobian, np.linalg.pinv(self.along)])
        level = np.abs(self.left) @ self.equations.rounded(at)
        return np.asarray(np.abs(np.linalg.inv(rows))[:, : len(level)] @ level)

    def square(self, at: Evaluation) -> np.ndarray:
        """The independent equations' derivatives by the unknowns, shape (N, N)."""
        return np.asarray(self.left @ at.jacobian[:, : self.equations.size])

    def towards(self, at: Evaluation) -> np.ndarray:
        """The Newton step onto the sheet, shape (N + k,)."""
        rows = np.vstack([self.left @ at.jacobian, np.linalg.pinv(self.along)])
        right = np.concatenate([-(self.left @ at.residual), np.zeros(self.along.shape[1])])
        return np.asarray(np.linalg.solve(rows, right))


def solved(sheet: Sheet, conditions: list[Condition]) -> Solution:
    """The place where the conditions are zero, at two tolerances: the tightest at which motions are followed.

    Raises
    ------
    CannotTell
        If Newton's method does not get there.
    """
    try:
        return _solved(sheet, conditions, sheet.relative)
    except CannotIntegrate:
        return _solved(sheet, conditions, COARSER * sheet.relative)


def _solved(sheet: Sheet, conditions: list[Condition], relative: float) -> Solution:
    """As `solved`, at a tolerance and a tighter one."""
    equations, values = sheet.equations, _values(conditions, sheet.begin)
    gradients = _gradients(sheet, conditions, values)
    slopes = gradients @ sheet.along
    if not np.isfinite(slopes).all():
        raise CannotTell("What defines the point has no value beside it.")
    if np.linalg.matrix_rank(slopes) < slopes.shape[1]:
        if np.max(np.abs(values)) > ROUGH:
            raise NotThere(np.full(len(equations.z), np.inf))
        raise CannotTell("What defines the point does not change along the branch there.")
    finer = relative / COARSER
    try:
        coarse, first, gradients = _newton(sheet, conditions, sheet.begin, gradients, relative)
        # Of equilibria only rounding differs: the second time they are solved from elsewhere.
        begin = coarse.z if equations.unit else coarse.z + (coarse.z - equations.z)
        fine, _, _ = _newton(sheet, conditions, equations.at(begin, finer), gradients, finer)
    except NotThere as failure:
        again = _values(conditions, equations.at(equations.z, finer)) - values
        failure.noise = np.abs(sheet.along @ np.linalg.lstsq(slopes, again, rcond=None)[0])
        raise
    error = np.abs(fine.z - coarse.z) + np.spacing(np.abs(fine.z))
    if not _held(conditions):  # what the tolerance makes of the conditions themselves
        again = _values(conditions, equations.at(fine.z, relative))
        error = np.maximum(error, np.abs(sheet.along @ np.linalg.lstsq(slopes, again, rcond=None)[0]))
    if equations.unit:  # errors of steps that both motions have in common add up to a few tolerances
        error += relative * equations.sizes
    else:
        error += sheet.rounding(fine)
    spread = np.array([])
    if np.isfinite(fine.matrix).all():
        spread = rounded_eigenvalues(fine.matrix)
        if np.isfinite(coarse.matrix).all():
            spread += [_nearest(coarse.spectrum, value) for value in fine.spectrum]
        else:  # one of both motions only touches an event
            spread += np.inf
    return Solution(fine, fine.z - equations.z, error, spread, first)


def _held(conditions: list[Condition]) -> bool:
    return all(isinstance(each, Held) for each in conditions)


def _gradients(sheet: Sheet, conditions: list[Condition], values: np.ndarray) -> np.ndarray:
    """Derivatives of the conditions, shape (c, N + k): unless known, along the sheet alone."""
    if _held(conditions):
        return np.array([each.gradient for each in conditions if isinstance(each, Held)])
    equations, slopes = sheet.equations, np.zeros((len(values), sheet.along.shape[1]))
    for i, direction in enumerate(sheet.along.T):
        step = ROUGH / float(np.max(np.abs(direction / equations.sizes)))
        ahead = equations.at(equations.z + step * direction, sheet.relative)
        slopes[:, i] = (_values(conditions, ahead) - values) / step
    return np.asarray(slopes @ np.linalg.pinv(sheet.along))


def _newton(
    sheet: Sheet, conditions: list[Condition], at: Evaluation, gradients: np.ndarray, relative: float
) -> tuple[Evaluation, np.ndarray, np.ndarray]:
    """Newton's method onto the sheet, with Broyden's updates of the conditions' gradients, (c, N + k).

    The solution, the first step, and the gradients. What is seen of them on a way onto the sheet is no slope
    along it.
    """
    equations, sizes = sheet.equations, sheet.equations.sizes
    known = relative if equations.unit else 4.0 * EPSILON  # below it lies what tolerances make of it
    first, before, size, stalls = np.full(len(at.z), np.inf), None, np.inf, 0
    for _ in range(12):
        onto, values = sheet.towards(at), _values(conditions, at)
        if before is not None and size > ROUGH:  # shorter steps would teach rounding
            moved, gained = before
            square = max(float(moved @ moved), SMALLEST)
            off = values - gained - gradients @ (moved * sizes)
            gradients = gradients + np.outer(off, moved / sizes) / square
        left = values + gradients @ onto
        whole = onto - sheet.along @ np.linalg.lstsq(gradients @ sheet.along, left, rcond=None)[0]
        first = first if np.isfinite(first[0]) else whole
        now = float(np.max(np.abs(whole / sizes)))
        # A first step onto the sheet changes the conditions as well, so that one step gains nothing.
        stalls += now > 0.5 * size and size < ROUGH
        if now < known or stalls > (now > ROUGH * ROUGH**0.5):
            return at, first, gradients
        if not now < 1.0:  # as far as things are large
            break
        size, before = now, (whole / sizes, values)
        try:
            at = equations.at(at.z + whole, relative)
        except CannotIntegrate:
            break
    if size < ROUGH:
        return at, first, gradients
    raise NotThere(first)


class NotThere(CannotTell):
    """Newton's method from the record's place does not converge.

    `first`, (N + k,), is its first step, and `noise`, (N + k,), what tolerances make of that.
    """

    def __init__(self, first: np.ndarray) -> None:
        super().__init__("Newton's method from the stored point does not converge.")
        self.first, self.noise = first, np.zeros(len(first))


def _values(conditions: list[Condition], at: Evaluation) -> np.ndarray:
    return np.array([condition(at) for condition in conditions])


def rounded_eigenvalues(matrix: np.ndarray) -> np.ndarray:
    """How exactly rounding of a matrix, (r, r), leaves its eigenvalues known, in the order of `eigvals`.

    One that is double, with one vector, is known to the root of a rounding.
    """
    from scipy.linalg import eig

    if not len(matrix):
        return np.zeros(0)
    size = float(np.linalg.norm(matrix, 2))
    _, left, right = eig(matrix, left=True, right=True)  # vectors of length one
    with np.errstate(divide="ignore"):  # vectors of a defective matrix are at right angles
        conditions = 1.0 / np.abs(np.sum(left.conj() * right, axis=0))
    return np.asarray(EPSILON * size * np.minimum(conditions, EPSILON**-0.5))


def _nearest(values: np.ndarray, value: complex) -> float:
    return float(np.min(np.abs(values - value)))
