"""Derivatives of an orbit's closure by its start: leg by leg with the events at their ends held, and the
multipliers of the map of a section.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.numerics.linear import norm_in
from contwalk.problems import conserving
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit import volumes
from contwalk.problems.orbit.equations import blocks_of
from contwalk.problems.orbit.layout import Segment
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.multipliers import Multipliers, multipliers, of_sections
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.periodic_schur import product
from contwalk.problems.orbit.shooting import velocity

# A guard that changes by less than this part of itself in a closure, at its rate at the event, has no rate.
NO_RATE = 1e-7
# An orbit that goes a smaller part of its variation in one closure, at its present speed, is a point.
POINT = 1e-9
# The flow's own multiplier, one, missed by more than this tells nothing of the others.
UNTOLD = 0.3
# Solutions of which the flow's direction is kept: several tests ask for it.
MOST_KEPT = 4


def factors(orbit: OrbitData, jacobian: np.ndarray) -> list[np.ndarray]:
    """Derivative of each leg's end by its start with the event at its end held, from DF(z).

    Of a forced system the time of the event is one more coordinate, the last one. A leg that no event
    ends lasts until the closure is over.

    The jacobian has the shape (N, N + 1).
    """
    return [product(own) for own in chain(orbit, jacobian)]


def chain(orbit: OrbitData, jacobian: np.ndarray) -> list[list[np.ndarray]]:
    """The factors of each of `factors`, one for each of its leg's segments.

    What lies between two segments of a leg is held at its instant: there a deviation along the motion is
    one like others. They are kept until another Jacobian is asked for: do not change them.

    The jacobian has the shape (N, N + 1).
    """
    return orbit.known.on(jacobian, "factors", lambda: _chain(orbit, jacobian))


def _chain(orbit: OrbitData, jacobian: np.ndarray) -> list[list[np.ndarray]]:
    layout = orbit.layout
    if orbit.in_closure:
        return [list(_factors_in_closure(orbit, jacobian))]
    return [
        [_factor(orbit, segment, jacobian) for segment in layout.segments_of(i)] for i in range(layout.legs)
    ]


def _factors_in_closure(orbit: OrbitData, jacobian: np.ndarray) -> np.ndarray:
    """The factors of the segments of one leg in times of the closure, shape (m, n, n)."""
    m, n = len(orbit.layout.segments), orbit.states
    every = np.arange(m)
    found = blocks_of(jacobian, m, n)[every, :, every]
    return found + np.eye(n) if m == 1 else found


def _factor(orbit: OrbitData, segment: Segment, jacobian: np.ndarray) -> np.ndarray:
    layout, i = orbit.layout, segment.leg
    rows, place = segment.ends, segment.states
    x = jacobian[rows, place].copy()
    if segment.following == place:
        x += np.eye(len(x))
    if not segment.last:
        if not orbit.timed(i):
            return x
        still = np.append(np.zeros(len(x)), 1.0)
        return np.vstack([np.hstack([x, jacobian[rows, layout.start, None]]), still])
    if orbit.itinerary.legs[i].transition is None:
        return _to_the_end(orbit, i, x, jacobian)
    guard = layout.guards + i
    late, guard_x = by_duration(orbit, segment, jacobian, rows), jacobian[guard, place]
    # An event without rate: those multipliers that stay finite have a limit, and this is near it.
    least = NO_RATE * float(orbit.guard_scales[i]) / orbit.mesh.total
    rate = by_duration(orbit, segment, jacobian, guard)
    rate = rate if abs(rate) > least else (-least if orbit.itinerary.legs[i].falls else least)
    if orbit.timed(i):
        x = np.hstack([x, jacobian[rows, layout.start, None]])
        guard_x = np.append(guard_x, jacobian[guard, layout.start])
    lasting = -guard_x / rate
    whole = x + np.outer(late, lasting)
    if orbit.timed((i + 1) % layout.legs):
        time = lasting.copy()
        if orbit.timed(i):
            time[-1] += 1.0
        whole = np.vstack([whole, time])
    return whole


def by_duration(orbit: OrbitData, segment: Segment, jacobian: np.ndarray, rows: Any) -> Any:
    """Derivatives of a segment's end by its own duration, when it starts being held.

    The jacobian has the shape (N, N + 1).
    """
    found = jacobian[rows, orbit.layout.durations.start + segment.leg]
    if segment.begin == 0.0 and segment.last:
        return found
    if orbit.forced:
        found = found - segment.begin * jacobian[rows, orbit.layout.start]
    return found / (segment.end - segment.begin)


def _to_the_end(orbit: OrbitData, i: int, x: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """A factor of a leg that no event ends: of a forced system, one that starts later is shorter."""
    if not orbit.timed(i):
        return x
    rows, layout = orbit.layout.matches[i], orbit.layout
    late = jacobian[rows, layout.start] - jacobian[rows, layout.durations.start + i]
    return np.column_stack([x, late])


def once_round(orbit: OrbitData, jacobian: np.ndarray, first: int) -> np.ndarray:
    """Derivative of the closure by the start of a leg: the product of all factors from that leg on.

    The jacobian has the shape (N, N + 1).
    """
    each = factors(orbit, jacobian)
    whole = np.eye(len(orbit.extended(first)))
    with np.errstate(over="ignore", invalid="ignore"):  # no number holds it where deviations grow by 1e308
        for k in range(len(each)):
            whole = each[(first + k) % len(each)] @ whole
    return whole


def _arrives_without_rate(orbit: OrbitData, jacobian: np.ndarray) -> bool:
    """Whether an event is a terminal grazing, to rounding: there multipliers may be infinite."""
    events = np.flatnonzero([leg.transition is not None for leg in orbit.itinerary.legs])
    own = orbit.layout.durations.start + events
    rates = np.abs(jacobian[orbit.layout.guards + events, own]) * orbit.mesh.total
    return bool(np.any(rates <= NO_RATE * orbit.guard_scales[events]))


def flow_direction(orbit: OrbitData, z: np.ndarray, i: int, j: int = 0) -> np.ndarray:
    """What a later start of leg i, or of its segment j, on the same orbit differs by: velocity, and time
    if forced.

    z has the shape (N + 1,), the direction (n_i,), or (n_i + 1,) with the time. It is kept: do not change it.
    """

    if orbit.in_closure and not orbit.forced:
        own: np.ndarray = flow_directions(orbit, z)[j]
        return own

    def made() -> np.ndarray:
        x, scalars = orbit.layout.inputs_of(orbit.layout.segments_of(i)[j], z)
        scalars, unknown = scalars.copy(), not (orbit.in_closure and orbit.forced)
        if unknown:
            scalars[0] = scalars[0] or 1.0
        duration = scalars[0] if unknown else orbit.duration(z)
        given = np.concatenate([scalars, orbit.line.constants])
        own = velocity(orbit.passages[i], x, 0.0, given) / duration
        own = np.append(own, 1.0) if orbit.timed(i) else own
        own.flags.writeable = False
        return own

    return orbit.known.at(f"flow {i} {j}", z, MOST_KEPT, made)


def flow_directions(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """`flow_direction` where each segment of an autonomous closure starts, shape (m, n): one call of compiled
    code for all. z has the shape (N + 1,).
    """

    def made() -> np.ndarray:
        _, scalars = orbit.layout.inputs_of(orbit.layout.segments[0], z)
        duration = scalars[0] if scalars[0] != 0.0 else 1.0
        field = orbit.passages[0].field(PLAIN)
        c = field.constants(np.concatenate([[duration], scalars[1:], orbit.line.constants]))
        starts = z[: orbit.layout.durations.start].reshape(len(orbit.layout.segments), -1)
        found = field.along(np.zeros(len(starts)), starts, c) / duration
        found[~np.isfinite(found).all(axis=1)] = np.nan  # as one that is asked for alone
        found.flags.writeable = False
        return found

    return orbit.known.at("flows", z, MOST_KEPT, made)


def pinned_directions(orbit: OrbitData, z: np.ndarray, i: int, j: int = 0) -> list[np.ndarray]:
    """Generators of the pinned directions at the start of leg i, or of its segment j, as `flow_direction`
    has the flow's.
    """
    if not orbit.pins:
        return []
    x = orbit.passages[i].full(z[orbit.layout.segments_of(i)[j].states])
    along = neutrals.directions(orbit.system, orbit.pins, x, orbit.values_of(z))
    own = along[list(orbit.passages[i].states)]
    return list((np.vstack([own, np.zeros((1, own.shape[1]))]) if orbit.timed(i) else own).T)


def neutral_directions(
    orbit: OrbitData, z: np.ndarray, i: int, j: int = 0, becoming: np.ndarray | None = None
) -> np.ndarray:
    """The flow's own direction, if there is one, pinned ones, and gradients of what is conserved at the
    start of leg i, or of its segment j, as columns; `becoming` stands for the flow's where nothing moves yet.

    z has the shape (N + 1,), `becoming` (n_i,).
    """
    held = orbit.forced and not orbit.timed(i)
    directions = [] if held else [flow_direction(orbit, z, i, j) if becoming is None else becoming]
    directions += pinned_directions(orbit, z, i, j)
    if orbit.system.conserved:
        passage = orbit.passages[i]
        x = passage.full(z[orbit.layout.segments_of(i)[j].states])
        gradients = conserving.gradients_of(orbit.system, passage.leg.mode, x, orbit.values_of(z))
        own = gradients[:, list(passage.states)]
        directions += list(conserving.raised(own, orbit.extended(i)).T)
    return np.array(directions).reshape(len(directions), len(orbit.extended(i))).T


def becoming_of(orbit: OrbitData, z: np.ndarray) -> np.ndarray | None:
    """Of an orbit without events that is a point still, the way that it is about to move: across its section.

    None of an orbit that moves, or that an event or the force begins.

    z has the shape (N + 1,), the way (n_0,).
    """
    if orbit.eventful or orbit.forced or orbit.section is None:
        return None
    units = orbit.extended(0)
    moved = flow_direction(orbit, z, 0) * orbit.duration(z)
    return None if norm_in(moved, units) > POINT else orbit.section.normal * units**2


def spectrum(orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
    """Multipliers of the closure, of the map of the smallest section.

    z has the shape (N + 1,), the jacobian (N, N + 1).
    """
    if not orbit.eventful and len(orbit.itinerary) == 1:
        return _of_closure(orbit, z, jacobian)
    smallest = orbit.smallest
    once = once_round(orbit, jacobian, smallest)
    if not np.all(np.isfinite(once)):
        return Multipliers(
            np.full(orbit.spectrum_size, np.nan + 0j), np.full(orbit.spectrum_size, np.inf), 1.0
        )
    tolerance = orbit.mesh.amplified * orbit.mesh.tolerance
    gradients = len(orbit.system.conserved)
    if len(orbit.layout.segments) > orbit.layout.legs and not gradients:
        found = of_sections(*_sections(orbit, z, jacobian), tolerance)
    else:
        neutral = neutral_directions(orbit, z, smallest, 0, becoming_of(orbit, z))
        found = multipliers([once], [neutral], orbit.extended(smallest), tolerance, gradients=gradients)
    if _arrives_without_rate(orbit, jacobian):
        endless = np.abs(found.values) > 0.01 / NO_RATE
        limit = np.where(endless, complex(np.inf, 0.0), found.values)
        return Multipliers(limit, np.where(endless, 0.0, found.errors), max(found.accuracy, NO_RATE))
    return found


def _sections(
    orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray], list[np.ndarray]]:
    """Factors once round from the smallest section on; where each begins, magnitudes, and directions that
    are left out.

    Inside a leg that is the flow's own, which the next event forgets, or which comes back where there is
    none; of a forced orbit without events it is a deviation like others. Right after an event nothing is
    left out: it has gone already.
    """
    found, magnitudes, left_out = [], [], []
    flows = orbit.itinerary.eventful or not orbit.forced
    segments, legs, first = chain(orbit, jacobian), orbit.layout.legs, orbit.smallest
    becoming = becoming_of(orbit, z)
    for i in ((first + k) % legs for k in range(legs)):
        for j, factor in enumerate(segments[i]):
            own = orbit.extended(i)
            found.append(factor)
            magnitudes.append(own)
            flow = flow_direction(orbit, z, i, j) if becoming is None else becoming
            left_out.append(flow[:, None] if j and flows else np.zeros((len(own), 0)))
            becoming = None if becoming is None else factor @ becoming
    left_out[0] = neutral_directions(orbit, z, first, 0, becoming_of(orbit, z))
    return found, magnitudes, left_out


def _of_closure(orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
    """Multipliers of one leg that no event ends, by its segments, without the flow's own and pinned ones."""
    (segments,), ends = chain(orbit, jacobian), z.copy()
    if not np.isfinite(segments).all():
        size = orbit.spectrum_size
        return Multipliers(np.full(size, np.nan + 0j), np.full(size, np.inf), 1.0)
    leaving, arriving = _left_out_along(orbit, z, segments), None
    if orbit.moves(z):  # where each segment arrives, but for the gap that the solution has left
        residual = orbit.linearize(z).residual
        for segment in orbit.layout.segments:
            ends[segment.following] += residual[segment.ends]
        arriving = np.roll(_left_out_along(orbit, ends), -1, axis=0)
    tolerance = orbit.mesh.amplified * orbit.mesh.tolerance
    given = segments, leaving, orbit.extended(0), tolerance, arriving
    positive = not (orbit.itinerary.image or orbit.forced)
    gradients = len(orbit.system.conserved)
    kept = not gradients and orbit.spectrum_size == 2 and volumes.kept(orbit, z)
    return multipliers(*given, gradients=gradients, positive=positive, volumes=kept)


