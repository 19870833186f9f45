"""Curves of special points of equilibria as two parameters vary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.numerics.linear import balanced, unit_in
from contwalk.numerics.spectrum import EPSILON, Spectrum, keeps_volumes, spectrum, taken_out
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.capabilities import OwnMeasures, OwnPlace
from contwalk.problems.equilibrium.sampling import sampled
from contwalk.problems.linearization import Linearization
from contwalk.problems.locus.conditions import Augmented
from contwalk.problems.locus.curves import Curve
from contwalk.problems.locus.diagnosis import LocusDiagnosis
from contwalk.problems.locus.plane import Plane
from contwalk.problems.locus.points.catalogue import POINT_TYPES
from contwalk.problems.locus.points.marked_value import marked_on
from contwalk.problems.problem import Located, Mirror, PointType
from contwalk.problems.sample import Sample
from contwalk.quantities import FREQUENCY_SQUARED
from contwalk.system import Neutral, System

# A pair's kappa has at least this magnitude, against the square of the size of F_u in balanced units.
LEAST_KAPPA = 1e-6
# F_u is no larger than this where magnitudes are told: Newton's method that diverges leads anywhere.
LARGEST = 1e100
TINY = float(np.finfo(float).tiny)


class EquilibriumLocus(OwnMeasures, OwnPlace):
    """A curve of special points of equilibria in two parameters.

    Its unknowns are z = (x, drifts, own, second, first). Along HB curves its own is kappa, minus the square
    of the critical eigenvalues; along BP curves mu, the unfolding, which vanishes; along others there is
    none. Its equations are F = 0 and those of its condition, with borders from the critical vectors at the
    last point.

    Parameters
    ----------
    plane : Plane
        The equilibria, with both parameters free.
    curve : Curve
        What it is of.
    near : ndarray, shape (N,), optional
        The place that the borders are made at.
    spans : pair of float, optional
        Half the widths of the ranges of the second and the first parameter, where these are known.
    """

    kind = "locus"
    meshed = limited = None

    def __init__(
        self, plane: Plane, curve: Curve, near: np.ndarray, spans: tuple[float, float] | None = None
    ) -> None:
        self.plane, self.curve, self.spans = plane, curve, spans
        self.system, self.line = plane.system, plane.line
        self.free, self.parameters, self.pins = plane.free, plane.parameters, plane.pins
        self.states, self.discretization = plane.states, plane.discretization
        self.point_types: Sequence[PointType] = POINT_TYPES[curve.of]
        self.near = self.in_plane(near)
        self.weights: np.ndarray | None = None  # of the metric that it is walked in, where that is known
        self.augmented = Augmented(plane, (curve.condition(plane, self.near, self.own(near)),))
        self.kept: dict[str, Any] = {}  # what kinds of special points need not find out again on one step
        self.size = plane.size + curve.own + 1
        self.periods = np.insert(plane.periods, plane.size, [0.0] * curve.own)

    @property
    def diagnosis(self) -> LocusDiagnosis:
        """What is known of places where a curve ends, or cannot go on."""
        return LocusDiagnosis(self)

    # -- unknowns --------------------------------------------------------------------------------------------

    def in_plane(self, z: np.ndarray) -> np.ndarray:
        """(x, drifts, second, first), shape (N + 2,) of the plane."""
        size = self.plane.size
        return np.concatenate([z[:size], z[size + self.curve.own :]])

    def own(self, z: np.ndarray) -> float:
        """The unknown of its condition at z, shape (N + 1,); zero where it has none."""
        return float(z[self.plane.size]) if self.curve.own else 0.0

    def kappa(self, z: np.ndarray) -> float:
        """Minus the square of the pair that it holds at z, shape (N + 1,); zero where it holds none."""
        return self.own(z) if self.curve.pair else 0.0

    def genuine(self, z: np.ndarray) -> bool:
        """Whether a pair that it holds at z, shape (N + 1,), is no neutral saddle's."""
        return self.kappa(z) > 0.0

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, shape (N + 1,), by name."""
        return self.plane.values_of(self.in_plane(z))

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state, shape (n,)."""
        return z[: self.states]

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        All have the shape (N + 1,).
        """
        return z + whole_turns(near - z, self.periods)

    def image(self, symmetry: str, z: np.ndarray) -> np.ndarray:
        """Image of a solution, shape (N + 1,), under a declared symmetry."""
        image = self.plane.image(symmetry, self.in_plane(z))
        return np.concatenate([image[: self.plane.size], z[self.plane.size :]])

    @property
    def evaluations(self) -> int:
        """Right-hand sides evaluated so far."""
        return self.plane.evaluations

    # -- equations -------------------------------------------------------------------------------------------

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z, shape (N + 1,); not finite where the borders do not fit."""
        try:
            residual, jacobian, levels = self.augmented.values(z)
        except np.linalg.LinAlgError:
            residual = np.full(self.size, np.nan)
            return Linearization(
                residual, np.full((self.size, self.size + 1), np.nan), lambda: (residual, residual)
            )
        return Linearization(residual, jacobian, lambda: self._levels(z, jacobian, levels))

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N, N + 1)."""
        return self.augmented.values(z)[1]

    def _levels(
        self, z: np.ndarray, jacobian: np.ndarray, levels: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Rounding levels of the equations and typical magnitudes of z."""
        own, magnitudes = self.plane.linearize(self.in_plane(z)).levels
        assert magnitudes is not None
        size = self.plane.size
        if self.curve.own and not self.curve.pair:
            magnitudes = np.insert(magnitudes, size, np.nan)  # an unfolding is zero; what it is is noise
        elif self.curve.pair:
            magnitudes = np.insert(magnitudes, size, self._kappa_magnitude(z, magnitudes))
        # Beside a place where all that an unknown does vanishes, any magnitude is told of it.
        told = magnitudes if self.weights is None else np.minimum(magnitudes, self.weights)
        sizes = np.where(told > 0.0, np.maximum(told, np.abs(z)), np.abs(z))
        rows = jacobian[size:]
        return np.concatenate([own, levels + EPSILON * (np.abs(rows) @ sizes) + TINY]), magnitudes

    def _kappa_magnitude(self, z: np.ndarray, magnitudes: np.ndarray) -> float:
        """Typical magnitude of a pair's kappa at z, shape (N + 1,); `magnitudes` are those of the plane.

        Where all of F_u but a nilpotent part is rounding, balanced units make rounding of the whole.
        """
        matrix = self.plane.jacobian(self.in_plane(z))[:, : self.plane.size]
        own = magnitudes[: self.plane.size]
        typical = np.where(np.isfinite(own) & (own > 0.0), own, 1.0)
        each = balanced(matrix)[0], matrix * typical / typical[:, None]
        balance, plain = (min(float(np.abs(one).max()), LARGEST) ** 2 for one in each)
        known = max(abs(self.kappa(z)), LEAST_KAPPA * balance)
        return known if known > EPSILON * plain else LEAST_KAPPA * plain

    # -- what is watched -------------------------------------------------------------------------------------

    @property
    def observable_names(self) -> tuple[str, ...]:
        """The system's observables; along HB curves the square of the frequency as well."""
        return (*[o.name for o in self.system.observables], *([FREQUENCY_SQUARED] * self.curve.pair))

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
    ) -> Sample:
        """As of an equilibrium, with what is watched along its curve. All have the shape (N + 1,)."""
        unit = unit_in(tangent, weights)
        with np.errstate(invalid="ignore"):  # where the borders do not fit nothing is told
            orientation, error = linearization.orientation_and_error(unit, weights, linearization.levels[0])
        found, critical = self.spectrum(z, unit)
        kappa = [self.kappa(z)] * self.curve.pair
        return sampled(
            z,
            unit,
            weights,
            linearization,
            found,
            before,
            orientation=orientation,
            error=error,
            resting=critical,
            observables=np.array([*self.plane.measured(self.in_plane(z)), *kappa]),
        )

    def spectrum(self, z: np.ndarray, tangent: np.ndarray) -> tuple[Spectrum, np.ndarray]:
        """Eigenvalues beside the critical ones, and these, shape (0,), (1,) or (2,), at z, shape (N + 1,)."""
        n, place = self.states, self.in_plane(z)
        inputs, jacobian = self.plane.inputs(place), self.plane.jacobian(place)
        rate = self.plane.kernels.rate_of_matrix(*inputs, self.in_plane(tangent).tolist())
        rounding = 2.0 * EPSILON * self.plane.kernels.rounding_of_matrix(*inputs)
        declared = [n + j for j, pin in enumerate(self.pins) if pin.name != neutrals.UNDECLARED]
        zeros = len(self.pins) - len(declared)
        found = spectrum(jacobian[:n, :n], rate, rounding, jacobian[:n, declared], zeros)
        critical = self.curve.held(self.own(z))
        kept = np.array(taken_out(found.values, critical)[0], dtype=int)
        bordering, errors = None if found.bordering is None else found.bordering[kept], found.errors[kept]
        if len(kept) == len(critical) == 1 and keeps_volumes(jacobian[:n, :n], rate, rounding):
            # lambda and -lambda meet all along: the other one is no further one that passes zero
            bordering, errors = np.ones(1, dtype=bool), np.minimum(errors, 0.01 * np.abs(found.values[kept]))
        rest = Spectrum(found.values[kept], errors, found.rates[kept], bordering=bordering)
        return rest, critical

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable, or of a free parameter, along the curve."""
        if name == FREQUENCY_SQUARED:
            return float(sample.tangent[self.plane.size])
        if name in self.line.names:
            return float(sample.tangent[-1 - self.line.names.index(name)])
        gradient = self.plane.observable_kernels(name)[1](*self.plane.inputs(self.in_plane(sample.z)))
        return float(gradient @ self.in_plane(sample.tangent))

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable, or a free parameter, has the value `level`."""
        return marked_on(self, name, level, sample)

    # -- the branch ------------------------------------------------------------------------------------------

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole curve, as fields of `BranchInfo`."""
        return {
            "problem": self.kind,
            "free": (self.free, str(self.plane.second)),
            "observables": self.observable_names,
            "unknowns": self.size,
            "spectrum": max(self.states - len(self.pins), 1),
            "settings": {
                **neutrals.kept(self.pins, self.line, self.states),
                **self.curve.facts(),
                **self.system.mode_kept,
                "of_problem": "equilibrium",
            },
        }

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
        return np.maximum(np.abs(z), 1.0)

    def other(self, curve: Curve, z: np.ndarray, own: float = 0.0) -> tuple[EquilibriumLocus, np.ndarray]:
        """Another curve through the place of z, and its unknowns there; `own` is its own unknown, if any.

        z has the shape (N + 1,). The unknowns are one more where only the other curve has one of its own, and
        one fewer where only this one has.
        """
        place, size = self.in_plane(z), self.plane.size
        there = np.concatenate([place[:size], [own] * curve.own, place[size:]])
        return EquilibriumLocus(self.plane, curve, there, self.spans), there

    def at(self, z: np.ndarray) -> EquilibriumLocus:
        """The same curve with borders from the critical vectors at z, shape (N + 1,)."""
        return EquilibriumLocus(self.plane, self.curve, z, self.spans)

    def adapted(self, sample: Sample) -> tuple[EquilibriumLocus, Sample]:
        """The curve with borders for what follows a solution, and the solution's sample with them.

        What does not depend on the borders, as the spectrum, stays.
        """
        there, weights = self.at_stored(sample.z, sample.weights), sample.weights
        lin = there.linearize(sample.z)
        with np.errstate(invalid="ignore"):  # where the borders do not fit nothing is told
            orientation, error = lin.orientation_and_error(sample.tangent, weights, lin.levels[0])
        return there, sample.varied(orientation=orientation, error=error, excess=lin.excess_in(weights))

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> EquilibriumLocus:
        """The curve with borders for a solution that is taken up again; both arguments of shape (N + 1,)."""
        there = self.at(z)
        there.weights = weights
        return there

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one."""
        return bool(np.allclose(self.nearest_turn(a.z, b.z), b.z, rtol=1e-9, atol=1e-12))

    def mirror(self, sample: Sample) -> Mirror | None:
        """Both halves of a curve are walked."""
        return None


def plane_of(
    system: System,
    parameters: Mapping[str, float],
    free: tuple[str, str],
    pins: Sequence[Neutral] = (),
    reference: np.ndarray | None = None,
    discretization: Any = None,
) -> Plane:
    """The equilibria of a system with two free parameters, the first and the second.

    `reference` is the state at which pins hold their direction, shape (n,).
    """
    first, second = free
    return Plane(system, parameters, first, None, pins, reference, discretization, second)


def spans_of(ranges: Mapping[str, Sequence[float]], names: tuple[str, str]) -> tuple[float, float] | None:
    """Half the widths of the ranges of two parameters; None where one is not known, or has no end."""
    first, second = (0.5 * (ranges[n][1] - ranges[n][0]) if n in ranges else np.nan for n in names)
    return (float(first), float(second)) if np.isfinite(first + second) else None
