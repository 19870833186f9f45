"""Periodic orbits through events as one free parameter varies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from typing import Any

import numpy as np

from contwalk import quantities
from contwalk.branch import Outcome, SpecialPoint
from contwalk.errors import NotFinite
from contwalk.memory import remembered, unowned
from contwalk.numerics.linear import EPSILON, Factored, Factorization
from contwalk.problems import kinks
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.event_kinks import Met
from contwalk.problems.hybrid import (
    condensed,
    cutting,
    end_maps,
    families,
    lasting,
    least,
    limits,
    monodromy,
    neighbours,
    observing,
    switching,
)
from contwalk.problems.hybrid.discretized_orbit import MOST_VIEWS, DiscretizedOrbit
from contwalk.problems.hybrid.layout import Segment
from contwalk.problems.hybrid.margins import Guarded, Limit, Margins
from contwalk.problems.hybrid.mirror_image import HybridMirror, mirror_of
from contwalk.problems.hybrid.return_map import EventMap
from contwalk.problems.hybrid.shooting import AT_REST, meshed, most_steps
from contwalk.problems.hybrid.stretch import Stretch
from contwalk.problems.hybrid.vanishing import in_no_time, onto_an_event
from contwalk.problems.hybrid.word import stored_leg
from contwalk.problems.kinks import Kink
from contwalk.problems.orbit import augmented, branching, describing, rates
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.conservation import not_conserved
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.homoclinic import homoclinic
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.meeting import distance
from contwalk.problems.orbit.motion import PLAIN, TANGENT
from contwalk.problems.orbit.multipliers import GLOBAL, Multipliers
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.period import period_and_slope
from contwalk.problems.orbit.points.catalogue import LIMIT_TYPES, POINT_TYPES
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.orbit.section import Section, section_at
from contwalk.problems.orbit.slow_place import AROUND, SlowPlace, slow_place_on
from contwalk.problems.orbit.solving import error_holding, newton_on
from contwalk.problems.orbit.unbounded import unbounded
from contwalk.problems.orbit.vanishing import at_a_point
from contwalk.problems.problem import MAX_ABS, Linearization, Located, Sample, Seed, Test
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

# A residual counts as solved at this part of the tolerance.
SOLVED = 1e-3
# Evaluations of the field in a step of each method (of the implicit ones, about).
STAGES = {"dop853": 12, "verner98": 16, "radau5": 24, "radau9": 40}
# Linearizations that are kept, as far as they fit: a step asks for the same ones several times.
LEAST_KEPT, MOST_KEPT, MOST_BYTES = 3, 12, 5e7
# Residuals so many times above their level are no solution's.
MISSED = 3e4
# Growth of deviations over a leg that is told where a branch cannot go on.
STRETCHED = 1e3
# A leg this short, against the closure, is none.
COLLAPSED = 1e-13
# An orbit that moves less than this part of its states is a point.
STILL = 1e-9
# Multipliers whose difference has a smaller square meet, to rounding.
MEET = 1e-12
# Two orbits whose periods and states differ by less than this part are one; a leg looked at closely.
ALIKE = 1e-6
CLOSELY = np.linspace(0.0, 1.0, 2048)

# Limits whose neighbours are kept.
_NEIGHBOURS: dict[tuple, tuple[System, tuple[Sequence[Seed], str]]] = {}
_MOST_NEIGHBOURS = 4


class HybridOrbit(DiscretizedOrbit):
    """Orbits of one word: the legs' ends are the next ones' starts, and each ends where its guard is zero.

    Newton's method never looks for an event: durations are unknowns, and a guard is an equation. So the
    equations are smooth, and stay regular where an event grazes. An orbit without events is one leg that ends
    where it began; what is watched on it is watched as on any other. Where the last leg ends without an event
    the phase is fixed by an equation of its own: forced orbits begin where the force begins its period, the
    others in a section.

    Parameters
    ----------
    system : System
    word : Word
    parameters : mapping
        Values of all parameters.
    free : str
        Name of the free parameter, or `path`.
    path : tuple of two mappings, optional
    pins : sequence of Neutral
    reference : ndarray, shape (n,), optional
        State at which pins without a parameter hold their direction.
    subharmonic : int
        The whole orbit of a forced system lasts so many of its periods.
    discretization : Discretization
    """

    kind = "hybrid_orbit"
    discretized = True
    blur = 1e-3  # solutions are solved for to a part of the tolerance only
    point_types = (*POINT_TYPES, *LIMIT_TYPES)
    beside = 0.05

    # -- variants ----------------------------------------------------------------------------------------

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive for an orbit to be the machine's."""
        return limits.limits_of(self)

    @cached_property
    def guarded(self) -> tuple[Guarded | None, ...]:
        """The sampled guards that `limits` are of."""
        return limits.guarded(self)

    @property
    def observable_names(self) -> tuple[str, ...]:
        """The system's observables, margins of what is watched and of conditions, `split`, extremes of
        states, states at further visits of an event, and `max_abs`.
        """
        states = self.system.state_names
        later = quantities.visit_names(states, observing.visits(self))
        return (*self.system.observable_names, *quantities.extreme_names(states), *later, MAX_ABS)

    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution."""
        return self.known.at("margins", z, MOST_VIEWS, lambda: limits.margins(self, z))

    def stretches(self, z: np.ndarray) -> list[Stretch]:
        """The legs of the whole motion, images included."""
        return self.known.at("stretches", z, MOST_VIEWS, lambda: observing.stretches(self, z))

    # -- vectors of unknowns -----------------------------------------------------------------------------

    # -- equations ---------------------------------------------------------------------------------------

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z."""
        return self.known.at("linearization", z, self.most_kept, lambda: self._linearized(z))

    @property
    def most_kept(self) -> int:
        """How many linearizations are kept."""
        return int(min(max(MOST_BYTES / (8.0 * self.size**2), LEAST_KEPT), MOST_KEPT))

    def _linearized(self, z: np.ndarray) -> Linearization:
        residual, jacobian, nodes = self._equations(z)
        self.known.at("nodes", z, self.most_kept, lambda: nodes)
        levels, magnitudes = unowned(self._levels), unowned(self.magnitudes_near)
        nearby = unowned(self.residual)
        return Linearization(
            residual,
            jacobian,
            lambda: (levels(z, jacobian), None),
            lambda: magnitudes(z),
            self._factored,
            lambda: nearby,
            unowned(self.fitted),
        )

    def fitted(self, z: np.ndarray, normal: np.ndarray, weights: np.ndarray) -> np.ndarray | None:
        """Unknowns whose legs last until their guards are met, for steps that are mostly of durations."""
        return lasting.fitted(self, z, normal, weights)

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N, N + 1)."""
        return self.linearize(z).jacobian

    def residual(self, z: np.ndarray) -> np.ndarray:
        """F(z), shape (N,), for far less than with its derivatives."""
        residual = np.zeros(self.size)
        for segment, piece in zip(self.layout.segments, self.segments, strict=True):
            self._match(segment, z, piece.end(PLAIN, *self.layout.inputs_of(segment, z)), residual)
        self._closed(z, residual, np.zeros((self.size, self.size + 1)))
        self.effort.spend(STAGES[self.mesh.method] * sum(len(piece.steps) - 1 for piece in self.segments))
        return residual

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A matrix of these equations and unknowns, and of borders that come last, factored."""
        return self._factored(matrix, weights)

    @property
    def _factored(self) -> Callable[[np.ndarray, np.ndarray], Factorization]:
        # An equation of the phase is one of the first leg's start: the chain has no place for it.
        return partial(condensed.factored, self.layout) if self.word.eventful else Factored

    def _equations(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
        layout, nodes = self.layout, []
        residual, jacobian = np.zeros(self.size), np.zeros((self.size, self.size + 1))
        for segment, piece in zip(layout.segments, self.segments, strict=True):
            x, scalars = layout.inputs_of(segment, z)
            along, end, moved = piece.passed(x, scalars)
            nodes.append(along)
            self._match(segment, z, end, residual)
            rows, derivative = segment.ends, layout.along(segment, moved)
            n = rows.stop - rows.start
            jacobian[rows] += derivative[:n]
            jacobian[rows, segment.following] -= _identity(n)
            if len(end) > n:
                jacobian[layout.guards + segment.leg] = derivative[n]
        self._closed(z, residual, jacobian)
        self.effort.spend(self.cost)
        return residual, jacobian, nodes

    def _match(self, segment: Segment, z: np.ndarray, end: np.ndarray, residual: np.ndarray) -> None:
        """Write the equations of the end of a segment: it is the next one's start, and a leg's guard is zero
        there.
        """
        layout, rows = self.layout, segment.ends
        n = rows.stop - rows.start
        residual[rows] = end[:n] - z[segment.following]
        if segment.last and segment.leg == layout.legs - 1:
            residual[rows] -= self.turns[list(self.passages[0].states)]
        if len(end) > n:
            residual[layout.guards + segment.leg] = end[n]

    def _closed(self, z: np.ndarray, residual: np.ndarray, jacobian: np.ndarray) -> None:
        """Write the equations of the closure, of phase or period and of pins, with their gradients."""
        layout = self.layout
        if not self.word.eventful:
            last = layout.guards + layout.legs - 1
            residual[last] = self._phase(z, jacobian[last])
        if layout.sum is not None:
            period, slope = self._period(z)
            residual[layout.sum] = z[layout.durations].sum() - period
            jacobian[layout.sum, layout.durations] = 1.0
            jacobian[layout.sum, -1] = -slope
        for j, pin in enumerate(self.pins):
            residual[layout.held + j] = self._pinned(pin, z, jacobian[layout.held + j])

    def _phase(self, z: np.ndarray, row: np.ndarray) -> float:
        """What fixes the phase where no event does; its gradient is written into `row`."""
        if self.layout.start is not None:  # forced: it is looked at when the force begins its period
            row[self.layout.start] = 1.0
            return float(z[self.layout.start])
        assert self.section is not None
        row[self.layout.states[0]] = self.section.normal
        return self.section.residual(z[self.layout.states[0]])

    def _period(self, z: np.ndarray, lift: str = PLAIN, *directions: np.ndarray) -> Any:
        """Duration of the closure of a forced orbit, and its derivative by the free parameter."""
        own, direction = self.line.own, self.line.direction
        given = np.concatenate([self.line.constants, *directions])
        value, slope = period_and_slope(self.system, own, direction, float(z[-1]), given, lift)
        return self.forcings * value, self.forcings * slope

    def _pinned(self, pin: Neutral, z: np.ndarray, row: np.ndarray) -> float:
        """Residual of a pinned direction, at the start of the first leg; its gradient is written
        into `row`.
        """
        place = self.layout.states[0]
        normal, apart = self.held(pin, self.first_state(z), self.values_of(z))
        row[place] = normal[list(self.passages[0].states)]
        if pin.pin is not None and pin.value is not None:
            row[-1] = -self.line.slope(pin.value)
        return apart

    @property
    def cost(self) -> int:
        """Right-hand sides of one pass with derivatives, each column counted as one."""
        stages = STAGES[self.mesh.method]
        return sum(
            (len(piece.steps) - 1) * stages * (1 + len(piece.passage.states) + len(piece.passage.columns))
            for piece in self.segments
        )

    @property
    def equation_scales(self) -> np.ndarray:
        """Units of the equations, shape (N,)."""
        scales, variation = np.ones(self.size), self.mesh.variation
        for i, rows in enumerate(self.layout.matches):
            scales[rows] = variation[list(self.passages[i].following)]
        for segment in self.layout.segments:
            if not segment.last:
                scales[segment.ends] = variation[list(self.passages[segment.leg].states)]
        scales[self.layout.guards : self.layout.guards + self.layout.legs] = self.guard_scales
        return scales

    def _levels(self, z: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """What of each residual is rounding, or error of the steps."""
        steps = max(len(times) for times in self.mesh.steps)
        terms = np.abs(jacobian) @ np.abs(z)
        for segment in self.layout.segments:  # the identity may have cancelled in the Jacobian
            terms[segment.ends] += np.abs(z[segment.following])
        held = slice(self.layout.held, self.layout.held + len(self.pins))
        # A state that is held at zero is known to the rounding of what it is elsewhere.
        terms[held] += np.abs(jacobian[held, : self.size]) @ self.cycle_scales[1]
        own = SOLVED * self.mesh.tolerance * self.equation_scales
        own[self._exact] = 0.0
        return own + (8.0 + steps) * EPSILON * terms + 1e-300

    def _errors(self, linearization: Linearization) -> np.ndarray:
        """Estimated error of each equation: that of the steps, beside what it is solved to."""
        errors = linearization.levels[0].copy()
        steps = GLOBAL * self.mesh.growth * self.mesh.tolerance * self.equation_scales
        steps[self._exact] = 0.0
        return errors + steps

    @property
    def _exact(self) -> slice:
        """The equations that no motion is integrated for."""
        return slice(self.layout.guards + self.layout.legs, self.layout.rest.stop)

    def magnitudes_near(self, z: np.ndarray) -> np.ndarray:
        """Half the range of each state over the orbit; declared scales where there are any."""
        every = np.concatenate([view.full(view.nodes) for view in self.view(z)])
        half = 0.5 * np.ptp(every, axis=0)
        if self.word.image and not np.all(half > 0.0):  # held until the image follows
            whole = np.vstack([every, self._images(z, every)])
            half = np.where(half > 0.0, half, 0.5 * np.ptp(whole, axis=0))
        largest = np.maximum(np.abs(every).max(axis=0), self.mesh.magnitudes)
        shares = half / largest
        moves = float(shares.max()) > AT_REST
        half = np.where(moves & (shares > max(1e-5 * float(shares.max()), 1e-13)), half, np.nan)
        for i, state in enumerate(self.system.states):
            if state.scale is not None:
                half[i] = state.scale
        result, m = np.full(self.size + 1, np.nan), self.layout.legs
        for place, passage in self._places:
            result[place] = half[list(passage.states)] * np.sqrt(len(self.layout.segments))
        total = abs(self.duration(z))
        result[self.layout.durations] = total * np.sqrt(m)
        if self.layout.start is not None:
            result[self.layout.start] = total
        result[self.layout.drifts] = self._drift_scales(z) * np.sqrt(m)
        result[-1] = abs(z[-1])
        return result

    def _images(self, z: np.ndarray, states: np.ndarray) -> np.ndarray:
        """States of the part of the orbit that follows."""
        symmetry, p = self.system.symmetry(self.word.image), ParameterValues(**self.values_of(z))
        return np.array([imaged(symmetry, x, p) for x in states])

    def _drift_scales(self, z: np.ndarray) -> np.ndarray:
        """Drifts that move states by their variation in a closure, or those that there are, if larger."""
        x, variation = self.first_state(z), self.mesh.variation
        along = families.directions(self.system, self.pins, x, self.values_of(z)) / variation[:, None]
        typical = 1.0 / (np.linalg.norm(along, axis=0) * abs(self.duration(z)))
        return np.maximum(typical, np.abs(z[self.layout.drifts]))

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
        result = np.ones(self.size + 1)
        for place, passage in self._places:
            result[place] = self.mesh.variation[list(passage.states)]
        result[self.layout.durations] = abs(self.duration(z))
        if self.layout.start is not None:
            result[self.layout.start] = abs(self.duration(z))
        result[self.layout.drifts] = self._drift_scales(z)
        result[-1] = max(abs(float(z[-1])), 1e-300)
        return result

    def obstacle(self, z: np.ndarray) -> str:
        """Where the field is smooth by pieces only, or over which leg deviations grow."""
        kink = next(iter(kinks_along(self, z)), None)
        if kink is not None:
            return kink.sentence("orbits")
        grown = self.mesh.grown
        if not grown or max(grown) < STRETCHED:
            return ""
        most = int(np.argmax(grown))
        leg = self.word.legs[self.layout.segments[most].leg]
        ends = f"ends with '{leg.name}'" if leg.name else "no event ends"
        where = "" if self.cuts == 1 else f"one of {self.cuts} segments of "
        told = (
            f"Deviations grow by {grown[most]:.0e} over {where}the leg in mode '{leg.mode}' that {ends}: "
            "where it passes beside a saddle, or along what repels it (a canard, or a homoclinic orbit "
            "nearby), the parameter stands still while the orbit changes, and beyond some of this growth no "
            "start of the leg tells its end."
        )
        if not self.cuttable:
            return f"{told} A smaller `tolerance` (`engine`) goes a little further."
        return f"{told} Begin the branch with more segments (`engine: {{segments: {2 * self.cuts}}}`)."

    def explain(self, z: np.ndarray) -> str:
        """Where a residual at z is not finite."""
        return "the motion from there ends or grows without bound within one period"

    # -- stored with a branch ----------------------------------------------------------------------------

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch of these orbits, as fields of `BranchInfo`."""
        return {
            "problem": self.kind,
            "observables": self.observable_names,
            "unknowns": self.cut_into(cutting.room(self)).size,
            "spectrum": max(self.spectrum_size, 1),
            "closure": self.whole[0],
            "signature": self.signature,
            "subharmonic": self.subharmonic,
            "settings": {
                **neutrals.kept(self.pins, self.line, self.states),
                "legs": [stored_leg(leg) for leg in self.word.legs],
                "fold": self.whole[1],
                "image": self.word.image,
                "turns": self.turns.tolist(),
                "reported": observing.place(self),
                "room": cutting.room(self),
            },
        }

    # -- the spectrum ------------------------------------------------------------------------------------

    # -- second derivatives ------------------------------------------------------------------------------

    @property
    def cycle_scales(self) -> tuple[np.ndarray, np.ndarray]:
        """Units of the rows and of the columns of `cycle_matrix`."""
        columns = np.ones(self.size)
        for place, passage in self._places:
            columns[place] = self.mesh.variation[list(passage.states)]
        columns[self.layout.durations] = self.mesh.total
        if self.layout.start is not None:
            columns[self.layout.start] = self.mesh.total
        return self.equation_scales, columns

    def cycle_matrix(self, jacobian: np.ndarray, multiplier: complex) -> np.ndarray:
        """L(mu): F_u, but what closes is mu times what began. Singular where mu is a multiplier."""
        matrix = jacobian[:, : self.size].astype(complex if np.imag(multiplier) else float)
        rows, place = self.layout.matches[-1], self.layout.states[0]
        matrix[rows, place] += (1.0 - multiplier) * np.eye(rows.stop - rows.start)
        if self.layout.sum is not None and self.layout.start is not None:
            matrix[self.layout.sum, self.layout.start] += 1.0 - multiplier
        return matrix

    def cycle_return(self, psi: np.ndarray, v: np.ndarray) -> complex:
        """-psi* L' v, where L' is the derivative of `cycle_matrix` by the multiplier."""
        result = complex(psi[self.layout.matches[-1]].conj() @ v[self.layout.states[0]])
        if self.layout.sum is not None and self.layout.start is not None:
            result += complex(np.conj(psi[self.layout.sum]) * v[self.layout.start])
        return result

    def cycle_derivative(self, z: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative by z of L v for a real v, shape (N, N + 1)."""
        return self.derivative_along(z, np.append(v, 0.0))

    def cycle_rate(self, z: np.ndarray, v: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Derivative of L v along a direction, for a real v, shape (N,)."""
        layout, lifted, result = self.layout, np.append(v, 0.0), np.zeros(self.size)
        for segment, piece in zip(layout.segments, self.segments, strict=True):
            direction, along = layout.inputs_of(segment, lifted), layout.inputs_of(segment, tangent)
            moved = piece.changing(*layout.inputs_of(segment, z), direction, along)
            width, rows = len(moved) // 2, segment.ends
            n = rows.stop - rows.start
            result[rows] = moved[width : width + n]
            if width > n:
                result[layout.guards + segment.leg] = moved[width + n]
        return result

    def derivative_along(self, z: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative by z of DF(z) v for a real v of length N + 1, shape (N, N + 1)."""
        layout, result = self.layout, np.zeros((self.size, self.size + 1))
        for segment, piece in zip(layout.segments, self.segments, strict=True):
            x, scalars = layout.inputs_of(segment, z)
            direction, along = layout.inputs_of(segment, v)
            _, moved = piece.differentiated(TANGENT, np.concatenate([x, direction]), scalars, along)
            width = len(moved) // 2
            derivative = layout.along(segment, moved[width:])
            rows = segment.ends
            n = rows.stop - rows.start
            result[rows] += derivative[:n]
            if width > n:
                result[layout.guards + segment.leg] = derivative[n]
        if layout.sum is not None and v[-1] != 0.0:
            result[layout.sum, -1] = -self._period(z, TANGENT, v[-1:])[1]
        return result

    def return_map(self, z: np.ndarray) -> SectionMap:
        """The map that takes a section once round the orbit, for normal forms."""
        return EventMap(self, z)

    def collapsed(self, z: np.ndarray) -> str:
        """Name of an event that follows its predecessor at once, to rounding; empty if there is none.

        A guard that is zero after its own reset has a second, spurious zero there: a leg without length.
        """
        moved = max(float(np.max(np.ptp(view.nodes, axis=0))) for view in self.view(z))
        largest = max(float(np.max(np.abs(view.nodes))) for view in self.view(z))
        if self.word.eventful and moved <= STILL * largest and not self.clocked:
            return self.word.legs[0].name
        lasting = [i for i, leg in enumerate(self.word.legs) if not leg.collapsed]
        shortest = min(lasting, key=lambda i: float(z[self.layout.durations][i]))
        lasts = float(z[self.layout.durations][shortest])
        if not self.word.eventful or lasts > COLLAPSED * self.duration(z):
            return ""
        return self.word.legs[shortest].name

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure, of the map of the smallest section."""
        return monodromy.spectrum(self, z, jacobian)

    def flow_direction(self, z: np.ndarray, i: int, j: int = 0) -> np.ndarray:
        """What a later start of leg i, or of its segment j, on the same orbit differs by: see `monodromy`."""
        return monodromy.flow_direction(self, z, i, j)

    def fallen_back(self, z: np.ndarray, tangent: np.ndarray | None = None) -> bool:
        """Whether an orbit repeats itself, or is its own image, as its parent does."""
        return least.repetitions(self, z) > 1 or bool(least.own_image(self, z))

    # -- along a branch ----------------------------------------------------------------------------------

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; of `known`, its sample on other steps, the observables
        and the reported state are taken over.
        """
        length = float(np.linalg.norm(tangent / weights))
        unit = tangent if abs(length - 1.0) < 1e-14 else tangent / length
        found = self.multipliers(z, linearization.jacobian)
        found = found.beside(float(unit[-1] / weights[-1]))
        trivial = monodromy.trivial_error(self, z, linearization.jacobian)
        orientation, error = linearization.orientation_and_error(unit, weights, self._errors(linearization))
        margins, met = self.margins(z), kinks_along(self, z) if known is None else known.kinks
        accuracy = max(found.accuracy, 2.0 * float(np.nan_to_num(trivial)))
        kinks.refuse(met)
        return Sample(
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            eigenvalues=found.values,
            errors=found.errors,
            rates=rates.of_moduli(self, z, unit, found),
            measures=found.measures,
            unstable=found.unstable(before),
            observables=self._observed(z, found, margins) if known is None else known.observables,
            magnitudes=linearization.magnitudes,
            excess=linearization.excess_in(weights),
            error=error,
            critical=1.0,
            # What the orbit itself is not known to, its multipliers are not either.
            spectrum_error=max(accuracy, error),
            spectrum_accuracy=accuracy,
            sizes=np.nan_to_num(linearization.magnitudes),
            period=self.duration(z),
            trivial_error=trivial,
            kinks=met,
            margins=margins.relative,
            reported=self.reported(z) if known is None else known.reported,
        )

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """Jumps of guards and resets that events lie on."""
        return end_maps.lying(self, z)

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Those that the second orbit crosses, and those that events pass on the step to it."""
        return b.kinks

    def passed_at_events(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """Jumps of guards and resets, and of their slopes, that events pass between two orbits."""
        return end_maps.passed(self, a, b)

    def observables(self, z: np.ndarray, found: Multipliers) -> np.ndarray:
        """Values of `observable_names`, shape (o,)."""
        return self._observed(z, found, self.margins(z))

    def observable(self, name: str, z: np.ndarray) -> float:
        """The value of one observable."""
        found = self.multipliers(z, self.linearize(z).jacobian)
        value = quantities.column(name, self.observable_names, self.observables(z, found))
        assert value is not None, name
        return float(value)

    def _observed(self, z: np.ndarray, found: Multipliers, margins: Any) -> np.ndarray:
        return np.array(observing.values(self, z, found, margins))

    def growth(self, z: np.ndarray) -> np.ndarray:
        """By how much each state is larger after the whole motion: turns of angles, and drifts."""
        x, values = self.first_state(z), self.values_of(z)
        drift = (
            -self.duration(z) * families.directions(self.system, self.pins, x, values) @ z[self.layout.drifts]
        )
        if self.word.image:
            symmetry, p = self.system.symmetry(self.word.image), ParameterValues(**values)
            drift = drift + imaged(symmetry, x + drift, p) - imaged(symmetry, x, p)
        return self.turns + drift

    def motion_of(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The closure's motion: times in seconds, (k,), and states, (k, n); both sides of each event."""
        return observing.motion(self, z)

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state before the first event of the signature, or where the run asks for it, shape (n,)."""
        return observing.reported(self, z)

    def adapted(self, sample: Sample) -> tuple[HybridOrbit, Sample]:
        """The problem on steps made for a solution, and the solution's sample on it.

        Where a leg passes a saddle, what was a solution on the steps of the last orbit may be none on these:
        it is then corrected.
        """
        room = 2 * self.cuts <= cutting.room(self)
        try:
            problem = self.adapted_to(sample.z, sample.weights)
        except NotFinite:  # on other steps the leg's own start no longer leads to its end
            found = cutting.recut(self, sample) if room else None
            if found is None:
                raise
            return found
        if problem.linearize(sample.z).excess_in(sample.weights) > MISSED:
            return problem._corrected(sample)
        if room and cutting.stretched(problem, sample.z):
            found = cutting.recut(problem, sample)
            if found is not None:
                return found
        tangent = problem.into_section(sample.z, sample.tangent)
        linearization = problem.linearize(sample.z)
        again = problem.examine(sample.z, tangent, sample.weights, linearization, sample.unstable, sample)
        orientation = 0.0 if sample.orientation == 0.0 else again.orientation
        return problem, replace(again, orientation=orientation)

    def _corrected(self, sample: Sample) -> tuple[HybridOrbit, Sample]:
        """A solution of other steps corrected on these, and steps made for what it has become."""
        normal = sample.tangent / sample.weights**2
        z = newton_on(self, sample.z, sample.weights, normal)
        problem = self.adapted_to(z, sample.weights)
        there = problem.linearize(z)
        tangent = there.tangent(normal, sample.weights)
        again = problem.examine(z, tangent, sample.weights, there, sample.unstable)
        return problem, replace(again, iterations=sample.iterations)

    def into_section(self, z: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """A tangent moved along the flow into the section of an orbit without events."""
        if self.word.eventful or self.forced:
            return tangent
        assert self.section is not None
        tangent, place, own = tangent.copy(), self.layout.states[0], self.flow_direction(z, 0)
        units = self.mesh.magnitudes[list(self.passages[0].states)]
        if self.duration(z) * np.linalg.norm(own / units) <= AT_REST:
            return tangent  # a cycle that is born there
        shift = -float(self.section.normal @ tangent[place]) / float(self.section.normal @ own)
        tangent[place] += shift * own
        return tangent

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring solutions; limits are the engine's business."""
        shrinks = (in_no_time, onto_an_event) if self.word.eventful else (at_a_point,)
        reasons = (not_conserved, *shrinks, homoclinic, unbounded)
        return next((outcome for reason in reasons if (outcome := reason(self, a, b)) is not None), None)

    def velocity(self, z: np.ndarray) -> np.ndarray:
        """dx/dt at the start."""
        return self.flow_direction(z, 0)

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""
        gradient = np.zeros(len(z))
        gradient[self.layout.durations] = 1.0
        return gradient

    def parameter_error(self, sample: Sample) -> float:
        """What errors of the steps do to the free parameter of an orbit of this period."""
        held = self.duration_gradient(sample.z)
        return error_holding(self, sample.z, sample.weights, held)

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution."""
        return self._errors(self.linearize(z))

    def admissible_at(self, z: np.ndarray) -> bool:
        """Whether a solution is one that the machine can move on."""
        return self.margins(z).admissible

    def slow_place(self, z: np.ndarray) -> SlowPlace:
        """Where the orbit is slowest, and the field there."""
        even, places = np.linspace(0.0, 1.0, AROUND), []
        for view in self.view(z):
            piece, scalars = view.piece, view.scalars
            if scalars[0] == 0.0:
                continue
            field, times = piece.passage.field(PLAIN), np.union1d(piece.steps, even)
            path = piece.at(view.nodes, times, scalars)
            c, scale = field.constants(piece.values(scalars)), self.mesh.variation[list(piece.passage.states)]
            places.append(slow_place_on(field, c, abs(float(scalars[0])), times, path, scale))
        fastest = max(place.fastest for place in places)
        return replace(min(places, key=lambda place: place.speed), fastest=fastest)

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> HybridOrbit:
        """The problem discretised for a solution that is taken up again."""
        return self.adapted_to(z, weights)

    def adapted_to(
        self,
        z: np.ndarray,
        weights: np.ndarray,
        tolerance: float | None = None,
        section: Section | None = None,
    ) -> HybridOrbit:
        """The problem on steps for the orbit of z; an orbit that is a point yet tells no section of its own.

        Raises
        ------
        NotFinite
            If the motion from z ends before the closure does.
        """
        if len(z) != self.size + 1:
            return self.fitting(z).adapted_to(z, weights, tolerance)
        inputs = [self.layout.inputs_of(segment, z) for segment in self.layout.segments]
        magnitudes = self.magnitudes_of(weights)
        most = self._most_steps or most_steps(self._mesh, tolerance or self.discretization.walking)
        try:
            mesh = meshed(
                [self.passages[segment.leg] for segment in self.layout.segments],
                [x for x, _ in inputs],
                [scalars for _, scalars in inputs],
                self.line.constants,
                magnitudes,
                tolerance or self.discretization.walking,
                self.discretization.method,
                self.word.has_halves(self.system),
                most,
            )
        except NotFinite:
            self.effort.spend(STAGES["radau9"] * most)
            raise
        self.effort.spend(2 * STAGES[mesh.method] * sum(len(times) for times in mesh.steps))
        if section is None and not (self.word.eventful or self.forced):
            x, scalars = inputs[0]
            c = self.passages[0].field(PLAIN).constants(np.concatenate([scalars, self.line.constants]))
            own, units = self.passages[0].field(PLAIN)(0.0, x, c), magnitudes[list(self.passages[0].states)]
            # At a Hopf point nothing moves: the section is that with which the cycle was begun.
            still = np.linalg.norm(own / units) <= AT_REST and self.section is not None
            section = self.section if still else section_at(x, own, units)
        # An orbit that has shrunk to no time at all has the unit of those beside it.
        total = abs(self.duration(z)) or (1.0 if self._mesh is None else self._mesh.total)
        problem = self.on(replace(mesh, total=total), section)
        if tolerance is None:  # who walks on asks for the equations there next, and one pass serves both
            problem.linearize(z)
        # Its views need the steps, and the units of its equations need the views.
        problem._mesh = replace(problem.mesh, guards=limits.guard_scales(problem, z))
        return problem

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> HybridOrbit:
        """The same problem, section included, on steps for located points."""
        return self.adapted_to(z, weights, tolerance or self.discretization.marking)._varied(
            section=self.section
        )

    def finest(self, z: np.ndarray, weights: np.ndarray) -> HybridOrbit:
        """The same problem on the finest steps that rounding allows."""
        return self.refined(z, weights, FINEST)

    # -- special points ----------------------------------------------------------------------------------

    def locate(self, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
        """The special point of a kind near a sample, by its augmented system."""
        if kind.test is Test.MARGIN:
            return limits.located(self, which, sample)
        return augmented.located(self, kind, sample, which)

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""
        return augmented.observed(self, name, level, sample)

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        return rates.of_observable(self, name, sample)

    def tangent_at(self, located: Located, near: Sample) -> np.ndarray | None:
        """At a branch point, the tangent of the branch that `near` is on."""
        return branching.tangent_through(self, located, near)

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding."""
        return branching.second_direction(self, z) is not None

    def special_point(self, kind: OrbitKind, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point of a kind, with its normal form, or what it is a limit of."""
        there = located.problem if located.problem is not None else self
        record = describing.described(self, kind, located, sample, s)
        if kind.test is Test.MARGIN:
            limit = self.limits[int(located.vectors["limit"])]
            name = limit.kind
            changes = limit.test in ("duration", "past")
            if changes and neighbours.corners(there, located.z, limit, sample.tangent):
                name = "corner"
            record = replace(record, kind=name, note=limits.place_of(there, limit, located))
        if kind.test is Test.MARK and abs(observing.split(sample.eigenvalues)) < MEET:
            met = "two multipliers meet: each is known to the root of rounding only, their mean far better"
            record = replace(record, note=met if record.note is None else f"{record.note}; {met}")
        values = there.margins(located.z)
        return replace(record, admissible=values.admissible, margin=values.by_name)

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        z = np.array(point.unknowns)
        known = self._mesh is not None and len(z) == self.size + 1
        there = self if known else switching.discretized(self, z)
        return limits.nearest(there, point)

    def stopped(self, located: Located, sample: Sample) -> str:
        """Why an orbit beyond a limit is not the machine's, and what lies next to it."""
        return limits.sentence(self, located)

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        Of a forced orbit the instant at which it begins counts modulo its period, as an angle does.
        """
        if len(z) != self.size + 1:
            return self.fitting(z).nearest_turn(z, near)
        periods = self.periods
        if self.layout.start is not None:
            periods[self.layout.start] = self.rounds * self.duration(z)
        return z + whole_turns(near - z, periods)

    def mirror(self, sample: Sample) -> HybridMirror | None:
        """What takes one half of the branch that leaves an orbit to the other, if a symmetry does."""
        return mirror_of(self, sample)

    def leaving(self, kind: OrbitKind, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a special point of a kind."""
        z = np.array(point.unknowns)
        return kind.branches(switching.discretized(self, z), z, point)

    def doubled_from(self, z: np.ndarray) -> Sequence[Seed]:
        """The orbit of the word run through twice that leaves where a multiplier is -1."""
        return switching.doubled(self, z)

    def unfolded_from(self, z: np.ndarray) -> Sequence[Seed]:
        """The whole orbit without its symmetry that leaves where a multiplier of its half is -1."""
        return switching.unfolded(self, z)

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The branches of other words beyond a limit, and in words what was found, or tried.

        They are asked for twice: where a branch ends, for the words, and where others begin.
        """
        values = tuple(self.values_of(np.array(point.unknowns)).items())
        key = id(self.system), self.word, self.free, values, self.discretization, point.label, point.unknowns
        # What is found keeps the system, and so its id.
        found = remembered(_NEIGHBOURS, key, _MOST_NEIGHBOURS, lambda: (self.system, self._beyond(point)))
        return found[1]

    def _beyond(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        return neighbours.found(self, point)

    def passes(self, z: np.ndarray, points: Sequence[np.ndarray]) -> bool:
        """Whether the orbit of z passes one of some states, as `first_passed` does."""
        return self.first_passed(z, points) is not None

    def first_passed(self, z: np.ndarray, points: Sequence[np.ndarray]) -> int | None:
        """Number of the first of some states at which a leg of the orbit of z starts; which it passes, if it
        begins anywhere. None if there is none.
        """
        periods = np.array([s.period or 0.0 for s in self.system.states])
        if not (self.word.eventful or self.pins):
            curve = np.concatenate([stretch.at(CLOSELY)[1] for stretch in self.stretches(z)])
            scale = self.mesh.variation
            near = (k for k, x in enumerate(points) if distance(curve, x, periods, scale) < 30.0 * ALIKE)
            return next(near, None)
        for number, x in enumerate(points):
            if self._starts_a_leg(z, x, periods):
                return number
        return None

    def _starts_a_leg(self, z: np.ndarray, x: np.ndarray, periods: np.ndarray) -> bool:
        """Whether a leg of the orbit of z starts at a state, up to neutral directions."""
        for place, passage in zip(self.layout.states, self.passages, strict=True):
            start = passage.full(z[place])
            apart = x - start
            apart = apart - whole_turns(apart, periods)
            along = families.directions(self.system, self.pins, start, self.values_of(z))
            apart = families.across(apart, along, self.mesh.variation)
            if float(np.linalg.norm(apart / self.mesh.variation)) < 30.0 * ALIKE:
                return True
        return False

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one orbit."""
        if abs(a.period - b.period) > ALIKE * abs(a.period):
            return False
        if self.cuttable:
            a, b = (
                replace(each, z=cutting.bare(self, each.z), weights=cutting.bare(self, each.weights))
                for each in (a, b)
            )
        if len(a.z) != len(b.z):
            return False
        if not (self.word.eventful or self.forced):
            return self.passes(b.z, [self.first_state(a.z)])
        there = self.nearest_turn(a.z, b.z)
        return bool(np.linalg.norm((there - b.z) / b.weights) < 30.0 * ALIKE)


@cache
def _identity(n: int) -> np.ndarray:
    """The identity; never changed."""
    return np.eye(n)
