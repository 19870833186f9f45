"""Jumps of guards and resets that Newton's method hops across on its way from a first guess."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.problems.hybrid import end_maps
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.metric import beginnings

# Newton's full steps that are followed: further on they tell nothing of the guess.
STEPS = 4


def hops(problem: LimitedOrbit, guess: np.ndarray) -> str:
    """What jumps between a guess and where Newton's method leads from it, in a sentence; empty if nothing.

    Each of its steps is that of a smooth function: beyond a jump it may lead back, and so on.
    """
    z, weights, normal = guess, beginnings(problem, guess), np.zeros(len(guess))
    normal[-1] = 1.0
    for _ in range(STEPS):
        try:
            lin = problem.linearize(z)
            if not lin.finite:
                return ""
            there = z - lin.bordered(normal, weights).solve(np.append(lin.residual, 0.0))
        except (NotFinite, PluginError, np.linalg.LinAlgError):
            return ""
        jump = next((met.kink for met in end_maps.passed(problem, z, there) if met.kink.refused), None)
        if jump is not None:
            return (
                f"On Newton's way from the first guess {jump.of} jumps: {jump.where}. There may be no orbit "
                "of this itinerary on either side of it."
            )
        z = there
    return ""
