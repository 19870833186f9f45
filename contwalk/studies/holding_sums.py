"""Branches of equilibria along which sums of states stay what they are, where a field conserves any."""

from __future__ import annotations

import numpy as np

from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.problems.equilibrium.conserved_sums import conserved_sums
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.held_by_force import forced
from contwalk.problems.neutral import SUM, constant

# A sum's weights are a unit vector of a neutral direction to this factor of their size.
ALONG = 1.0 + 1e-9


def holding_sums(
    problem: Equilibrium, z: np.ndarray, settings: Settings, neutral: np.ndarray | None = None
) -> tuple[Equilibrium, ContinuationState, str] | None:
    """The problem in which sums of states stay what they are at a start z, shape (N + 1,), with its first
    solution and what is to be said, where the field conserves any that nobody declared.

    None where it does not, or where the one sum is a state that never moves and is the neutral direction,
    shape (n,), that is known.
    """
    sums = conserved_sums(problem, z) if not problem.pins else np.zeros((0, problem.states))
    if not len(sums):
        return None
    if neutral is not None and len(sums) == 1 and np.linalg.norm(sums[0]) <= ALONG * abs(sums[0] @ neutral):
        return None
    held = problem.with_pins([constant(weights, SUM) for weights in sums], z[: problem.states])
    there = begin(held, np.concatenate([z[: problem.states], np.zeros(len(sums)), z[-1:]]), settings)
    if not isinstance(there, ContinuationState) or forced(held, there.sample) is not None:
        return None
    return held, there, _report(problem, sums)


def _report(problem: Equilibrium, sums: np.ndarray) -> str:
    text = "; ".join(_text(weights, problem.system.state_names) for weights in sums)
    return (
        f"Conserved, and not declared: {text}. Each is held at what the start has of it, and its eigenvalue "
        "zero is left out of the spectrum; declare it with conserved=(Conserved(...),) to continue along it, "
        "or at another value."
    )


def _text(weights: np.ndarray, names: tuple[str, ...]) -> str:
    """As `a + 2 b - c`."""
    words = ""
    for i in np.flatnonzero(weights):
        size = abs(float(weights[i]))
        words += f" {'-' if weights[i] < 0.0 else '+'} {'' if size == 1.0 else f'{size:.6g} '}{names[i]}"
    return words.removeprefix(" + ").strip()
