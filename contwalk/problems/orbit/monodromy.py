"""Derivatives of an orbit's closure by its start, segment by segment, and its multipliers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.errors import called
from contwalk.problems import conserving
from contwalk.problems.orbit.multipliers import Multipliers, multipliers
from contwalk.problems.orbit.segmented_orbit import SegmentedOrbit
from contwalk.system.declarations import ParameterValues

# The flow's own multiplier, one, missed by more than this tells nothing of the others.
UNTOLD = 0.3


def neutral_directions(
    orbit: SegmentedOrbit, z: np.ndarray, factors: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """At the start of each segment, the directions whose multipliers are left out, shape (n, k)."""
    starts = orbit.starts(z)
    return _with_pins(orbit, z, starts, [] if orbit.forced else _flow_directions(orbit, z, factors))


def arriving_directions(
    orbit: SegmentedOrbit, z: np.ndarray, residual: np.ndarray
) -> list[np.ndarray] | None:
    """The same at the end of each segment, by the gaps of F(z); None for an orbit that is a point."""
    if not orbit.moves(z):
        return None
    starts = orbit.starts(z)
    gaps = residual[: starts.size].reshape(starts.shape)
    arriving = starts + np.roll(gaps, 1, axis=0)  # where each segment starts
    flow = orbit.solution(z).velocities_at(arriving)
    ends, flow = np.roll(arriving, -1, axis=0), np.roll(flow, -1, axis=0)
    return _with_pins(orbit, z, ends, [] if orbit.forced else list(flow))


def _with_pins(
    orbit: SegmentedOrbit, z: np.ndarray, states: np.ndarray, flow: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """At some states, the flow's directions, those that pins hold, and gradients of what is conserved,
    each of shape (n, k).
    """
    parameters = orbit.values_of(z)
    values, mode = ParameterValues(**parameters), orbit.system.modes[0].name
    result = []
    for i, x in enumerate(states):
        directions = list(flow[i : i + 1])
        for pin in orbit.pins:
            v = np.zeros(orbit.states)
            called(f"generator of '{pin.name}'", pin.generator, 0.0, x.copy(), values, v)
            directions.append(v)
        if orbit.system.conserved:
            gradients = conserving.gradients_of(orbit.system, mode, x, parameters)
            directions += list(conserving.raised(gradients, orbit.mesh.variation).T)
        result.append(np.array(directions).reshape(len(directions), orbit.states).T)
    return result


def _flow_directions(orbit: SegmentedOrbit, z: np.ndarray, factors: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Velocities at the starts of segments; of an orbit that is a point still, what it is to become."""
    assert orbit.section is not None
    found, magnitudes = list(orbit.solution(z).velocities), orbit.mesh.variation
    for segment, own in enumerate(found):
        if not np.linalg.norm(own / magnitudes) > 1e-9:
            found[segment] = orbit.section.normal * magnitudes**2
            for i in range(segment):
                found[segment] = factors[i] @ found[segment]
    return found


def spectrum(orbit: SegmentedOrbit, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
    """Multipliers of the closure without the flow's own and the pinned ones."""
    factors = orbit.factors(jacobian)
    neutral = neutral_directions(orbit, z, factors)
    arriving = arriving_directions(orbit, z, orbit.linearize(z).residual)
    gradients = len(orbit.system.conserved)
    return multipliers(
        factors, neutral, orbit.mesh.variation, orbit.mesh.tolerance, arriving, gradients=gradients
    )


def trivial_error(orbit: SegmentedOrbit, z: np.ndarray, jacobian: np.ndarray) -> float:
    """|M f - f| / |f|: how well the flow carries its own velocity once round; NaN where there is none.

    Of several segments, the worst one's: what one does to it may be undone by the next.
    """
    if orbit.forced or not orbit.moves(z):
        return float("nan")
    m, variation = orbit.mesh.segments, orbit.mesh.variation
    own = orbit.solution(z).velocities / variation
    sizes, worst = [float(np.linalg.norm(v)) for v in own], 0.0
    if 0.0 in sizes:
        return float("nan")
    for i, factor in enumerate(orbit.factors(jacobian)):
        missed = factor @ (own[i] * variation) / variation - own[(i + 1) % m]
        worst = max(worst, float(np.linalg.norm(missed)) / sizes[(i + 1) % m])
    return worst


def doubted(orbit: SegmentedOrbit, found: Multipliers, trivial: float, jacobian: np.ndarray) -> Multipliers:
    """Multipliers with what the trivial one misses by as an error, where that is no small part of it.

    The flow's direction then leaks into the others, with all that the closure lets grow.
    """
    if not trivial > UNTOLD:
        return found
    scaled = [f / orbit.mesh.variation[:, None] * orbit.mesh.variation for f in orbit.factors(jacobian)]
    return found.doubted(trivial * float(np.prod([np.linalg.norm(f, 2) for f in scaled])))