def _left_out_along(
    orbit: OrbitData, z: np.ndarray, factors: Sequence[np.ndarray] | None = None
) -> np.ndarray:
    """`neutral_directions` at the starts of all segments of one leg that no event ends, shape (m, n, k).

    Given the segments' factors, what stands for the flow where nothing moves yet is carried along by them.
    """
    becoming = None if factors is None else becoming_of(orbit, z)
    flow_alone = orbit.in_closure and not (orbit.forced or orbit.pins or orbit.system.conserved)
    if flow_alone and becoming is None:
        return flow_directions(orbit, z)[:, :, None]
    found = []
    for j in range(len(orbit.layout.segments)):
        found.append(neutral_directions(orbit, z, 0, j, becoming))
        becoming = None if becoming is None or factors is None else factors[j] @ becoming
    return np.array(found)


def trivial_error(orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray) -> float:
    """How well each leg's map forgets where on the orbit it started, relative; NaN for a forced one.

    A start a little later on the same orbit leads to the same event: P f = 0. Where an event has no rate
    its map has no derivative: NaN.

    z has the shape (N + 1,), the jacobian (N, N + 1).
    """
    if orbit.forced or becoming_of(orbit, z) is not None:
        return float("nan")
    if not orbit.eventful and len(orbit.itinerary) == 1:
        return _missed(orbit, z, jacobian)
    if _arrives_without_rate(orbit, jacobian):
        return float("nan")
    worst, legs = 0.0, orbit.layout.legs
    for i, factors in enumerate(chain(orbit, jacobian)):
        if orbit.itinerary.legs[i].collapsed:
            continue
        for j, factor in enumerate(factors):
            last, there = j == len(factors) - 1, (i + 1) % legs
            own = flow_direction(orbit, z, i, j)
            units = orbit.extended(there if last else i)
            size = norm_in(own, orbit.extended(i))
            left = factor @ own
            if not last:
                left = left - flow_direction(orbit, z, i, j + 1)
            elif orbit.itinerary.legs[i].transition is None:
                left = left - flow_direction(orbit, z, there)
            scale = norm_in(np.abs(factor) @ np.abs(own), units)
            if size > 0.0 and scale > 0.0:
                worst = max(worst, norm_in(left, units) / max(scale, size))
    return worst


