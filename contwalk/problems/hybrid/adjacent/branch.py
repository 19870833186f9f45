"""The branch that leaves with an adjacent itinerary, facing the way in which its orbits are the machine's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import margin_values
from contwalk.problems.hybrid.adjacent.orbit import AdjacentOrbit, NoAdjacentOrbit, Undetermined
from contwalk.problems.hybrid.least_part import least
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.reasons_in_words import first_sentence, told_once
from contwalk.problems.hybrid.simulated_round import follows
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.problem import Seed
from contwalk.problems.solving import newton_on

# A state comes back to wherever it starts from if closing up tells this little of it.
STILL = 1e-9
# How far along the new branch its orbits are looked at, in the metric: the first that is admissible counts.
STEPS = (1e-3, 1e-4, 1e-2)
# The same where the equations are singular at the point: unstable orbits are to be found near it only.
NEARER = (1e-2, *STEPS[:2], 1e-5, 1e-6)


def seed_of(neighbour: AdjacentOrbit, label: str, words: str) -> Seed:
    """The branch of a neighbour, facing the way in which its orbits are the machine's.

    Raises
    ------
    NoAdjacentOrbit
    """
    if neighbour.tangent is not None:
        return _beside(neighbour, neighbour.tangent, label, words)
    rough, z = neighbour.problem, neighbour.z
    z = newton_on(rough, z, filled_magnitudes(rough, z))
    # Without its slowest event an orbit of many periods may be one of a single period.
    rough, z = least(rough, z)
    there = discretized(rough, z)
    weights = filled_magnitudes(there, z)
    _refuse_undetermined(there, z, weights)
    tangent = kernel_direction(there.linearize(z).jacobian, weights)
    way, _ = admissible(there, z, tangent, weights, words, STEPS)
    direction = way * tangent
    return Seed(label, z, direction, amplitude(direction), there.adapted_to(z, weights), one_sided=True)


def _beside(neighbour: AdjacentOrbit, tangent: np.ndarray, label: str, words: str) -> Seed:
    """The branch of a neighbour whose equations are singular at the limit itself: from an orbit beside it."""
    there, z = neighbour.problem, neighbour.z
    weights = filled_magnitudes(there, z)
    way, beside = admissible(there, z, tangent, weights, words, NEARER)
    rough = discretized(there, beside)
    weights = filled_magnitudes(rough, beside)
    direction = kernel_direction(rough.linearize(beside).jacobian, weights)
    direction *= np.sign(float(direction @ (way * tangent / weights**2))) or 1.0
    return Seed(label, beside, direction, amplitude(direction), rough.adapted_to(beside, weights))


def admissible(
    problem: Any,
    z: np.ndarray,
    tangent: np.ndarray,
    weights: np.ndarray,
    words: str,
    steps: Sequence[float],
    orbit_of: Callable[[np.ndarray], tuple[LimitedOrbit, np.ndarray]] | None = None,
) -> tuple[float, np.ndarray]:
    """The way along a tangent in which orbits are the machine's, 1 or -1, and the first of them seen there.

    All have the shape (N + 1,). `orbit_of` tells the orbit of a solution, and its unknowns, if the problem is
    a curve of orbits.

    Raises
    ------
    NoAdjacentOrbit
    """
    tried = []
    for way in (1.0, -1.0):
        for step in steps:
            beside = _looks(problem, z, way * tangent, weights, step, orbit_of)
            if not isinstance(beside, str):
                return way, beside
            tried.append(beside)
    raise NoAdjacentOrbit(
        f"orbits with signature {words} solve the equations there, but beside it {told_once(tried)}."
    )


def _refuse_undetermined(problem: LimitedOrbit, z: np.ndarray, weights: np.ndarray) -> None:
    """Refuse orbits without events in which a state closes up from wherever it starts.

    A mode that only keeps a state until it is left, as a contact does, says nothing of where it is.

    Raises
    ------
    Undetermined
    """
    if problem.itinerary.eventful or not problem.forced:
        return
    scaled = problem.linearize(z).jacobian / problem.equation_scales[:, None] * weights
    _, sizes, rows = np.linalg.svd(scaled)
    if sizes[-1] > STILL * sizes[0]:
        return
    place, passage = problem.layout.states[0], problem.passages[0]
    # Of the two directions of solutions, the one in which the parameter stays.
    one, other = rows[-2], rows[-1]
    kept = (one * other[-1] - other * one[-1])[place]
    name = problem.system.state_names[passage.states[int(np.argmax(np.abs(kept)))]]
    raise Undetermined(
        f"Beyond it the machine stays in mode '{problem.itinerary.legs[0].mode}' for ever, where '{name}' "
        f"comes back to whatever it starts from: at each {problem.free} there is a family of such orbits, "
        "and no branch to follow. Nothing to do."
    )


def _looks(
    problem: Any,
    z: np.ndarray,
    tangent: np.ndarray,
    weights: np.ndarray,
    step: float,
    orbit_of: Callable[[np.ndarray], tuple[LimitedOrbit, np.ndarray]] | None,
) -> np.ndarray | str:
    """The orbit a step along a direction, shape (N + 1,), or why it is not the machine's."""
    guess = z + step * tangent / float(np.linalg.norm(tangent / weights))
    normal = tangent / weights**2
    try:
        there = newton_on(problem, guess, weights, normal)
        margins = problem.margins(there)
        lost = [
            o
            for o, r in zip(margins.limits, margins.relative, strict=True)
            if r < -margin_values.ZERO and o.label != "AZ"
        ]
        if lost:
            return (
                f"'{lost[0].name}' ({lost[0].test}) is violated at {problem.free} = {float(there[-1]):.10g}"
            )
        followed = follows(*((problem, there) if orbit_of is None else orbit_of(there)))
    except (ContwalkError, np.linalg.LinAlgError) as error:
        return f"Newton's method fails ({first_sentence(str(error))})"
    return there if followed is None else f"a simulation goes another way: {first_sentence(followed)}"
