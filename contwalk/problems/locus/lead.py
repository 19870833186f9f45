"""How far other eigenvalues are ahead of the largest real part that is marked along a contour."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.numerics.spectrum import taken_out


def lead_of_others(problem: Any, z: np.ndarray, eigenvalues: np.ndarray) -> tuple[float, ...]:
    """How far other eigenvalues are ahead of what is marked, and a pair past being two real ones.

    Both are negative along the contour, and pass zero at its corners. None where no real part is marked. z
    has the shape (N + 1,), eigenvalues (n,).
    """
    level = problem.curve.real_part
    if level is None:
        return ()
    kappa, (others, moved) = problem.kappa(z), apart(problem, z, eigenvalues)
    # Where two are equal each is known to the root of rounding, and their sum to rounding.
    ahead = float(np.max(others.real, initial=-np.inf)) - level + moved
    return (ahead, -kappa) if problem.curve.pair else (ahead,)


def apart(problem: Any, z: np.ndarray, eigenvalues: np.ndarray) -> tuple[np.ndarray, float]:
    """All eigenvalues but those that have the value, and by how much these are computed beside it.

    z has the shape (N + 1,), eigenvalues (n,).
    """
    level, kappa = problem.curve.real_part, problem.kappa(z)
    own = np.array([1j, -1j]) * np.sqrt(complex(kappa)) if problem.curve.pair else np.zeros(1)
    kept, taken = taken_out(eigenvalues, level + own)
    return eigenvalues[kept], float(np.sum(eigenvalues[taken].real - level))
