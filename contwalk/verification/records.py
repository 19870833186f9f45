"""The equations of a stored record, read from its own words."""

from __future__ import annotations

import numpy as np

from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.signatures import is_iterated
from contwalk.system import System
from contwalk.verification.equations import Equations
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import CannotTell
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.solving import ROUGH


def problem_of(branch: Branch) -> str:
    """What the solutions of a branch are, or those that a curve in two parameters goes through."""
    return str(branch.info.settings.get("of_problem", branch.info.problem))


def of_orbits(branch: Branch) -> bool:
    """Whether they are orbits."""
    return problem_of(branch) in ORBITS


def method_of(branch: Branch) -> str:
    """How records are recomputed: nothing moves between two iterates of a map, which is only applied."""
    if not of_orbits(branch):
        return "Newton"
    return "iteration" if is_iterated(branch.info.signature) else "SciPy DOP853"


def equations_of(system: System, branch: Branch, place: int | SpecialPoint) -> Equations:
    """The equations of a special point, or of a row.

    Raises
    ------
    CannotTell
        If they are of a kind that is not recomputed.
    """
    point = place if isinstance(place, SpecialPoint) else None
    row = branch.points[place if isinstance(place, int) else place.index]
    unknowns = row["unknowns"][np.isfinite(row["unknowns"])]
    free = np.array(row["free"], dtype=float)
    if point is not None and point.unknowns:
        unknowns, free = np.array(point.unknowns[:-1]), free_of(branch, point)
    weights = row["weights"][np.isfinite(row["weights"])]
    if not of_orbits(branch):
        states, mode = len(branch.info.states), branch.info.settings.get("mode")
        there = np.zeros(states)
        own = list(system.states_of(str(mode or system.modes[0].name)))
        if len(weights) < len(own):
            raise CannotTell("The row does not tell its unknowns.")
        there[: len(own)] = unknowns[: len(own)]
        state = np.zeros(states)
        state[own] = unknowns[: len(own)] if len(own) < states else there
        equations: Equations = EquilibriumEquations(system, branch.info, state, free)
        equations.sizes = np.maximum(
            np.abs(equations.z), np.append(weights[: len(own)], _of_free(weights, free))
        )
        return equations
    period = float(row["period"] if point is None or point.period is None else point.period)
    own = unknowns[: len(unknowns) + 1 - len(free)]  # the other free parameter is the last one
    orbit = OrbitEquations(system, branch.info, own, period, free)
    mode = orbit.legs[0][0]
    first = list(system.states_of(mode))
    orbit.scale[first] = np.maximum(orbit.scale[first], weights[: len(first)])
    orbit.settle(ROUGH)
    orbit.sizes = np.concatenate(
        [
            *(
                orbit._scale(mode)
                for (mode, _), cuts in zip(orbit.legs, orbit.cuts, strict=True)
                for _ in range(cuts)
            ),
            np.full(len(orbit.drifts), float(np.max(orbit.scale)) / period),
            np.full(orbit.count + 1, period),
            np.maximum(np.abs(free), _of_free(weights, free)),
        ]
    )
    return orbit


def free_of(branch: Branch, point: SpecialPoint) -> np.ndarray:
    """Free parameters of a special point, (k,), as its unknowns have them: the first one last."""
    return np.array(point.unknowns[-1 : -1 - len(branch.info.free) : -1], dtype=float)


def _of_free(weights: np.ndarray, free: np.ndarray) -> np.ndarray:
    return np.array(weights[-1 : -1 - len(free) : -1])
