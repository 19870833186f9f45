"""Equilibria of a smooth system as one free parameter varies, or along a path through the parameter space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.numerics.linear import unit_in
from contwalk.numerics.spectrum import EPSILON, Spectrum, spectrum
from contwalk.problems import neutral as neutrals
from contwalk.problems.capabilities import OwnMeasures
from contwalk.problems.equilibrium import defining_systems as defining
from contwalk.problems.equilibrium import mirror as mirrors
from contwalk.problems.equilibrium import vertical
from contwalk.problems.equilibrium.boundaries import boundaries_of
from contwalk.problems.equilibrium.diagnosis import EquilibriumDiagnosis
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.mode_limits import ModeLimits
from contwalk.problems.equilibrium.points.catalogue import POINT_TYPES
from contwalk.problems.equilibrium.points.hopf import hopf
from contwalk.problems.equilibrium.points.point import EquilibriumPoint
from contwalk.problems.equilibrium.sampling import sampled
from contwalk.problems.held_quantities import sloping
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends
from contwalk.problems.problem import MAX_RE, Linearization, Located, Sample
from contwalk.system import Neutral, System


class Equilibrium(OwnMeasures, EquilibriumEquations):
    """The problem f(x, p) = 0.

    Parameters
    ----------
    system : System
        Its first mode's field is continued; a system with `period` has no equilibria.
    parameters : mapping
        Values of all parameters.
    free : str
        Name of the free parameter, or `path`.
    path : tuple of two mappings, optional
        All parameters at its beginning and end, when `free` is `path`.
    pins : sequence of Neutral
        Neutral directions that are pinned along the branch.
    reference : ndarray, shape (n,), optional
        State at which pins without a parameter hold their direction.
    discretization : Discretization, optional
        Of the orbits that are born on the branch.
    second : str, optional
        A second free parameter, which is the last of the unknowns.
    """

    kind = "equilibrium"
    asymmetries = mirrors.asymmetries
    # Its equations are exact and the same everywhere, and its solutions always the system's.
    anchored = meshed = None

    @cached_property
    def point_types(self) -> tuple[EquilibriumPoint, ...]:
        """The kinds of special points of its branches, the system's own ones last."""
        return (*POINT_TYPES, *self.system.point_types_of(EquilibriumPoint))

    @property
    def diagnosis(self) -> EquilibriumDiagnosis:
        """What is known of places where a branch ends, or cannot go on."""
        return EquilibriumDiagnosis(self)

    @cached_property
    def limited(self) -> ModeLimits | None:
        """The guards that its mode may reach; None of a system without events."""
        return ModeLimits(self) if boundaries_of(self.system) else None

    def in_mode(self, name: str) -> Equilibrium:
        """The same problem of the field of another mode, in which all states exist."""
        given = self.parameters, self.free, self.line.ends, self.pins, self.reference, self.discretization
        return Equilibrium(self.system.beginning_in(name), *given)

    @property
    def observable_names(self) -> tuple[str, ...]:
        """The system's observables, then `max_re`."""
        return (*[o.name for o in self.system.observables], MAX_RE)

    def with_pins(self, pins: Sequence[Neutral], reference: np.ndarray | None = None) -> Equilibrium:
        """The same problem with other pinned directions, held at the state `reference`, shape (n,)."""
        held = self.reference if reference is None else reference
        return Equilibrium(
            self.system, self.parameters, self.free, self.line.ends, pins, held, self.discretization
        )

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
    ) -> Sample:
        """Everything that is watched at a solution.

        z, tangent and weights have the shape (N + 1,); `before` is how many eigenvalues were unstable at the
        solution before, None at the first.
        """
        unit = unit_in(tangent, weights)
        orientation, error = linearization.orientation_and_error(unit, weights, linearization.levels[0])
        curvature = vertical.bending(self, z, unit, weights, linearization, error)
        found = self.spectrum(z, unit, linearization.jacobian, curvature)
        return sampled(
            z,
            unit,
            weights,
            linearization,
            found,
            before,
            orientation=orientation,
            error=error,
            still=found.still,
            observables=self.observables(z, found),
            **({} if self.limited is None else {"margins": self.limited.margins(z, weights)}),
        )

    def spectrum(
        self, z: np.ndarray, tangent: np.ndarray, jacobian: np.ndarray, curvature: np.ndarray | None = None
    ) -> Spectrum:
        """Eigenvalues without the pinned neutral ones; `jacobian` is DF(z), shape (N, N + 1).

        z, tangent and curvature have the shape (N + 1,).

        `curvature` is the derivative of the tangent where the parameter stands still all along the branch.
        """
        n = self.states
        inputs = self.inputs(z)
        rate = self.kernels.rate_of_matrix(*inputs, tangent.tolist())
        rounding = 2.0 * EPSILON * self.kernels.rounding_of_matrix(*inputs)
        declared = [n + j for j, pin in enumerate(self.pins) if pin.name != neutrals.UNDECLARED]
        generators, zeros = jacobian[:n, declared], len(self.pins) - len(declared)
        if curvature is None:
            return spectrum(jacobian[:n, :n], rate, rounding, generators, zeros)
        matrices = jacobian[:n, :n], rate, rounding
        return vertical.spectrum_beside(matrices, tangent[:n], curvature[:n], generators, zeros)

    def observables(self, z: np.ndarray, spectrum_: Spectrum) -> np.ndarray:
        """Values of `observable_names`, shape (o,)."""
        largest = float(np.max(spectrum_.values.real)) if len(spectrum_.values) else float("nan")
        return np.array([*self.measured(z), largest])

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch of these equilibria, as fields of `BranchInfo`."""
        return {
            "problem": self.kind,
            "observables": self.observable_names,
            "unknowns": self.size,
            "spectrum": max(self.states - len(self.pins), 1),
            "settings": neutrals.kept(self.pins, self.line, self.states) | self.system.mode_kept,
        }

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
        return np.maximum(np.abs(z), 1.0)

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one."""
        return bool(np.allclose(self.nearest_turn(a.z, b.z), b.z, rtol=1e-9, atol=1e-12))

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state, shape (n,)."""
        return z[: self.states]

    # -- special points ------------------------------------------------------------------------

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""
        if name != MAX_RE:
            return defining.observed(self, sample, self.observable_kernels(name), level)
        if sample.eigenvalues[sample.leading].imag != 0.0:
            return hopf(self, sample, sample.leading, level)
        return defining.real_eigenvalue(self, sample, level)

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        if name == MAX_RE:
            return sample.rates[sample.leading]
        gradient = self.observable_kernels(name)[1](*self.inputs(sample.z))
        return float(gradient @ sample.tangent)

    def mirror(self, sample: Sample) -> mirrors.Mirror | None:
        """What takes one half of the branch that leaves a solution to the other, if a symmetry does."""
        return mirrors.mirror_of(self, sample)


def pins_at(problem: Equilibrium, z: np.ndarray, matrix: np.ndarray) -> list[Neutral]:
    """Declared directions that are neutral at a solution, and conserved quantities that slope there.

    z has the shape (N + 1,), the matrix df/dx (n, n).
    """
    system, x, values = problem.system, z[: problem.states], problem.values_of(z)
    return [*neutrals.active(system, x, values, matrix), *sloping(system, x, values, matrix, problem.free)]


def solution_at(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    state: np.ndarray,
    path: Ends | None = None,
    at: float | None = None,
    discretization: Discretization | None = None,
) -> tuple[Equilibrium, np.ndarray]:
    """The problem and the vector z that belong to a start, neutral directions pinned where they are neutral.

    The state has the shape (n,), z the shape (N + 1,).

    Raises
    ------
    NotFinite
        If the field is not finite at the start.
    """
    if system.conserved:
        from contwalk.problems.conserving import with_own_values  # compiled functions

        x = np.asarray(state, dtype=float)
        parameters = with_own_values(system, parameters, x, system.modes[0].name)
    problem = Equilibrium(system, parameters, free, path, discretization=discretization)
    z = np.append(np.asarray(state, dtype=float), problem.line.place(at))
    matrix = problem.jacobian(z)[:, : problem.states]
    if not np.all(np.isfinite(matrix)):
        raise NotFinite(
            f"The vector field is not finite at the start: {problem.diagnosis.explain(z)}.",
            "Start elsewhere, or mend the plugin.",
        )
    pins = pins_at(problem, z, matrix)
    if not pins:
        return problem, z
    pinned = problem.with_pins(pins, z[:-1])
    return pinned, np.concatenate([z[:-1], np.zeros(len(pins)), z[-1:]])
