"""Equilibria of a smooth system as one free parameter varies, or along a path through the parameter space."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite, SystemDefinitionError, all_measured, called
from contwalk.fields.blame import first_not_finite, first_switched
from contwalk.fields.kernel import Kernel
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.numerics.linear import Factored
from contwalk.numerics.spectrum import EPSILON, Spectrum, spectrum
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.equilibrium import defining_systems as defining
from contwalk.problems.equilibrium import vertical
from contwalk.problems.equilibrium.equations import GROUPS, equations_of
from contwalk.problems.equilibrium.held_by_force import forced
from contwalk.problems.equilibrium.mirror import Mirror, mirror_of
from contwalk.problems.equilibrium.points.catalogue import POINT_TYPES
from contwalk.problems.equilibrium.points.hopf import hopf
from contwalk.problems.equilibrium.second_direction import second_direction
from contwalk.problems.equilibrium.unbounded import escape
from contwalk.problems.kinks import Kink, between
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import MAX_RE, Linearization, Located, Sample
from contwalk.problems.sample import Rates
from contwalk.python_functions import plain
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

# A magnitude of the parameter this many times its value is looked at again; slopes this many times their
# rounding tell something.
FAR, NOISY = 1e6, 16.0
TINY = float(np.finfo(float).tiny)
# A limit of the parameter this small against its magnitude is zero.
VANISHING = 1e-10


class Equilibrium:
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

    def __init__(
        self,
        system: System,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        pins: Sequence[Neutral] = (),
        reference: np.ndarray | None = None,
        discretization: Discretization | None = None,
    ) -> None:
        if system.period is not None:
            raise SystemDefinitionError(
                f"System '{system.name}' is forced periodically (period=...), so it has no equilibria.",
                "Its periodic orbits are another kind of problem.",
            )
        self.system = system
        self.line = ParameterLine.of(system, parameters, free, path)
        self.free, self.parameters = free, self.line.parameters
        self.pins = tuple(pins)
        self.states = len(system.states)
        self.size = self.states + len(self.pins)
        self.reference = reference
        self.discretization = discretization
        self.evaluations = 0
        self._base, self._direction = self.line.base.tolist(), self.line.direction.tolist()
        self._held = self._held_values()
        declared = [(i, s.scale) for i, s in enumerate(system.states) if s.scale is not None]
        self._declared = [i for i, _ in declared]
        self._scales = [scale for _, scale in declared]
        self.kernels = equations_of(system, self.line.own, self.line.moving, self.pins)
        self._observables: dict[str, tuple[Kernel, Kernel]] = {}
        self.periods = np.array([s.period or 0.0 for s in system.states] + [0.0] * (len(self.pins) + 1))

    @property
    def observable_names(self) -> tuple[str, ...]:
        """The system's observables, then `max_re`."""
        return (*[o.name for o in self.system.observables], MAX_RE)

    def _held_values(self) -> list[float]:
        """Reference values of the pins, in the order in which `Equations` reads them."""
        values: list[float] = []
        for pin in self.pins:
            if self.reference is None:
                raise ValueError("pinned directions need a reference state")
            if pin.pin is None:
                g = neutrals.generator_at(pin, self.reference, self.parameters)
                values += [*self.reference.tolist(), *(g / np.linalg.norm(g)).tolist()]
            else:
                values.append(float(self.reference[self.system.state_names.index(pin.pin)]))
        return values

    def with_pins(self, pins: Sequence[Neutral], reference: np.ndarray | None = None) -> Equilibrium:
        """The same problem with other pinned directions, held at the state `reference`."""
        held = self.reference if reference is None else reference
        return Equilibrium(
            self.system, self.parameters, self.free, self.line.ends, pins, held, self.discretization
        )

    # -- evaluation --------------------------------------------------------------------------------------

    def inputs(self, z: np.ndarray) -> tuple[list[float], ...]:
        """Arguments of the kernels at z."""
        self.evaluations += 1
        values = z.tolist()
        return values[:-1], values[-1:], self._base, self._direction, self._held

    def exact_inputs(self, z: Sequence[Any]) -> tuple[list[Any], ...]:
        """Arguments of the kernels in extended precision."""
        import mpmath

        self.evaluations += 1
        constants = [[mpmath.mpf(v) for v in g] for g in (self._base, self._direction, self._held)]
        return list(z[: self.size]), [z[self.size]], *constants

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, by name; of what is conserved, what the equilibrium has of it."""
        values = self.line.at(float(z[-1]))
        for quantity in self.system.conserved:
            function = plain(quantity.of(self.system.modes[0].name))
            values[quantity.name] = float(function(0.0, z[: self.states], ParameterValues(**values)))
        return values

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N, N + 1), for critical vectors: entries of df/dx that are rounding noise are zero.

        Noise in the place of a zero would couple states that are not, and mislead the balancing of the
        matrix.
        """
        inputs, n = self.inputs(z), self.states
        jacobian = self.kernels.linearization(*inputs)[:, 1:]
        noise = 4.0 * EPSILON * self.kernels.rounding_of_matrix(*inputs)
        jacobian[:n, :n][np.abs(jacobian[:n, :n]) <= noise] = 0.0
        return jacobian

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z."""
        inputs = self.inputs(z)
        table = self.kernels.linearization(*inputs)
        return Linearization(table[:, 0], table[:, 1:], lambda: self._levels(z, inputs, table[:, 1:]))

    def _levels(
        self, z: np.ndarray, inputs: tuple[list[float], ...], jacobian: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Rounding levels of the equations and typical magnitudes of z."""
        derivatives, sizes = np.abs(jacobian), np.abs(z)
        # Beside the rounding of the evaluation: z itself is only known to half an ulp ...
        level = EPSILON * (self.kernels.rounding(*inputs) + derivatives @ sizes) + TINY
        shares = derivatives * sizes
        telling = self._telling(z, derivatives, shares, level / EPSILON)
        magnitudes = self._magnitudes(z, derivatives, shares, telling)
        # ... and an unknown that is zero only to half an ulp of what would matter.
        level = level + EPSILON * (derivatives @ np.where(magnitudes > 0, magnitudes, 0.0))
        return level, magnitudes

    def _telling(
        self, z: np.ndarray, derivatives: np.ndarray, shares: np.ndarray, terms: np.ndarray
    ) -> np.ndarray:
        """The sizes of the equations' terms, shape (N,), zero where they are nothing but noise of zero.

        An unknown that another equation cannot tell from zero may be zero; an equation that has no terms
        then tells no magnitudes either, as where it is zero exactly.
        """
        unseen = (shares > 0.0) & (shares < EPSILON * terms[:, None]) & (derivatives > 1e-100)
        noise = np.logical_or.reduce(unseen, axis=0)
        noise[-1] = False  # the parameter is what it is
        if not noise.any():
            return terms
        zeroed = np.where(noise, 0.0, z)
        inputs = self.inputs(zeroed)
        rounding = self.kernels.rounding(*inputs)
        if (rounding > 0.0).all():  # each has terms still
            return terms
        sizes = np.abs(self.kernels.linearization(*inputs)[:, 1:]) @ np.abs(zeroed)
        if ((rounding == 0.0) & (sizes > 0.0)).any():  # of slopes that are no noise themselves?
            sizes = np.abs(self.jacobian(zeroed)) @ np.abs(zeroed)
        return np.where(rounding + sizes > 0.0, terms, 0.0)

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

    def _magnitudes(
        self, z: np.ndarray, derivatives: np.ndarray, shares: np.ndarray, terms: np.ndarray
    ) -> np.ndarray:
        """Typical magnitudes of z, shape (N + 1,); NaN where neither z nor the equations tell.

        Declared scales are used as they are. Otherwise it is the size of the unknown, or the change of it
        that would matter in some equation (against the size of its terms, shape (N,)), whichever is larger.
        An equation in which the unknown itself is the largest term, as x' = v, tells nothing about it.
        """
        tells, column, size = np.isfinite(terms) & (terms > 1e-290), terms[:, None], np.abs(z)
        told = np.isfinite(derivatives) & (derivatives > 1e-100) & tells[:, None]
        told &= shares < 0.4 * column
        matters = (np.where(told, column, np.inf) / np.where(told, derivatives, 1.0)).min(axis=0)
        natural = np.maximum(size, np.where(matters < np.inf, matters, 0.0))
        # What no equation tells and is this small is rounding noise of zero, of unknown magnitude.
        natural[(matters == np.inf) & (natural < 1e-13)] = np.nan
        natural[self._declared] = self._scales
        natural[self.states : self.size] = np.nan  # drifts are zero; what they are is noise
        # The parameter, and unknowns that may be noise of zero, where so little of them is much.
        far = (natural > FAR * size) & ((z != 0.0) | (np.arange(len(z)) == self.size))
        far[self._declared] = False
        if not far.any():
            return natural
        natural[far] = np.nan
        for i in np.flatnonzero(far):
            natural[i] = self._magnitude(z, int(i), derivatives[:, i], terms, natural)
        return natural

    def _magnitude(
        self, z: np.ndarray, which: int, slopes: np.ndarray, terms: np.ndarray, magnitudes: np.ndarray
    ) -> float:
        """Of one unknown, the change of it that would matter in some equation whose slope is no noise.

        Where that with which it is multiplied is zero to rounding, it tells nothing; one over that would be
        its magnitude.
        """
        along = np.zeros(len(z))
        along[which] = 1.0
        known = np.maximum(np.abs(z), np.where(np.isfinite(magnitudes), magnitudes, 1.0))
        known[[which, -1]] = abs(z[which]), abs(z[-1])
        noise = EPSILON * (np.abs(self.kernels.jacobian_of_first(*self.inputs(z), along.tolist())) @ known)
        told = (slopes > NOISY * noise) & (slopes > 1e-100) & (terms > 1e-290)
        size = float(abs(z[which]))
        if np.any(told):
            return max(size, float(np.min(terms[told] / slopes[told])))
        return size if size >= 1e-13 else float("nan")

    def observable_kernels(self, name: str) -> tuple[Kernel, Kernel]:
        """Value and gradient of a declared observable."""
        if name not in self._observables:
            function = next(o.function for o in self.system.observables if o.name == name)
            self._observables[name] = self.kernels.of_observable(function)
        return self._observables[name]

    def measured(self, z: np.ndarray) -> list[float]:
        """Values of the system's observables."""
        x = z[: self.states].reshape(1, -1)
        p = ParameterValues(**self.values_of(z))
        return all_measured(self._named, np.zeros(1), x, p)

    @cached_property
    def _named(self) -> list[tuple[str, Callable[..., float]]]:
        """The system's observables, each with what it is called in sentences."""
        return [(f"observable '{o.name}'", o.function) for o in self.system.observables]

    def observables(self, z: np.ndarray, spectrum_: Spectrum) -> np.ndarray:
        """Values of `observable_names`, shape (o,)."""
        largest = float(np.max(spectrum_.values.real)) if len(spectrum_.values) else float("nan")
        return np.array([*self.measured(z), largest])

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

    def solve_states(self, z: np.ndarray, right: np.ndarray) -> np.ndarray:
        """A^-1 right, with the pins in place, shape (n,)."""
        full = np.append(right, np.zeros(self.size - self.states))
        return Factored(self.jacobian(z)[:, : self.size]).solve(full)[: self.states]

    def crossing_rate(self, z: np.ndarray, q: np.ndarray, p: np.ndarray) -> float:
        """d Re(eigenvalue) / d(parameter) along the branch, for critical vectors with p.q = 1."""
        jacobian = self.jacobian(z)
        along = Factored(jacobian[:, : self.size]).solve(-jacobian[:, -1])
        rate = self.kernels.rate_of_matrix(*self.inputs(z), [*along.tolist(), 1.0])
        return float((p @ rate @ q).real)

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

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one."""
        return z + whole_turns(near - z, self.periods)

    def image(self, symmetry: str, z: np.ndarray) -> np.ndarray:
        """Image of a solution under a declared symmetry."""
        declared = next(s for s in self.system.symmetries if s.name == symmetry)
        x = np.zeros(self.states)
        p = ParameterValues(**self.values_of(z))
        called(f"symmetry '{symmetry}'", declared.map, 0.0, z[: self.states].copy(), p, x)
        return np.concatenate([x, z[self.states :]])

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
