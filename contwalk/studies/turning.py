"""Motions that do not come back because states turn that nobody has declared as angles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from contwalk.errors import StartError
from contwalk.problems.initial.recurrence import Simulation
from contwalk.studies.orbit_start import OrbitStart


def without_angles(start: OrbitStart, error: StartError) -> StartError:
    """What is told of a simulation that did not come back: that states turn, where they do; else the error.

    States turn that have gone on by more than two turns, if the field is the same a turn later, and another
    one between: along a direction in which nothing ever changes a motion drifts.
    """
    simulation = Simulation(start.system, start.values)
    x, weights = np.array(start.state, dtype=float), np.maximum(np.abs(start.state), 1.0)
    length = math.tau / max(float(np.abs(simulation.velocity(0.0, x)).max()), 1.0)
    for _ in range(10):  # a thousand times as long
        path = simulation.run(0.0, x, length, weights).path
        if path.status != "ok":
            return error
        gone, states = path.states[-1] - path.states[0], path.states
        turning = [k for k, way in enumerate(gone) if abs(way) > 2.0 * math.tau]
        free = [k for k in turning if simulation.states[k].period is None]
        if free and _repeats(simulation, states, free, gone):
            each = all(_repeats(simulation, states, [k], gone) for k in free)
            return _sentence([simulation.states[k].name for k in free], gone[free], each)
        length *= 2.0
    return error


def _repeats(simulation: Simulation, states: np.ndarray, turning: Sequence[int], gone: np.ndarray) -> bool:
    """Whether the field is the same where these states have gone on by a turn, and not by half of one."""
    way = np.zeros(len(gone))
    way[turning] = np.sign(gone[turning])
    same, changes = True, False
    for x in states[:: max(len(states) // 8, 1)]:
        now, half, later = (simulation.velocity(0.0, x + share * math.tau * way) for share in (0.0, 0.5, 1.0))
        # Sums of angles lose some digits, and so do functions of them.
        size = 1e-9 * (np.abs(now) + np.abs(later)).max()
        same = same and bool((np.abs(later - now) <= size).all())
        changes = changes or bool((np.abs(half - now) > size).any())
    return same and changes


def _sentence(names: Sequence[str], gone: np.ndarray, each: bool) -> StartError:
    ways = " and ".join(f"{name} by {way:.4g}" for name, way in zip(names, gone, strict=True))
    words = f"The simulation did not come back to where it was: it goes on turning, {ways}."
    if each:
        declared = ", ".join(f'State("{name}", period=2 * math.pi)' for name in names)
        return StartError(words, f"The field is the same a turn later: declare angles, {declared}.")
    first, *others = names
    signs = np.sign(gone[1:] * gone[0])
    sums = ", ".join(f"{n} {'-' if s > 0.0 else '+'} {first}" for n, s in zip(others, signs, strict=True))
    return StartError(
        f"{words} The field is the same only where {' and '.join(names)} go on by a turn together.",
        f'Declare one as an angle, State("{first}", period=2 * math.pi), and in place of {", ".join(others)} '
        f"write {sums}, without a period.",
    )
