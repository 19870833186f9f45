"""The motion beside an orbit: displaced by one mode of what a closure does to small deviations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.problems.orbit.deviations import Deviations
from contwalk.system import System
from contwalk.workflow.stored.orbits import PICTURE, Orbit

# A state that moves less, in parts of what it is, does not move.
STILL = 1e-6


@dataclass(frozen=True, eq=False)
class DisplacedMotion:
    """A motion displaced by a mode.

    Parameters
    ----------
    states : ndarray, shape (k, n)
        At the instants of `motion_along`.
    number : int
        Of the mode.
    multiplier : complex
        Of one closure.
    amplitude : float
        The largest displacement at the start, in half the range of each state.
    """

    states: np.ndarray
    number: int
    multiplier: complex
    amplitude: float

    @property
    def words(self) -> str:
        """What is shown, in a few words."""
        value = self.multiplier
        text = f"{value.real:.4g}"
        if value.imag:
            text += f" {'+' if value.imag > 0.0 else '-'} {abs(value.imag):.4g}i, modulus {abs(value):.4g}"
        return f"mode {self.number}: multiplier {text}"


def displaced_along(
    system: System,
    branch: Branch,
    point: SpecialPoint | int,
    orbit: Orbit,
    states: np.ndarray,
    number: int,
    amplitude: float,
) -> DisplacedMotion:
    """The motion of an orbit displaced by a mode, x(t) + c Re J(t) v.

    J is the derivative of the motion by its start, at fixed time; v begins the mode, its largest part real
    and positive, and c is such that this one is `amplitude` at the start.

    Parameters
    ----------
    system : System
    branch : Branch
    point : SpecialPoint or int
        The one of the orbit.
    orbit : Orbit
    states : ndarray, shape (k, n)
        Its motion over whole periods, from `motion_along`.
    number : int
        Of the multiplier, 1 for the largest modulus.
    amplitude : float
        In half the range of each state over the orbit.

    Raises
    ------
    ContwalkError
        If there is no such mode, or no derivative of the motion.
    """
    if not math.isfinite(amplitude) or amplitude <= 0.0:
        raise ContwalkError(f"The amplitude {amplitude:g} shows no displacement.", "Give a positive number.")
    deviations = _deviations(system, branch, point)
    mode = deviations.mode(number)
    start, scale = deviations.full(mode.start), _half_ranges(orbit.states)
    largest = int(np.argmax(np.abs(start) / scale))
    mode = mode.times(amplitude * scale[largest] / start[largest])
    shares = _shares(orbit, deviations.rounds, deviations.legs)
    found: list[np.ndarray] = []
    d, closures = mode.start.real, 0
    while sum(len(part) for part in found) < len(states):
        which = closures % deviations.rounds
        segments = slice(which * deviations.legs, (which + 1) * deviations.legs)
        parts = deviations.closure(d, which, shares[segments])
        # Without an event, the first row of a round is the last one of the round before: `motion_along`.
        if found and which == 0 and not orbit.events:
            parts[0] = parts[0][1:]
        found += parts
        closures += 1
        d = mode.after(closures, deviations.after(d))
    return DisplacedMotion(states + np.concatenate(found), number, mode.multiplier, amplitude)


def _deviations(system: System, branch: Branch, point: SpecialPoint | int) -> Deviations:
    problem, sample = reopened(system, branch, point, PICTURE)
    return Deviations(problem, sample.z)  # type: ignore[arg-type]


def _half_ranges(states: np.ndarray) -> np.ndarray:
    """Half the range of each state; of one that does not move, its size, or one."""
    half, size = 0.5 * np.ptp(states, axis=0), np.abs(states).max(axis=0)
    return np.where(half > STILL * size, half, np.where(size > 0.0, size, 1.0))


def _shares(orbit: Orbit, rounds: int, segments: int) -> list[np.ndarray]:
    """Instants of the orbit's rows, 0 to 1 in each leg of all closures."""
    times = orbit.times
    if len(orbit.breaks) == rounds * segments - 1:
        parts = np.split(times, orbit.breaks)
        return [np.clip((part - part[0]) / ((part[-1] - part[0]) or 1.0), 0.0, 1.0) for part in parts]
    closures = rounds * (times - times[0]) / (times[-1] - times[0])  # where two meet, there is one row
    parts = np.split(closures, np.searchsorted(closures, np.arange(1, rounds) * (1.0 + 1e-9), side="right"))
    return [np.clip(part - k, 0.0, 1.0) for k, part in enumerate(parts)]
