"""Equilibria of a smooth system as one free parameter varies, or along a path through the parameter space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite
from contwalk.fields.blame import first_not_finite, first_switched
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.numerics.spectrum import EPSILON, Spectrum, spectrum
from contwalk.problems import neutral as neutrals
from contwalk.problems.equilibrium import defining_systems as defining
from contwalk.problems.equilibrium import vertical
from contwalk.problems.equilibrium.equations import GROUPS
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.held_by_force import forced
from contwalk.problems.equilibrium.mirror import Mirror, mirror_of
from contwalk.problems.equilibrium.points.catalogue import POINT_TYPES
from contwalk.problems.equilibrium.points.hopf import hopf
from contwalk.problems.equilibrium.second_direction import second_direction
from contwalk.problems.equilibrium.unbounded import escape
from contwalk.problems.kinks import Kink, between
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import MAX_RE, Linearization, Located, Sample
from contwalk.problems.sample import Rates
from contwalk.system import Neutral, System

# A limit of the parameter this small against its magnitude is zero.
VANISHING = 1e-10


class Equilibrium(EquilibriumEquations):
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
    """

    kind = "equilibrium"
    discretized = False
    beside = 1e-4
    blur = 1e-6
    point_types = POINT_TYPES
    limited = None
    method = ""

    @property
    def observable_names(self) -> tuple[str, ...]:
        """The system's observables, then `max_re`."""
        return (*[o.name for o in self.system.observables], MAX_RE)

    def with_pins(self, pins: Sequence[Neutral], reference: np.ndarray | None = None) -> Equilibrium:
        """The same problem with other pinned directions, held at the state `reference`."""
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
        """Everything that is watched at a solution."""
        length = float(np.linalg.norm(tangent / weights))
        # A stored tangent is a unit vector already; dividing again would change its last digits.
        unit = tangent if abs(length - 1.0) < 1e-14 else tangent / length
        orientation, error = linearization.orientation_and_error(unit, weights, linearization.levels[0])
        curvature = vertical.bending(self, z, unit, weights, linearization, error)
        found = self.spectrum(z, unit, linearization.jacobian, curvature)
        return Sample(
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            eigenvalues=found.values,
            errors=found.errors,
            rates=Rates.known(found.rates),
            measures=found.measures,
            unstable=found.unstable(before),
            still=found.still,
            observables=self.observables(z, found),
            magnitudes=linearization.magnitudes,
            excess=linearization.excess_in(weights),
            error=error,
            forbidden=passed_over(self.system, np.zeros(1), z[None, : self.states], self.values_of(z)),
        )

    def spectrum(
        self, z: np.ndarray, tangent: np.ndarray, jacobian: np.ndarray, curvature: np.ndarray | None = None
    ) -> Spectrum:
        """Eigenvalues without the pinned neutral ones; `jacobian` is DF(z).

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

    @cached_property
    def _switching(self) -> Switching | None:
        """Where the equations are smooth by pieces only; None where they are smooth."""
        program = self.kernels.program
        if not choices_of(program):
            return None
        return Switching(program, [*[("u", i) for i in range(self.size)], ("l", 0)], ("t", 0))

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Those that lie between two equilibria, or that the second one lies on."""
        if self._switching is None:
            return ()
        field, constants = self.system.modes[0].field, self.inputs(a.z)[2:]

        def evaluate(_: np.ndarray, places: np.ndarray) -> Inputs:
            given = {("u", i): x for i, x in enumerate(places.T[:-1])} | {("l", 0): places[:, -1]}
            named = zip(GROUPS[2:], constants, strict=True)
            return {**given, **{(group, i): v for group, own in named for i, v in enumerate(own)}}

        def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
            (_, a), (_, b) = before, after
            places = [(0.0, z[: self.states].tolist()) for z in (a, b)]
            return first_switched(field, places[0], places[1], self.values_of(a), self.values_of(b))

        return between(self._switching, evaluate, (a.z, b.z), b.weights, where)

    def obstacle(self, z: np.ndarray) -> str:
        """Nothing is known of that."""
        return ""

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z is not finite."""
        field = self.system.modes[0].field
        where = first_not_finite(field, 0.0, z[: self.states].tolist(), self.values_of(z))
        return where or "the equations"

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch of these equilibria, as fields of `BranchInfo`."""
        return {
            "problem": self.kind,
            "observables": self.observable_names,
            "unknowns": self.size,
            "spectrum": max(self.states - len(self.pins), 1),
            "settings": neutrals.kept(self.pins, self.line, self.states),
        }

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
        return np.maximum(np.abs(z), 1.0)

    def adapted(self, sample: Sample) -> tuple[Equilibrium, Sample]:
        """Equilibria are not discretised."""
        return self, sample

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Where a pinned direction takes a force to hold, or the branch runs off to infinity."""
        name = forced(self, b)
        if name is not None:
            return Outcome(
                "failed",
                "no_convergence",
                f"Beyond {self.free} = {a.parameter:.10g}, holding the neutral direction '{name}' takes a "
                "force: what solves the equations with that direction pinned is no equilibrium of yours. "
                "End the range there, or declare as neutral only what is neutral everywhere.",
            )
        away = escape(self, a, b)
        if away is None or away.which >= self.states:
            return None
        limit = 0.0 if abs(away.limit) <= VANISHING * b.weights[-1] else away.limit
        state = self.system.state_names[away.which]
        return Outcome(
            "complete",
            "unbounded",
            f"The equilibrium grows without bound as {self.free} tends to {limit:.10g}: {state} is "
            f"{b.z[away.which]:.4g} at {self.free} = {b.parameter:.10g}. Nothing to do.",
        )

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one."""
        return bool(np.allclose(self.nearest_turn(a.z, b.z), b.z, rtol=1e-9, atol=1e-12))

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> Equilibrium:
        """Equilibria are not discretised."""
        return self

    def refined(self, z: np.ndarray, weights: np.ndarray) -> Equilibrium:
        """Equilibria are not discretised."""
        return self

    def finest(self, z: np.ndarray, weights: np.ndarray) -> None:
        """Equilibria are not discretised."""
        return

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

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding."""
        return second_direction(self, z) is not None

    def mirror(self, sample: Sample) -> Mirror | None:
        """What takes one half of the branch that leaves a solution to the other, if a symmetry does."""
        return mirror_of(self, sample)


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

    Raises
    ------
    NotFinite
        If the field is not finite at the start.
    """
    problem = Equilibrium(system, parameters, free, path, discretization=discretization)
    z = np.append(np.asarray(state, dtype=float), problem.line.place(at))
    matrix = problem.jacobian(z)[:, : problem.states]
    if not np.all(np.isfinite(matrix)):
        raise NotFinite(
            f"The vector field is not finite at the start: {problem.explain(z)}.",
            "Start elsewhere, or mend the plugin.",
        )
    pins = neutrals.active(system, z[:-1], problem.values_of(z), matrix)
    if not pins:
        return problem, z
    pinned = problem.with_pins(pins, z[:-1])
    return pinned, np.concatenate([z[:-1], np.zeros(len(pins)), z[-1:]])
