"""Orbits of a family of longer and longer periods, each held while the parameter is found.

Near a homoclinic orbit the parameter is worth less than the errors of a walk's steps, and arclength goes into
the way along the equilibrium. So these orbits are solved for on steps as fine as rounding allows, and in
units of what is left of the parameter's way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.solving import error_holding, newton_on
from contwalk.problems.problem import Sample

# Newton's method stagnates at rounding, which may be a large part of what is left of the parameter's way.
STAGNATES = 1e-2
# What is left of the parameter's way, relative to its magnitude, is no less than rounding.
ROUNDING = 1e-13
# How many orbits are asked for; each step in the period is longer than the last, or shorter where it failed,
# and so many that fail in a row are the end.
ORBITS, LONGER, SHORTER, LOST = 60, 1.5, 0.25, 3


@dataclass(frozen=True)
class HeldPeriod:
    """An orbit of a given period.

    Parameters
    ----------
    period : float
        In seconds.
    z : ndarray, shape (N + 1,)
        The orbit; its last entry is the parameter.
    rates : ndarray, shape (N + 1,)
        How it changes with the period, per second.
    error : float
        Of the parameter, by what errors of the steps make of it and what Newton's method has left.
    """

    period: float
    z: np.ndarray
    rates: np.ndarray
    error: float

    @property
    def slope(self) -> float:
        """d lambda / dT."""
        return float(self.rates[-1])


def longer_periods(problem: OrbitData, b: Sample, step: float, left: float) -> Iterator[HeldPeriod]:
    """The orbit of `b` on the finest steps, and orbits of longer periods while there are any.

    `step` is how much longer the next one lasts, `left` what is left of the parameter's way at b.
    """
    fine, place = _solved(lambda: problem.finest(b.z, b.weights), b.z, b.weights, left)
    lost = 0
    for _ in range(ORBITS):
        if place is None or fine is None:
            return
        if lost == 0:
            yield place
        guess = place.z + step * place.rates
        there, further = _solved(_on_finer_steps(fine, guess, b.weights), guess, b.weights, left)
        if further is None:
            lost, step = lost + 1, SHORTER * step
            if lost == LOST:
                return
            continue
        left *= min(abs(further.slope / place.slope), 1.0) if place.slope else 1.0
        fine, place, lost, step = there, further, 0, LONGER * step


def _on_finer_steps(problem: OrbitData, guess: np.ndarray, weights: np.ndarray) -> Callable[[], OrbitData]:
    """What makes the steps for a guess, in the section in which the family is a curve.

    Guess and weights have the shape (N + 1,).
    """
    return lambda: problem.refined(guess, weights, FINEST)


def _solved(
    on: Callable[[], OrbitData], guess: np.ndarray, weights: np.ndarray, left: float
) -> tuple[OrbitData | None, HeldPeriod | None]:
    """The orbit near a guess with the guess's period, if there is one that the machine can move on.

    Guess and weights have the shape (N + 1,).
    """
    # Of the parameter, what is left of its way counts.
    units = np.append(weights[:-1], max(abs(left), ROUNDING * float(weights[-1])))
    try:
        with np.errstate(all="ignore"):  # what overflows is no orbit
            problem = on()
            gradient = problem.duration_gradient(guess)
            z = newton_on(problem, guess, units, gradient, STAGNATES)
            here = problem.linearize(z)
            rates = here.tangent(gradient, units)
            rates = rates / float(gradient @ rates)
            left_over = here.bordered(gradient, units).solve(np.append(here.residual, 0.0))
            error = error_holding(problem, z, units, gradient) + abs(float(left_over[-1]))
            found = problem.admissible_at(z) and bool(np.all(np.isfinite(rates))) and np.isfinite(error)
    except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
        return None, None
    return (problem, HeldPeriod(problem.duration(z), z, rates, error)) if found else (None, None)
