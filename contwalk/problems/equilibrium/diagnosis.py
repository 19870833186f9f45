"""Where a branch of equilibria ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.fields.blame import first_not_finite, first_switched
from contwalk.fields.switching import Inputs
from contwalk.problems import kinks, parameter_kinks
from contwalk.problems.capabilities import Diagnosis
from contwalk.problems.equilibrium.equations import GROUPS
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.held_by_force import forced
from contwalk.problems.equilibrium.second_direction import second_direction
from contwalk.problems.equilibrium.unbounded import escape
from contwalk.problems.kink import Kink, Met
from contwalk.problems.kinks import Course, Place
from contwalk.problems.parameter_kinks import Way, choices_of_parameters
from contwalk.problems.sample import Sample
from contwalk.python_functions import line_of

# How far beside a place without a finite derivative, against its size, the field is asked for a value.
ASIDE = 1e-12


@dataclass(frozen=True)
class EquilibriumDiagnosis(Diagnosis):
    """What is known of such places."""

    problem: EquilibriumEquations

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Where a pinned direction takes a force to hold, or the branch runs off to infinity."""
        problem = self.problem
        free, name = problem.free, forced(problem, b)
        if name is not None:
            return Outcome(
                "failed",
                "no_convergence",
                f"Beyond {free} = {a.parameter:.10g}, holding the neutral direction '{name}' takes a "
                "force: what solves the equations with that direction pinned is no equilibrium of yours. "
                "End the range there, or declare as neutral only what is neutral everywhere.",
            )

        def state(which: int) -> str | None:
            return problem.system.state_names[which] if which < problem.states else None

        return escape(problem, a, b, state, "The equilibrium grows without bound")

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z, shape (N + 1,), is not finite, or a derivative of it."""
        beside = (
            f"{where}, right beside it" for sign in (-1.0, 1.0) if (where := self._without(_aside(z, sign)))
        )
        own = line_of(self.problem.system.modes[0].field).removesuffix(": ") or "the equations"
        unsloped = f"{own}: it has a value, and a derivative has none, as that of a root or of hypot at zero"
        return self._without(z) or next(beside, unsloped)

    def _without(self, z: np.ndarray) -> str | None:
        """The plugin's line at which the field has no value at z, shape (N + 1,)."""
        problem = self.problem
        field = problem.system.modes[0].field
        return first_not_finite(field, 0.0, z[: problem.states].tolist(), problem.values_of(z))

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """Those that lie between an equilibrium a and another solution b, shape (N + 1,)."""
        problem = self.problem
        if problem.switching is None:
            return ()
        course = Course(problem.switching, self._evaluate, np.zeros(1), a[None], _still, self._where)
        own = parameter_kinks.passed(course, self._way(a, b))
        others = choices_of_parameters(problem.switching, problem.free_inputs).others
        return *own, *kinks.passed(others, self._evaluate, (a, b), self._where)

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Those that lie between two equilibria, or that the second one lies on."""
        switching = self.problem.switching
        if switching is None:
            return ()
        met = [met.kink for met in self.passed(a.z, b.z)]
        lying = kinks.lying(switching, self._evaluate, b.z, self._states_of(b.weights), self._where)
        return tuple(dict.fromkeys([*met, *lying]))

    def _evaluate(self, _: np.ndarray, places: np.ndarray) -> Inputs:
        """Inputs of the equations at places, shape (k, N + 1)."""
        constants = self.problem.inputs(places[0])[2:]
        given = {("u", i): x for i, x in enumerate(places.T[:-1])} | {("l", 0): places[:, -1]}
        named = zip(GROUPS[2:], constants, strict=True)
        return {**given, **{(group, i): v for group, own in named for i, v in enumerate(own)}}

    def _where(self, before: Place, after: Place, /, parameters: Any = None) -> str:
        """The plugin's line at which two places differ; z tells their parameters."""
        problem = self.problem
        ends = [(0.0, z[: problem.states].tolist()) for _, z in (before, after)]
        given = [problem.values_of(z) for _, z in (before, after)]
        return first_switched(problem.system.modes[0].field, ends[0], ends[1], given[0], given[1])

    def _way(self, a: np.ndarray, b: np.ndarray) -> Way:
        """From the parameters of an equilibrium a to those of another solution b, shape (N + 1,)."""
        problem, free = self.problem, self.problem.free_inputs

        def at(share: float) -> str:
            place, named = a + share * (b - a), zip(problem.line.names, free.values(), strict=True)
            return ", ".join(f"{name} = {place[k]:.10g}" for name, k in named)

        def blame(low: float, high: float, _: int) -> str:
            moved = np.where(self._states_of(np.ones(len(a))) == 0.0, b - a, 0.0)
            return self._where((0.0, a + low * moved), (0.0, a + high * moved))

        begin, end = ({name: float(z[k]) for name, k in free.items()} for z in (a, b))
        return Way(begin, end, at, blame)

    def _states_of(self, z: np.ndarray) -> np.ndarray:
        """Numbers z, shape (N + 1,), with those of the free parameters set to zero."""
        own = z.copy()
        own[list(self.problem.free_inputs.values())] = 0.0
        return own

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution z, shape (N + 1,), to rounding."""
        return second_direction(self.problem, z) is not None


def _aside(z: np.ndarray, sign: float) -> np.ndarray:
    """A place right beside z, shape (N + 1,)."""
    return z + sign * ASIDE * np.maximum(np.abs(z), ASIDE)


def _still(times: np.ndarray) -> np.ndarray:
    """An equilibrium goes nowhere: it is not asked for states at other times, shape (k,)."""
    raise NotImplementedError