def _missed(orbit: OrbitData, z: np.ndarray, jacobian: np.ndarray) -> float:
    """|M f - f| / |f|: how well the flow carries its own velocity once round; NaN where there is none.

    Of several segments, the worst one's: what one does to it may be undone by the next.
    """
    (factors,), units = chain(orbit, jacobian), orbit.extended(0)
    own: Any = flow_directions(orbit, z) if orbit.in_closure else None
    if own is None:
        own = [flow_direction(orbit, z, 0, j) for j in range(len(factors))]
    sizes, worst = [norm_in(v, units) for v in own], 0.0
    if 0.0 in sizes or not orbit.moves(z):
        return float("nan")
    for j, factor in enumerate(factors):
        there = (j + 1) % len(factors)
        worst = max(worst, norm_in(factor @ own[j] - own[there], units) / sizes[there])
    return worst


def doubted(orbit: OrbitData, found: Multipliers, trivial: float, jacobian: np.ndarray) -> Multipliers:
    """Multipliers with what the trivial one misses by as an error, where that is no small part of it.

    The flow's direction then leaks into the others, with all that the closure lets grow.

    The jacobian has the shape (N, N + 1).
    """
    if orbit.eventful or not trivial > UNTOLD:
        return found
    legs = chain(orbit, jacobian)
    units = [orbit.extended(i % len(legs)) for i in range(len(legs) + 1)]
    for i, factors in enumerate(legs):
        for j, factor in enumerate(factors):
            reached = units[i + (j == len(factors) - 1)]
            trivial *= float(np.linalg.norm(factor / reached[:, None] * units[i], 2))
    return found.doubted(trivial)
