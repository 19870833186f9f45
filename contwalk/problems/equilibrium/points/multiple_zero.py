"""Points at which several real eigenvalues vanish together; the orientation does not see an even number.

The equations are those of a fold; their Jacobian is deficient, since v may turn in the null space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.spectrum import spectrum
from contwalk.problems.equilibrium.defining_systems import VANISHED, real_eigenvalue
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.equilibrium.several_directions import Directions, leaving
from contwalk.problems.problem import Located, Sample, Seed, Test

# An unknown is zero but for rounding if it is this part of how far it moves: it would hide a symmetry.
DUST = 1e-13
_UNKNOWN = "more than two branches may meet here; the other ones are not followed"


class MultipleZero(EquilibriumPoint):
    """More than two branches may meet there."""

    label, test, singular, daughters = "BP", Test.TOGETHER, True, 1

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The point near a sample at which F_u has a null space of more than one dimension."""
        return multiple_zero(problem, sample)

    def tangent(self, problem: EquilibriumEquations, located: Located, near: Sample) -> np.ndarray | None:
        """Only continuity tells: that of `near`, shape (N + 1,)."""
        return near.tangent

    def form(self, problem: EquilibriumEquations, located: Located, sample: Sample) -> Form:
        """How many eigenvalues vanish, and how many branches leave."""
        many = located.multiplicity
        found = leaving(problem, located.z, located.error, sample.tangent, many)
        note = f"{many} real eigenvalues vanish together: {_told(problem, found)}"
        return None, None, {"multiplicity": many}, note

    def seeds(self, problem: EquilibriumEquations, point: SpecialPoint) -> Sequence[Seed]:
        """All branches that leave."""
        z, parent = np.array(point.unknowns), np.array(point.tangent)
        many, error = int(point.coefficients["multiplicity"]), point.error or 0.0
        directions = leaving(problem, z, error, parent, many)
        found = () if directions is None else directions.branches
        far = abs(float(z[-1])) or 1.0
        starts = [np.where(np.abs(z) <= DUST * each.reach(far), 0.0, z) for each in found]
        return [
            Seed("BP", start, each.tangent, each.reach, problem)
            for start, each in zip(starts, found, strict=True)
        ]

    def has(self, point: SpecialPoint) -> bool:
        """A branch point with a multiplicity."""
        return point.label == self.label and "multiplicity" in point.coefficients


def _told(problem: EquilibriumEquations, found: Directions | None) -> str:
    """What leaves, as a clause."""
    if found is None or not (found.branches or found.family):
        return _UNKNOWN
    told = [f"{len(found.branches)} other branches leave"] if found.branches else []
    if found.standing:
        told.append(
            f"a family of dimension {found.family} lies at this value of {problem.free}, as far as terms up "
            "to the third order tell; its members are not followed"
        )
    elif found.family:
        told.append(
            f"branches leave in families of dimension {found.family}, as of a continuous symmetry; they are "
            "not followed (declare the symmetry with neutral=(Neutral(...),))"
        )
    return ", and ".join(told)


def multiple_zero(problem: EquilibriumEquations, sample: Sample) -> Located | None:
    """The point near a sample at which F_u has a null space of more than one dimension."""
    located = real_eigenvalue(problem, sample, shift=None, deficient=True)
    # Where all of them vanish together, what they become along the branch is a measure.
    fastest = max((abs(sample.rates[k]) for k in range(len(sample.eigenvalues))), default=0.0)

    def counted(there: Located, part: float = 1e-6) -> Located | None:
        """With how many eigenvalues are none but for their errors, or a part of the largest one."""
        matrix = problem.jacobian(there.z)[:, : problem.size]
        found = spectrum(matrix, np.zeros_like(matrix), problem.errors_of_matrix(there.z))
        least = max(part * np.abs(found.values).max(), VANISHED * np.nan_to_num(fastest))
        count = int(np.sum(np.abs(found.values) <= np.maximum(found.errors, least)))
        return replace(there, multiplicity=count) if count > 1 else None

    near = None if located is None else counted(located)

    def refined() -> Located | None:
        found = located.refine() if located is not None and located.refine is not None else located
        # Where equations are solved to the last digit, one that is next to zero has a point of its own.
        return found and counted(replace(found, refine=None), *([0.0] if found.refined else []))

    return near and replace(near, refine=refined)
