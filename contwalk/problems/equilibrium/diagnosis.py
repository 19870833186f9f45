"""Where a branch of equilibria ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Outcome
from contwalk.fields.blame import first_not_finite, first_switched
from contwalk.fields.switching import Inputs
from contwalk.problems.equilibrium.equations import GROUPS
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.held_by_force import forced
from contwalk.problems.equilibrium.second_direction import second_direction
from contwalk.problems.equilibrium.unbounded import escape
from contwalk.problems.kinks import Kink, between
from contwalk.problems.sample import Sample

# A limit of the parameter this small against its magnitude is zero.
VANISHING = 1e-10


@dataclass(frozen=True)
class EquilibriumDiagnosis:
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
        away = escape(problem, a, b)
        if away is None or away.which >= problem.states:
            return None
        limit = 0.0 if abs(away.limit) <= VANISHING * b.weights[-1] else away.limit
        state = problem.system.state_names[away.which]
        return Outcome(
            "complete",
            "unbounded",
            f"The equilibrium grows without bound as {free} tends to {limit:.10g}: {state} is "
            f"{b.z[away.which]:.4g} at {free} = {b.parameter:.10g}. Nothing to do.",
        )

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z, shape (N + 1,), is not finite."""
        problem = self.problem
        field = problem.system.modes[0].field
        where = first_not_finite(field, 0.0, z[: problem.states].tolist(), problem.values_of(z))
        return where or "the equations"

    def obstacle(self, z: np.ndarray) -> str:
        """Nothing is known of what keeps a branch from going on at z, shape (N + 1,)."""
        return ""

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Those that lie between two equilibria, or that the second one lies on."""
        problem = self.problem
        if problem.switching is None:
            return ()
        field, constants = problem.system.modes[0].field, problem.inputs(a.z)[2:]

        def evaluate(_: np.ndarray, places: np.ndarray) -> Inputs:
            given = {("u", i): x for i, x in enumerate(places.T[:-1])} | {("l", 0): places[:, -1]}
            named = zip(GROUPS[2:], constants, strict=True)
            return {**given, **{(group, i): v for group, own in named for i, v in enumerate(own)}}

        def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
            (_, a), (_, b) = before, after
            places = [(0.0, z[: problem.states].tolist()) for z in (a, b)]
            return first_switched(field, places[0], places[1], problem.values_of(a), problem.values_of(b))

        return between(problem.switching, evaluate, (a.z, b.z), b.weights, where)

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution z, shape (N + 1,), to rounding."""
        return second_direction(self.problem, z) is not None
