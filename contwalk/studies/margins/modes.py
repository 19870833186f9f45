"""Pushes along the modes of a solution: small deviations that a closure only multiplies, at each instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.problems.orbit.deviations import Deviations
from contwalk.studies.margins.solution import ACCURATE, Instant, Solution
from contwalk.system import System

# An imaginary part that is smaller, in parts of the number, is none.
REAL = 1e-9


@dataclass(frozen=True, eq=False)
class ModeDirections:
    """A direction at each instant.

    Parameters
    ----------
    name : str
        `mode1`; of a pair of complex ones `mode1_re` and `mode1_im`, the parts of its deviation.
    vectors : tuple of ndarray, shape (n,)
        The largest part, in units of the states' magnitudes, is 1.
    """

    name: str
    vectors: tuple[np.ndarray, ...]


def mode_directions(
    system: System, branch: Branch, point: SpecialPoint | int, solution: Solution, count: int
) -> list[ModeDirections]:
    """The directions of the first modes of a solution, that of the largest multiplier or eigenvalue first.

    Raises
    ------
    ContwalkError
        If there are fewer.
    """
    with np.errstate(all="ignore"):
        problem: Any
        problem, sample = reopened(system, branch, point, ACCURATE)
        if branch.info.problem == "equilibrium":
            return _of_equilibrium(problem, sample, solution, count)
        return _of_orbit(problem, sample, solution, count)


def _of_equilibrium(problem: Any, sample: Any, solution: Solution, count: int) -> list[ModeDirections]:
    n = problem.states
    scale = solution.magnitudes
    matrix = problem.jacobian(sample.z)[:n, :n] * scale / scale[:, None]
    values, vectors = np.linalg.eig(matrix)
    order = np.lexsort((-values.imag, -values.real))
    _check_count(count, n, "eigenvalues")
    found: list[ModeDirections] = []
    for number, k in enumerate(order[:count], start=1):
        if values[k].imag >= 0.0:
            found += _parts(number, complex(values[k]), [vectors[:, k] * scale], scale)
    return found


def _of_orbit(problem: Any, sample: Any, solution: Solution, count: int) -> list[ModeDirections]:
    deviations = Deviations(problem, sample.z)
    found: list[ModeDirections] = []
    for number in range(1, count + 1):
        mode = deviations.mode(number)
        if mode.multiplier.imag < 0.0:  # the other one of a pair
            continue
        real, imaginary = (
            _along(deviations, part, solution.instants) for part in (mode.start.real, mode.start.imag)
        )
        vectors = [a + 1j * b for a, b in zip(real, imaginary, strict=True)]
        found += _parts(number, mode.multiplier, vectors, solution.magnitudes)
    return found


def _along(deviations: Deviations, start: np.ndarray, instants: tuple[Instant, ...]) -> list[np.ndarray]:
    """The deviation at each instant that begins as `start`."""
    if not start.any():
        return [np.zeros(len(instant.state)) for instant in instants]
    at = [np.array([i.share for i in instants if i.leg == leg]) for leg in range(deviations.legs)]
    legs = deviations.closure(start, 0, [part if len(part) else np.zeros(1) for part in at])
    seen = [0] * deviations.legs
    found = []
    for instant in instants:
        found.append(np.asarray(legs[instant.leg][seen[instant.leg]]))
        seen[instant.leg] += 1
    return found


def _parts(
    number: int, value: complex, vectors: list[np.ndarray], magnitudes: np.ndarray
) -> list[ModeDirections]:
    """One direction of a real mode, two of a complex one."""
    if abs(value.imag) <= REAL * abs(value):
        return [ModeDirections(f"mode{number}", _sized([v.real for v in vectors], magnitudes))]
    return [
        ModeDirections(f"mode{number}_re", _sized([v.real for v in vectors], magnitudes)),
        ModeDirections(f"mode{number}_im", _sized([v.imag for v in vectors], magnitudes)),
    ]


def _sized(vectors: list[np.ndarray], magnitudes: np.ndarray) -> tuple[np.ndarray, ...]:
    """Scaled so that the largest part is 1 and positive."""
    found = []
    for vector in vectors:
        shares = vector / magnitudes
        largest = shares[int(np.argmax(np.abs(shares)))]
        found.append(vector / largest if largest else vector)
    return tuple(found)


def _check_count(count: int, known: int, what: str) -> None:
    if count > known:
        raise ContwalkError(f"is {count}, and there are {known} {what}.", f"Allowed: up to {known}.")
