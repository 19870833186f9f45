"""The map that takes the start of a leg once round an orbit, with its derivatives along curves: the jet lift.

For an orbit with events it is the map of the whole space of starts (states, and time if forced): where a
start lies on its own motion makes no difference, so the flow's own direction has the multiplier zero, which
no normal form minds. Each leg's duration changes along a curve so that its guard stays zero, order by order.
Where no event ends the closure, starts and ends of an autonomous orbit lie in its section. Across pinned
directions starts and ends do not move: the drifts change along a curve so that they do not.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any

import numpy as np

from contwalk import flow
from contwalk.memory import remembered
from contwalk.numerics.spectrum import complement
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.lifts import JET, PLAIN, TANGENT
from contwalk.problems.orbit.normal_forms import SectionMap, units
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.period import period_map

ORDERS = 3
# Second derivatives of segments along lines that are kept: a normal form has several curves of few lines.
MOST_BENDS = 4096
# Gauss-Legendre quadrature over each step, across which squares of deviations are polynomials of few orders.
INSTANTS = 8


class ReturnMap(SectionMap):
    """The map from the start of the leg with fewest states to itself."""

    def __init__(self, problem: OrbitData, z: np.ndarray) -> None:
        self.problem, self.z = problem, z
        self.first = problem.smallest
        self.timed = problem.timed(self.first)
        magnitudes = problem.extended(self.first)
        held = [v / magnitudes**2 for v in monodromy.pinned_directions(problem, z, self.first)]
        self.held = np.array(held).reshape(len(held), len(magnitudes))
        rows = [*held]
        if not (problem.eventful or problem.forced):
            assert problem.section is not None
            rows.append(problem.section.normal)
        self.basis = np.diag(magnitudes)
        if rows:
            self.basis = complement((np.array(rows) * magnitudes).T) * magnitudes[:, None]
        self.coordinates = (self.basis / magnitudes[:, None]).T / magnitudes
        self._bends: dict[Any, np.ndarray] = {}
        self._pinned: dict[int, list[np.ndarray]] = {}

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
    def _derivatives(self) -> list[np.ndarray]:
        """Of each segment the derivatives of its end, and of its guard, by its start and its scalars."""
        each = zip(self.problem.segments, self._inputs, strict=True)
        return [piece.differentiated(PLAIN, *given)[1] for piece, given in each]

    @cached_property
    def _rates(self) -> list[tuple[np.ndarray, float]]:
        """Of each segment, the derivatives of its end and of what ends it by its duration; one that another
        one follows has its own at all times.
        """
        found = []
        for piece, (x, _), moved in zip(self.problem.segments, self._inputs, self._derivatives, strict=True):
            if piece.inner or not piece.passage.groups["T"]:
                found.append((np.zeros(len(x)), np.inf))
                continue
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
        if problem.layout.sum is None:
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
        width, groups = len(by_duration), piece.passage.groups
        lasting = [0.0] * ORDERS
        ends: list[np.ndarray] = []
        for j in range(order):
            directions = []
            for o in range(ORDERS):
                lasts, begins = [lasting[o]] * groups["T"], [times[o]] * groups["s"]
                directions.append(np.array([*lasts, *begins, *drifts[o], lam if o == 0 else 0.0]))
            if j < 2:  # what is linear needs no integration: the derivatives are known
                end = self._derivatives[number] @ np.concatenate([states[j], directions[j]])
                if j == 1:
                    end += self._bent(number, states[0], directions[0])
            else:
                out = piece.end(JET, np.concatenate([x, *states]), scalars, *directions)
                end = out[-(len(out) // (ORDERS + 1)) :]
            if piece.inner or not groups["T"]:
                lasting[j] = 0.0
            elif piece.passage.leg.transition is not None or not problem.forced:
                lasting[j] = -self._ending(end, width) / rate
            else:
                lasting[j] = period[j] - times[j]
            ends.append(end[:width] + by_duration * lasting[j])
        later = [t + d for t, d in zip(times, lasting, strict=True)]
        return ends + [np.zeros(width)] * (ORDERS - order), later

    def _bent(self, number: int, moved: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Second derivative of a segment's end along a line of starts, shape (n,), and scalars, (k,).

        Curves with one first derivative share it: what bends them enters to first order.
        """

        def made() -> np.ndarray:
            (x, scalars), nothing = self._inputs[number], np.zeros(len(direction))
            start = np.concatenate([x, moved, np.zeros(2 * len(x))])
            out = self.problem.segments[number].end(JET, start, scalars, direction, nothing, nothing)
            each = len(out) // (ORDERS + 1)
            return np.asarray(out[2 * each : 3 * each])

        return remembered(self._bends, (number, moved.tobytes(), direction.tobytes()), MOST_BENDS, made)

    @cached_property
    def a(self) -> np.ndarray:
        """A, shape (r, r)."""
        problem = self.problem
        moved = monodromy.once_round(problem, problem.linearize(self.z).jacobian, self.first) @ self.basis
        if not (problem.eventful or problem.forced):
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

    def reach(self, q: np.ndarray) -> float:
        """How many times q, shape (r,), moves a state by its largest value on the orbit, at the section."""
        own = list(self.problem.passages[self.first].states)
        moved = np.abs(self.basis @ q)[: len(own)]
        sizes = np.nanmax(np.abs(self.problem.motion_of(self.z)[1][:, own]), axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = np.nanmax(moved / sizes)
        return float(1.0 / largest) if largest > 0.0 else 1.0

    def _mean_square(self, v: np.ndarray) -> float:
        problem, layout = self.problem, self.problem.layout
        chain = monodromy.chain(problem, problem.linearize(self.z).jacobian)
        factors, total = [factor for own in chain for factor in own], 0.0
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
            instants, shares = self._quadrature(k)
            states = flow.interpolation(field, c, piece.steps, nodes, piece.method)(instants)
            scale = half[list(piece.passage.states)]
            deviations = self._across_pins(k, states[:, :n], states[:, n:]) / scale
            if not problem.forced:
                plain = piece.passage.field(PLAIN)
                own = plain.constants(piece.values(scalars))
                along = self._across_pins(k, states[:, :n], plain.along(instants, states[:, :n], own)) / scale
                along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
                deviations -= np.sum(deviations * along, axis=1, keepdims=True) * along
            total += float(shares @ np.sum(deviations**2, axis=1))
            v = factors[k] @ v
        return total

    def _quadrature(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Instants of a segment, in the time of its steps, and their shares of a mean over the closure."""
        problem, segment = self.problem, self.problem.layout.segments[number]
        part = segment.end - segment.begin
        if problem.eventful or problem.layout.legs > 1:
            part = abs(float(self._inputs[number][1][0])) / max(abs(problem.duration(self.z)), 1e-300)
        (nodes, weights), steps = _gauss_legendre(), problem.segments[number].steps
        lasting = np.diff(steps)[:, None]
        instants = steps[:-1, None] + lasting * nodes
        return instants.ravel(), (lasting * weights).ravel() * (part / (steps[-1] - steps[0]))

    def _across_pins(self, number: int, states: np.ndarray, deviations: np.ndarray) -> np.ndarray:
        """Deviations at some states of a segment without their parts along pinned directions."""
        problem = self.problem
        if not problem.pins:
            return deviations
        passage, values = problem.passages[problem.layout.segments[number].leg], problem.values_of(self.z)
        own = list(passage.states)
        if number not in self._pinned:  # the states of a segment are the same whatever deviates
            self._pinned[number] = [
                neutrals.directions(problem.system, problem.pins, x, values)[own]
                for x in passage.full(states)
            ]
        scale = problem.mesh.variation[own]
        each = zip(self._pinned[number], deviations, strict=True)
        return np.array([neutrals.across(deviation, along, scale) for along, deviation in each])


@cache
def _gauss_legendre() -> tuple[np.ndarray, np.ndarray]:
    """Instants between 0 and 1, and their shares of a mean; never changed."""
    nodes, weights = np.polynomial.legendre.leggauss(INSTANTS)
    return 0.5 * nodes + 0.5, 0.5 * weights
