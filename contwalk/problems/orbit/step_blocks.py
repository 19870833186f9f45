"""Derivatives of an orbit's own steps, and of blocks of them: what multipliers are made of, and cuts.

Over a segment deviations may decay by any factor, and what is left of them drowns in the rounding of what has
not decayed. Where they grow again later, as on a canard, so does this noise. Over a block of steps they
neither grow nor decay by much: the multipliers, from the periodic Schur form of the blocks, have their own
relative accuracy. An explicit method's steps along what attracts strongly are as long as its stability
allows, right for the orbit, and for deviations wrong by any factor: for multipliers they are taken in parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk import flow
from contwalk.problems import conserving
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.discretization import STAGES
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.multipliers import Multipliers, multipliers

# Growth, and decay, over a block of steps at most, as far as the norms of steps tell.
GROWN, DECAYED = 1e3, 1e4
# For multipliers each step is taken in so many parts.
PARTS = 4
# Where a step alone does not converge: in how many parts it is tried.
ALONE = (1, 2, 4, 16)


@dataclass(frozen=True, eq=False)
class Steps:
    """All steps of an orbit, in their order.

    Parameters
    ----------
    begins, ends : ndarray, shape (s,)
        Times in 0..1 of the closure.
    starts, arrived : ndarray, shape (s, n)
        States at both ends of each; the closure is applied to the last end.
    factors : ndarray, shape (s, n, n)
        Derivative of each end by its start, in units of the states' variation.
    """

    begins: np.ndarray
    ends: np.ndarray
    starts: np.ndarray
    arrived: np.ndarray
    factors: np.ndarray

    def begun(self, first: int) -> Steps:
        """The same in the order from one of them on; times count on beyond the closure's end."""
        late = np.where(np.arange(len(self.begins)) < first, 1.0, 0.0)
        rolled = (np.roll(each, -first, axis=0) for each in (self.starts, self.arrived, self.factors))
        return Steps(np.roll(self.begins + late, -first), np.roll(self.ends + late, -first), *rolled)


def steps_of(orbit: DiscretizedOrbit, z: np.ndarray) -> Steps:
    """The steps of the orbit of z, of which all are taken in one pass. z has the shape (N + 1,)."""
    return orbit.known.at("steps", z, 2, lambda: _finite(orbit, z))


def _finite(orbit: DiscretizedOrbit, z: np.ndarray) -> Steps:
    """The steps, in as many parts as an implicit method needs that begins each of them anew.

    Along the orbit it begins a step with what it knows from the one before; alone, a step as long may not
    converge.
    """
    for parts in ALONE:
        steps = _taken(orbit, z, parts)
        if np.isfinite(steps.factors).all():
            break
    return steps


def _taken(orbit: DiscretizedOrbit, z: np.ndarray, parts: int = 1) -> Steps:
    """The steps of the orbit of z, each taken in so many parts."""
    mesh, n, values = orbit.mesh, orbit.states, orbit.given(z)
    nodes, own = orbit.view(z)[0].nodes, np.flatnonzero(np.diff(mesh.times) > 0.0)
    begins, ends = mesh.times[own], mesh.times[own + 1]
    field = orbit.passages[0].field(PLAIN)
    times = begins[:, None] + (ends - begins)[:, None] * (np.arange(parts + 1) / parts)
    times[:, -1] = ends
    states, moved = flow.along_with_tangents(
        field, field.constants(values), times.ravel(), nodes[own], np.eye(n), np.full(n, -1), mesh.method
    )
    arrived = states[parts :: parts + 1].copy()
    orbit.effort.spend(STAGES[mesh.method] * (1 + n) * len(own) * parts)
    columns = np.hstack([moved[-1], np.zeros((n, len(orbit.passages[0].columns)))])
    arrived[-1], columns = orbit.segments[-1].through(PLAIN, arrived[-1], columns, values)
    arrived[-1], moved[-1] = arrived[-1] - orbit.turns, columns[:, :n]
    return Steps(begins, ends, nodes[own], arrived, moved / mesh.variation[:, None] * mesh.variation)


