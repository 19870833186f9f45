"""Equations of equilibria at values of the parameters: what they are, and how their unknowns are read.

Beside the data stands here only what reads them: residual and Jacobian, their rounding, the magnitudes that
they tell of the unknowns. What is computed of equilibria are functions over this class, and `Equilibrium`
offers them to the engine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import PluginError, SystemDefinitionError, all_measured, called, measured
from contwalk.fields.kernel import Kernel
from contwalk.fields.switching import Switching, choices_of
from contwalk.numerics.linear import Factored
from contwalk.numerics.spectrum import EPSILON
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.equilibrium.equations import equations_of
from contwalk.problems.held_quantities import HeldQuantity
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.problems.problem import Linearization, Problem
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

# A magnitude of the parameter this many times its value is looked at again; slopes this many times their
# rounding tell something.
FAR, NOISY = 1e6, 16.0
# Slopes by an unknown below this part of their terms are what a solution's error leaves of zero, as beside a
# Bogdanov-Takens point.
CANCELLED = 1e-6
TINY = float(np.finfo(float).tiny)


class EquilibriumEquations(Problem):
    """The equations f(x, p) = 0 along a line of parameters; see `Equilibrium` for its parameters.

    With a `second` free parameter z is (x, drifts, second, first); it has one number more than there are
    equations and the line's parameter.
    """

    def __init__(
        self,
        system: System,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        pins: Sequence[Neutral] = (),
        reference: np.ndarray | None = None,
        discretization: Discretization | None = None,
        second: str | None = None,
    ) -> None:
        if system.period is not None:
            raise SystemDefinitionError(
                f"System '{system.name}' is forced periodically (period=...), so it has no equilibria.",
                "Its periodic orbits are another kind of problem.",
            )
        self.system = system
        self.line = ParameterLine.of(system, parameters, free, path, second)
        self.free, self.parameters, self.second = free, self.line.parameters, second
        self.pins = tuple(pins)
        self.states = len(system.states)
        self.size = self.states + len(self.pins)
        self.reference = reference
        self.discretization = discretization
        self._evaluations = 0
        self._base, self._direction = self.line.base.tolist(), self.line.direction.tolist()
        self._held = self._held_values()
        declared = [(i, s.scale) for i, s in enumerate(system.states) if s.scale is not None]
        self._declared = [i for i, _ in declared]
        self._scales = [scale for _, scale in declared]
        self.kernels = equations_of(system, self.line.own, self.line.moving, self.pins, second)
        self._observables: dict[str, tuple[Kernel, Kernel]] = {}
        self._guards: dict[str, tuple[Kernel, Kernel]] = {}
        others = self.kernels.unknowns + 1 - self.states
        self.periods = np.array([s.period or 0.0 for s in system.states] + [0.0] * others)

    @property
    def evaluations(self) -> int:
        """Right-hand sides evaluated so far."""
        return self._evaluations

    def in_mode(self, name: str) -> EquilibriumEquations:
        """The same equations of the field of another mode, in which all states exist."""
        raise NotImplementedError("curves of equilibria keep to their mode")

    def _held_values(self) -> list[float]:
        """Reference values of the pins, in the order in which `Equations` reads them."""
        values: list[float] = []
        for pin in self.pins:
            if self.reference is None:
                raise ValueError("pinned directions need a reference state")
            if isinstance(pin, HeldQuantity):
                continue
            if pin.pin is None:
                g = neutrals.generator_at(pin, self.reference, self.parameters)
                values += [*self.reference.tolist(), *(g / np.linalg.norm(g)).tolist()]
            else:
                values.append(float(self.reference[self.system.state_names.index(pin.pin)]))
        return values

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, shape (N + 1,), by name.

        Of what is conserved, what the equilibrium has of it.
        """
        values = self.line.at(float(z[-1]))
        if self.second is not None:
            values[self.second] = float(z[-2])
        for quantity in self.system.conserved:
            function, p = quantity.of(self.system.modes[0].name), ParameterValues(**values)
            what = f"conserved quantity '{quantity.name}'"
            try:
                values[quantity.name] = measured(what, function, 0.0, z[: self.states], p)
            except PluginError:  # as of a logarithm where nothing is left: the equations do not need it
                values[quantity.name] = float("nan")
        return values

    def inputs(self, z: np.ndarray) -> tuple[list[float], ...]:
        """Arguments of the kernels at z, shape (N + 1,)."""
        self._evaluations += 1
        values = z.tolist()
        return values[:-1], values[-1:], self._base, self._direction, self._held

    def exact_inputs(self, z: Sequence[Any]) -> tuple[list[Any], ...]:
        """Arguments of the kernels in extended precision."""
        import mpmath

        self._evaluations += 1
        constants = [[mpmath.mpf(v) for v in g] for g in (self._base, self._direction, self._held)]
        unknowns = self.kernels.unknowns
        return list(z[:unknowns]), [z[unknowns]], *constants

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z, shape (N + 1,)."""
        table, rounding = self._evaluated(self.inputs(z))
        jacobian = table[:, 1:]
        found = Linearization(table[:, 0], jacobian, lambda: self._levels(z, jacobian, rounding))
        found.evaluation = lambda: _evaluation(z, np.abs(jacobian), rounding)
        return found

    def _evaluated(self, inputs: tuple[list[float], ...]) -> tuple[np.ndarray, np.ndarray]:
        """F beside its Jacobian, shape (N, N + 2), and the bounds of F's rounding in epsilons, shape (N,)."""
        table = self.kernels.linearization_and_rounding(*inputs)
        if np.isnan(table[0, 0]):  # where a bound has no value F may have one
            return self.kernels.linearization(*inputs), self.kernels.rounding(*inputs)
        return table[:, :-1], table[:, -1]

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), (N, N + 1), a column more with a `second`: entries of df/dx that are noise are zero.

        Noise in the place of a zero would couple states that are not, and mislead the balancing of the
        matrix.
        """
        inputs, n = self.inputs(z), self.states
        jacobian = self._evaluated(inputs)[0][:, 1:]
        noise = 4.0 * EPSILON * self.kernels.rounding_of_matrix(*inputs)
        jacobian[:n, :n][np.abs(jacobian[:n, :n]) <= noise] = 0.0
        return jacobian

    def errors_of_matrix(self, z: np.ndarray) -> np.ndarray:
        """Bounds of the rounding of F_u, (N, N), at a z that is only known to half an ulp itself."""
        inputs, n, size = self.inputs(z), self.states, self.size
        errors = np.zeros((size, size))
        errors[:n, :n] = self.kernels.rounding_of_matrix(*inputs)
        for k in np.flatnonzero(z):
            along = np.zeros(len(z))
            along[k] = z[k]
            errors += np.abs(self.kernels.jacobian_of_first(*inputs, along.tolist())[:, :size])
        return EPSILON * (errors + size * np.abs(self.jacobian(z)[:, :size]))

    def solve_states(self, z: np.ndarray, right: np.ndarray) -> np.ndarray:
        """A^-1 right, with the pins in place, shape (n,)."""
        full = np.append(right, np.zeros(self.size - self.states))
        return Factored(self.jacobian(z)[:, : self.size]).solve(full)[: self.states]

    def crossing_rate(self, z: np.ndarray, q: np.ndarray, p: np.ndarray) -> float:
        """d Re(eigenvalue) / d(parameter) along the branch, for critical vectors, shape (n,), with p.q = 1.

        z has the shape (N + 1,).
        """
        jacobian = self.jacobian(z)
        along = Factored(jacobian[:, : self.size]).solve(-jacobian[:, -1])
        rate = self.kernels.rate_of_matrix(*self.inputs(z), [*along.tolist(), 1.0])
        return float((p @ rate @ q).real)

    def observable_kernels(self, name: str) -> tuple[Kernel, Kernel]:
        """Value and gradient of a declared observable."""
        if name not in self._observables:
            function = next(o.function for o in self.system.observables if o.name == name)
            self._observables[name] = self.kernels.of_function(function, along=True)
        return self._observables[name]

    def guard_kernels(self, name: str) -> tuple[Kernel, Kernel]:
        """Value and gradient by z of a transition's guard."""
        if name not in self._guards:
            guard = next(each.guard for each in self.system.transitions if each.name == name)
            self._guards[name] = self.kernels.of_function(guard, along=False)
        return self._guards[name]

    def measured(self, z: np.ndarray) -> list[float]:
        """Values of the system's observables at z, shape (N + 1,), in the order of their declaration."""
        x = z[: self.states].reshape(1, -1)
        p = ParameterValues(**self.values_of(z))
        return all_measured(self._named, np.zeros(1), x, p)

    @cached_property
    def _named(self) -> list[tuple[str, Callable[..., float]]]:
        """The system's observables, each with what it is called in sentences."""
        return [(f"observable '{o.name}'", o.function) for o in self.system.observables]

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        All have the shape (N + 1,).
        """
        return z + whole_turns(near - z, self.periods)

    def image(self, symmetry: str, z: np.ndarray) -> np.ndarray:
        """Image of a solution, shape (N + 1,), under a declared symmetry."""
        declared = next(s for s in self.system.symmetries if s.name == symmetry)
        x = np.zeros(self.states)
        p = ParameterValues(**self.values_of(z))
        called(f"symmetry '{symmetry}'", declared.map, 0.0, z[: self.states].copy(), p, x)
        return np.concatenate([x, z[self.states :]])

    @cached_property
    def switching(self) -> Switching | None:
        """Where the equations are smooth by pieces only; None where they are smooth."""
        program = self.kernels.program
        if not choices_of(program):
            return None
        return Switching(program, [*[("u", i) for i in range(self.kernels.unknowns)], ("l", 0)], ("t", 0))

    @cached_property
    def free_inputs(self) -> dict[tuple[str, int], int]:
        """The free parameters by their names as inputs of the equations, with their places in z."""
        last = self.kernels.unknowns
        names = {("l", 0): last}
        return names if self.second is None else {**names, ("u", last - 1): last - 1}

    # -- rounding, and magnitudes ----------------------------------------------------------------------------

    def _levels(
        self, z: np.ndarray, jacobian: np.ndarray, rounding: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Rounding levels of the equations and typical magnitudes of z."""
        derivatives, sizes = np.abs(jacobian), np.abs(z)
        level = _evaluation(z, derivatives, rounding)
        shares, some = derivatives * sizes, derivatives > 1e-100
        telling = self._telling(z, shares, some, level / EPSILON)
        magnitudes = self._magnitudes(z, derivatives, shares, some, telling)
        # ... and an unknown that is zero only to half an ulp of what would matter.
        level = level + EPSILON * (derivatives @ np.where(magnitudes > 0, magnitudes, 0.0))
        return level, magnitudes

    def _telling(self, z: np.ndarray, shares: np.ndarray, some: np.ndarray, terms: np.ndarray) -> np.ndarray:
        """The sizes of the equations' terms, shape (N,), zero where they are nothing but noise of zero.

        An unknown that another equation cannot tell from zero may be zero; an equation that has no terms
        then tells no magnitudes either, as where it is zero exactly.
        """
        unseen = (shares > 0.0) & (shares < EPSILON * terms[:, None]) & some
        noise = np.logical_or.reduce(unseen, axis=0)
        noise[self.size :] = False  # parameters are what they are
        if not noise.any():
            return terms
        zeroed = np.where(noise, 0.0, z)
        table, rounding = self._evaluated(self.inputs(zeroed))
        if (rounding > 0.0).all():  # each has terms still
            return terms
        sizes = np.abs(table[:, 1:]) @ np.abs(zeroed)
        if ((rounding == 0.0) & (sizes > 0.0)).any():  # of slopes that are no noise themselves?
            sizes = np.abs(self.jacobian(zeroed)) @ np.abs(zeroed)
        return np.where(rounding + sizes > 0.0, terms, 0.0)

    def _magnitudes(
        self, z: np.ndarray, derivatives: np.ndarray, shares: np.ndarray, some: np.ndarray, terms: np.ndarray
    ) -> np.ndarray:
        """Typical magnitudes of z, shape (N + 1,); NaN where neither z nor the equations tell.

        Declared scales are used as they are. Otherwise it is the size of the unknown, or the change of it
        that would matter in some equation (against the size of its terms, shape (N,)), whichever is larger.
        An equation in which the unknown itself is the largest term, as x' = v, tells nothing about it.
        """
        # Comparisons do not hold of NaN, nor of shares of a slope that is infinite: these tell nothing.
        column, size = terms[:, None], np.abs(z)
        told = some & (column > 1e-290) & (shares < 0.4 * column)
        matters = np.divide(column, derivatives, out=np.full(told.shape, np.inf), where=told).min(axis=0)
        silent = matters == np.inf
        matters[silent] = 0.0
        natural = np.maximum(size, matters)
        # What no equation tells and is this small is rounding noise of zero, of unknown magnitude.
        natural[silent & (natural < 1e-13)] = np.nan
        if self._declared:
            natural[self._declared] = self._scales
        natural[self.states : self.size] = np.nan  # drifts are zero; what they are is noise
        far = natural > FAR * size
        return self._near(z, far, derivatives, terms, natural) if far.any() else natural

    def _near(
        self, z: np.ndarray, far: np.ndarray, derivatives: np.ndarray, terms: np.ndarray, natural: np.ndarray
    ) -> np.ndarray:
        """Magnitudes with those looked at again that are far larger than what they are of.

        These are parameters, and unknowns that may be noise of zero, where so little of them is much; of
        those that are zero exactly the ones with a slope that is noise.
        """
        zero = np.flatnonzero(far[: self.states] & (z[: self.states] == 0.0))
        if len(zero):  # of these many are in many machines
            rounding = 2.0 * EPSILON * self.kernels.rounding_of_matrix(*self.inputs(z))[:, zero]
            slopes = derivatives[: self.states, zero]
            far[zero] = np.logical_or.reduce((slopes > 0.0) & (slopes <= NOISY * rounding), axis=0)
        far[self._declared] = False
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
        known[which], known[self.size :] = abs(z[which]), np.abs(z[self.size :])
        noise = EPSILON * (np.abs(self.kernels.jacobian_of_first(*self.inputs(z), along.tolist())) @ known)
        least = NOISY * noise if which >= self.size else CANCELLED / EPSILON * noise
        told = (slopes > least) & (slopes > 1e-100) & (terms > 1e-290)
        size = float(abs(z[which]))
        if np.any(told):
            return max(size, float(np.min(terms[told] / slopes[told])))
        return size if size >= 1e-13 else float("nan")


def _evaluation(z: np.ndarray, derivatives: np.ndarray, rounding: np.ndarray) -> np.ndarray:
    """Rounding levels, shape (N,), of equations evaluated at a z that is only known to half an ulp itself."""
    return EPSILON * (rounding + derivatives @ np.abs(z)) + TINY
