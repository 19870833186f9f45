"""Curves in two parameters from located special points of equilibria."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.locus.equilibrium_locus import CURVES, EquilibriumLocus, plane_of
from contwalk.system import Neutral, System


def locus_at(
    system: System,
    point: SpecialPoint,
    parameters: dict[str, float],
    free: tuple[str, str],
    pins: Sequence[Neutral] = (),
    discretization: Any = None,
) -> tuple[EquilibriumLocus, np.ndarray]:
    """The curve through a located fold or Hopf point of equilibria, and that point's z, shape (N + 1,).

    Parameters
    ----------
    system : System
    point : SpecialPoint
        An LP or HB point of a branch of equilibria.
    parameters : dict
        All parameters there.
    free : pair of str
        The two parameters.
    pins : sequence of Neutral
        Neutral directions pinned along the branch.
    discretization : Discretization, optional
        Of the orbits that are born on the branch.

    Raises
    ------
    StartError
        If no curve begins there.
    """
    if point.label not in CURVES or point.status != "located" or "pairs" in point.coefficients:
        raise StartError(
            f"No curve in two parameters can be followed from {point.name or point.label}.",
            "Start at a located fold (LP) or Hopf point (HB) of equilibria.",
        )
    n = len(system.states)
    state = np.array([point.state[name] for name in system.state_names])
    drifts = np.array(point.unknowns[n : n + len(pins)])
    plane = plane_of(system, parameters, free, pins, state, discretization)
    kappa = [float(point.coefficients["omega"]) ** 2] if point.label == "HB" else []
    values = [parameters[name] for name in reversed(free)]
    z = np.concatenate([state, drifts, kappa, values])
    return EquilibriumLocus(plane, point.label, z), z
