"""What all special points of curves in two parameters share: how they are located, and the record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import kernel_direction
from contwalk.numerics.refine import Solution
from contwalk.problems.equilibrium.defining_systems import solve
from contwalk.problems.locus.conditions import Augmented, Function, defining_system
from contwalk.problems.problem import Located, PointType, Sample, Seed

# A coefficient has a sign if it is this many times its estimated error.
SURE = 10.0
# A kappa this small against where Newton's method began is the double zero, which solves the same equations.
DEGENERATE = 1e-6

# How far from a special point the other curve through it is begun, in typical magnitudes.
BORN_BESIDE = 1e-2

# Kind, coefficients and note of a special point.
Form = tuple[str | None, dict[str, Any], str | None]


class LocusPoint(PointType):
    """A kind of special point of curves of equilibria."""

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """Kind, coefficients and note of a located point.

        Raises
        ------
        numpy.linalg.LinAlgError
            Where its critical directions are not determined.
        """
        return None, {}, None

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        z = located.z
        try:
            kind, coefficients, note = self.form(problem, located, sample)
        except np.linalg.LinAlgError:
            kind, coefficients = None, {}
            note = "degenerate: the critical directions are not determined, so there is no normal form"
        return SpecialPoint(
            label=self.label,
            s=s,
            kind=kind,
            parameters=problem.values_of(z),
            state=dict(zip(problem.system.state_names, z[: problem.states].tolist(), strict=True)),
            spectrum=tuple(complex(v) for v in sample.spectrum),
            error=located.error,
            errors=dict(located.vectors.get("errors", {})),
            coefficients=coefficients,
            note=note,
            unknowns=tuple(z.tolist()),
            tangent=tuple(sample.tangent.tolist()),
        )


def born(problem: Any, point: SpecialPoint, of: str, kappa: float = 0.0) -> list[Seed]:
    """The other curve that passes a special point, begun a little beside it: walking back finds the point."""
    other, z = problem.other(of, np.array(point.unknowns), kappa)
    there = other.linearize(z)
    if not np.all(np.isfinite(there.jacobian)):
        return []
    told = there.magnitudes
    weights = np.where(np.isfinite(told) & (told > 0.0), told, 1.0)
    beside = z + BORN_BESIDE * kernel_direction(there.jacobian, weights)
    return [Seed(of, beside, None, None, other)]


def located_by(
    problem: Any,
    augmented: Augmented,
    sample: Sample,
    kappas: Sequence[float],
    function: Function | None = None,
    positive: bool = False,
) -> Located | None:
    """The point near a sample at which conditions hold, with the function of a kind where it has one.

    `kappas` are where Newton's method begins; with `positive` they belong to frequencies and must stay so.
    The first of them is the curve's own, if it has one.
    """
    plane, pairs = augmented.plane, len(kappas)
    start = augmented.joined(problem.in_plane(sample.z), kappas)
    weights = problem.in_plane(sample.weights)
    scale = augmented.joined(weights, [max(abs(kappa), 1e-300) for kappa in kappas])
    system = defining_system(augmented, scale, start, function)
    size = plane.size

    def described(found: Solution) -> Located | None:
        values = found.values
        z, own = augmented.split(values)[0], values[size : size + pairs]
        if positive and not all(k > DEGENERATE * abs(k0) for k, k0 in zip(own, kappas, strict=True)):
            return None
        errors = {problem.free: float(found.errors[-1]), str(plane.second): float(found.errors[-2])}
        kappa = own[: problem.curve.pairs] if pairs else np.zeros(problem.curve.pairs)
        there = np.concatenate([z[:size], kappa, z[size:]])
        vectors = {"errors": errors, "kappas": own, "augmented": augmented}
        return Located(there, float(found.errors[-1]), vectors, found.refined)

    return solve(system, start, described)