def first_of_blocks(factors: np.ndarray, grown: float, decayed: float) -> np.ndarray:
    """Numbers of the steps that blocks begin with, shape (b,): by their norms, steps of one block neither let
    deviations grow nor decay by more than given factors.
    """
    with np.errstate(divide="ignore"):
        sizes = np.log(np.linalg.svd(factors, compute_uv=False))
    up, down = np.maximum(sizes[:, 0], 0.0), np.maximum(-sizes[:, -1], 0.0)
    firsts, most, least = [0], np.log(grown), np.log(decayed)
    grows, decays = float(up[0]), float(down[0])
    for k in range(1, len(factors)):
        grows, decays = grows + float(up[k]), decays + float(down[k])
        if grows > most or decays > least:
            firsts.append(k)
            grows, decays = float(up[k]), float(down[k])
    return np.array(firsts)


def blocks(factors: np.ndarray, firsts: np.ndarray) -> np.ndarray:
    """Products of consecutive steps, each block from its first one on, shape (b, n, n)."""
    result = factors[firsts].copy()
    ends = np.append(firsts[1:], len(factors))
    for i, (first, end) in enumerate(zip(firsts, ends, strict=True)):
        for k in range(first + 1, end):
            result[i] = factors[k] @ result[i]
    return result


def multipliers_of(orbit: DiscretizedOrbit, z: np.ndarray, becoming: np.ndarray | None) -> Multipliers:
    """Multipliers of the closure by blocks of its steps, without the flow's own and pinned ones.

    Parameters
    ----------
    becoming : ndarray, shape (n,), optional
        Of an orbit that is a point still, where it is about to go.
    """
    # Steps follow the orbit: what decays within one by much is whatever the method makes of it.
    steps = _taken(orbit, z, PARTS)
    if not np.isfinite(steps.factors).all():
        size = orbit.spectrum_size
        return Multipliers(np.full(size, np.nan + 0j), np.full(size, np.inf), 1.0)
    units, firsts = orbit.mesh.variation, first_of_blocks(steps.factors, GROWN, DECAYED)
    lasts = np.append(firsts[1:], len(steps.factors)) - 1
    factors = blocks(steps.factors, firsts) * units[:, None] / units
    arriving: np.ndarray | None = None
    leaving = _directions(orbit, z, steps.starts[firsts], steps.begins[firsts])
    if becoming is not None:
        for own, factor in zip(leaving, factors, strict=True):
            own[:, 0], becoming = becoming, factor @ becoming
    elif orbit.moves(z):
        arriving = _directions(orbit, z, steps.arrived[lasts], steps.ends[lasts])
    tolerance = orbit.mesh.amplified * orbit.mesh.tolerance
    gradients, positive = len(orbit.system.conserved), not (orbit.itinerary.image or orbit.forced)
    given = factors, leaving, units, tolerance, arriving
    return multipliers(*given, gradients=gradients, positive=positive)


def _directions(orbit: DiscretizedOrbit, z: np.ndarray, states: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The directions that the flow carries along at some states (b, n), as columns, shape (b, n, k): its own,
    pinned ones, gradients of what is conserved.
    """
    field, values = orbit.passages[0].field(PLAIN), orbit.values_of(z)
    own = field.along(times, states, field.constants(orbit.given(z)))[:, :, None]
    given = own[:, :, :0] if orbit.forced else own
    if not orbit.pins and not orbit.system.conserved:
        return given
    others = [_others(orbit, x, values) for x in states]
    return np.concatenate([given, others], axis=2)


def _others(orbit: DiscretizedOrbit, x: np.ndarray, values: dict[str, float]) -> np.ndarray:
    """Pinned directions and gradients of what is conserved at a state, as columns."""
    pinned = neutrals.directions(orbit.system, orbit.pins, x, values)
    if not orbit.system.conserved:
        return pinned
    gradients = conserving.gradients_of(orbit.system, orbit.passages[0].leg.mode, x, values)
    return np.hstack([pinned, conserving.raised(gradients, orbit.mesh.variation)])
