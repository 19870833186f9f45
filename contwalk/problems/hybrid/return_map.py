"""The map that takes the start of a leg once round a hybrid orbit, with its derivatives along curves.

For an orbit with events it is the map of the whole space of starts (states, and time if forced): where a
start lies on its own motion makes no difference, so the flow's own direction has the multiplier zero, which
no normal form minds. Each leg's duration changes along a curve so that its guard stays zero, order by order.
Where no event ends the closure, starts and ends of an autonomous orbit lie in its section. Across pinned
directions starts and ends do not move: the drifts change along a curve so that they do not.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.numerics.spectrum import complement
from contwalk.problems.hybrid import families, monodromy
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import JET, PLAIN, TANGENT
from contwalk.problems.orbit.normal_forms import SectionMap, units
from contwalk.problems.orbit.period import period_map

ORDERS = 3
# Gauss-Legendre quadrature over a leg's own time: deviations are smooth between events.
INSTANTS, SHARES = (0.5 * values for values in np.polynomial.legendre.leggauss(48))
INSTANTS = INSTANTS + 0.5


class EventMap(SectionMap):
    """The map from the start of the leg with fewest states to itself."""

    def __init__(self, problem: DiscretizedOrbit, z: np.ndarray) -> None:
        self.problem, self.z = problem, z
        self.first = problem.smallest
        self.timed = problem.timed(self.first)
        magnitudes = problem.extended(self.first)
        held = [v / magnitudes**2 for v in monodromy.pinned_directions(problem, z, self.first)]
        self.held = np.array(held).reshape(len(held), len(magnitudes))
        rows = [*held]
        if not (problem.word.eventful or problem.forced):
            assert problem.section is not None
            rows.append(problem.section.normal)
        self.basis = np.diag(magnitudes)
        if rows:
            self.basis = complement((np.array(rows) * magnitudes).T) * magnitudes[:, None]
        self.coordinates = (self.basis / magnitudes[:, None]).T / magnitudes

    @cached_property
    def _round_trip(self) -> list[int]:
        """Numbers of all segments, from the first of the leg that the map starts with on."""
        layout = self.problem.layout
        before = sum(layout.cuts[: self.first])
        return [(before + k) % len(layout.segments) for k in range(len(layout.segments))]

    @cached_property
    def _inputs(self) -> list[tuple[np.ndarray, np.ndarray]]:
        layout = self.problem.layout
        return [layout.inputs_of(segment, self.z) for segment in layout.segments]

    @cached_property
    def _rates(self) -> list[tuple[np.ndarray, float]]:
        """Of each segment, the derivatives of its end and of what ends it by its duration; one that another
        one follows has its own at all times.
        """
        problem, found = self.problem, []
        for piece, (x, scalars) in zip(problem.segments, self._inputs, strict=True):
            if piece.inner:
                found.append((np.zeros(len(x)), np.inf))
                continue
            _, moved = piece.differentiated(PLAIN, x, scalars)
            column, width = moved[:, len(x)], len(piece.passage.following)
            found.append((column[:width], self._ending(column, width)))
        return found

    def _ending(self, end: np.ndarray, width: int) -> float:
        """What ends a leg, of one order of its end: the guard, or where there is none the section."""
        if len(end) > width:
            return float(end[width])
        assert self.problem.section is not None or self.problem.forced
        return 0.0 if self.problem.section is None else float(self.problem.section.normal @ end[:width])

    def curve(
        self, x1: np.ndarray, x2: np.ndarray | None = None, lam: float = 0.0, order: int = 3
    ) -> list[np.ndarray]:
        """First derivatives, up to `order`, of the image of the curve xi = s x1 + s^2 x2 / 2, lambda
        + s lam.
        """
        start = [self.basis @ x1, np.zeros(len(self.basis)) if x2 is None else self.basis @ x2]
        start.append(np.zeros(len(self.basis)))
        drifts = [np.zeros(len(self.held)) for _ in range(ORDERS)]
        if not len(self.held):
            return [self.coordinates @ end for end in self._round(start, drifts, lam, order)]
        images = []
        for j in range(order):
            end = self._round(start, drifts, lam, j + 1)[j]
            drifts[j] = self._holding(end)
            images.append(self.coordinates @ (end + self._by_drifts @ drifts[j]))
        return images

    def _round(
        self, start: list[np.ndarray], drifts: list[np.ndarray], lam: float, order: int
    ) -> list[np.ndarray]:
        """Derivatives of the end of a curve of starts, at drifts that change along it."""
        layout = self.problem.layout
        width = layout.sizes[self.first]
        states = [entry[:width] for entry in start]
        times = [float(entry[width]) if self.timed else 0.0 for entry in start]
        period = self._period(lam)
        for k in self._round_trip:
            states, times = self._through(k, states, times, drifts, lam, period, order)
        if not self.timed:
            return states[:order]
        return [np.append(states[j], times[j] - period[j]) for j in range(order)]

    @cached_property
    def _by_drifts(self) -> np.ndarray:
        """Derivative of the end by the drifts of pinned directions, shape (r, k)."""
        count, still = len(self.held), [np.zeros(len(self.basis))] * ORDERS
        columns = []
        for j in range(count):
            drifts = [np.eye(count)[j], np.zeros(count), np.zeros(count)]
            columns.append(self._round(still, drifts, 0.0, 1)[0])
        return np.array(columns).T

    def _holding(self, end: np.ndarray) -> np.ndarray:
        """Change of the drifts that brings an end back to where pinned directions are held."""
        return -np.linalg.solve(self.held @ self._by_drifts, self.held @ end)

    def _period(self, lam: float) -> list[float]:
        """Derivatives of a forced closure's duration along the curve."""
        problem = self.problem
        if not problem.forced:
            return [0.0] * ORDERS
        map_ = period_map(problem.system, problem.line.own, problem.line.direction, JET)
        given = np.concatenate([self.z[-1:], problem.line.constants, [lam], [0.0], [0.0]])
        return (problem.forcings * map_(0.0, np.zeros(0), map_.constants(given)))[1:].tolist()

    def _through(
        self,
        number: int,
        states: list[np.ndarray],
        times: list[float],
        drifts: list[np.ndarray],
        lam: float,
        period: list[float],
        order: int,
    ) -> tuple[list[np.ndarray], list[float]]:
        """Derivatives of state and time at the next segment's start, a leg's duration held to its event."""
        problem, piece, (x, scalars) = self.problem, self.problem.segments[number], self._inputs[number]
        by_duration, rate = self._rates[number]
        width, forced = len(by_duration), problem.forced
        lasting = [0.0] * ORDERS
        ends: list[np.ndarray] = []
        for j in range(order):
            directions = []
            for o in range(ORDERS):
                direction = np.zeros(len(scalars))
                direction[0] = lasting[o]
                if forced:
                    direction[1] = times[o]
                direction[1 + int(forced) : -1] = drifts[o]
                direction[-1] = lam if o == 0 else 0.0
                directions.append(direction)
            jets = np.concatenate([x, *states])
            out = piece.end(JET, jets, scalars, *directions)
            each = len(out) // (ORDERS + 1)
            end = out[(j + 1) * each : (j + 2) * each]
            if piece.inner:
                lasting[j] = 0.0
            elif piece.passage.leg.transition is not None or not forced:
                lasting[j] = -self._ending(end, width) / rate
            else:
                lasting[j] = period[j] - times[j]
            ends.append(end[:width] + by_duration * lasting[j])
        later = [t + d for t, d in zip(times, lasting, strict=True)]
        return ends + [np.zeros(width)] * (ORDERS - order), later

    @cached_property
    def a(self) -> np.ndarray:
        """A, shape (r, r)."""
        problem = self.problem
        moved = monodromy.once_round(problem, problem.linearize(self.z).jacobian, self.first) @ self.basis
        if not (problem.word.eventful or problem.forced):
            by_duration, rate = self._rates[-1]
            assert problem.section is not None
            moved -= np.outer(by_duration, problem.section.normal @ moved) / rate
        if len(self.held):
            moved += self._by_drifts @ self._holding(moved)
        return self.coordinates @ moved

    @cached_property
    def by_parameter(self) -> np.ndarray:
        """Derivative of the map by the free parameter, shape (r,)."""
        return self.curve(np.zeros(self.basis.shape[1]), None, 1.0, 1)[0]

    def size(self, q: np.ndarray) -> float:
        """Root mean square over the closure of the deviation that starts as q, across the flow."""
        parts = [q.real, q.imag] if np.iscomplexobj(q) else [q]
        return float(np.sqrt(sum(self._mean_square(self.basis @ part) for part in parts)))

    def _mean_square(self, v: np.ndarray) -> float:
        problem, layout = self.problem, self.problem.layout
        chain = monodromy.chain(problem, problem.linearize(self.z).jacobian)
        factors, total = [factor for own in chain for factor in own], 0.0
        whole = abs(problem.duration(self.z))
        half = units(problem.system, problem.motion_of(self.z)[1], problem.mesh.magnitudes)
        for k in self._round_trip:
            i = layout.segments[k].leg
            piece, (x, scalars) = problem.segments[k], self._inputs[k]
            n, field = len(x), piece.passage.field(TANGENT)
            direction = np.zeros(len(scalars))
            if problem.timed(i):
                direction[1] = v[n]
            c = field.constants(piece.values(scalars, direction))
            nodes = flow.along(field, c, piece.steps, np.concatenate([x, v[:n]]), piece.method)
            states = flow.interpolation(field, c, piece.steps, nodes, piece.method)(INSTANTS)
            scale = half[list(piece.passage.states)]
            deviations = self._across_pins(i, states[:, :n], states[:, n:]) / scale
            if not problem.forced:
                plain = piece.passage.field(PLAIN)
                own = plain.constants(piece.values(scalars))
                along = self._across_pins(i, states[:, :n], plain.along(INSTANTS, states[:, :n], own)) / scale
                along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
                deviations -= np.sum(deviations * along, axis=1, keepdims=True) * along
            mean = float(SHARES @ np.sum(deviations**2, axis=1))
            total += mean * abs(float(scalars[0])) / max(whole, 1e-300)
            v = factors[k] @ v
        return total

    def _across_pins(self, i: int, states: np.ndarray, deviations: np.ndarray) -> np.ndarray:
        """Deviations at some states of a leg without their parts along pinned directions."""
        problem = self.problem
        if not problem.pins:
            return deviations
        passage, values = problem.passages[i], problem.values_of(self.z)
        own, scale = list(passage.states), problem.mesh.variation[list(passage.states)]
        result = []
        for x, deviation in zip(passage.full(states), deviations, strict=True):
            along = families.directions(problem.system, problem.pins, x, values)[own]
            result.append(families.across(deviation, along, scale))
        return np.array(result)
