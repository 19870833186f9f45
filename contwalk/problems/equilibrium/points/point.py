"""What special points of equilibria, and of their curves, share: the record; each kind says what it is of."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.problem import Located, PointType, Sample
from contwalk.problems.sample import within
from contwalk.system.held import settled

# Kind, criticality, coefficients and note of a special point.
Form = tuple[str | None, str | None, dict[str, Any], str | None]


class EquilibriumPoint(PointType):
    """A kind of special point of equilibria."""

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """Kind, criticality, coefficients and note of a located point.

        Raises
        ------
        numpy.linalg.LinAlgError
            Where its critical directions are not determined.
        """
        return None, None, {}, None

    def errors(self, problem: Any, located: Located, sample: Sample) -> dict[str, float]:
        """Estimated errors by free parameter, where there are several."""
        return {}

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        z = located.z
        try:
            kind, criticality, coefficients, note = self._told(problem, located, sample)
        except np.linalg.LinAlgError:
            kind, criticality, coefficients = None, None, {}
            note = "degenerate: the critical directions are not determined, so there is no normal form"
        return SpecialPoint(
            label=self.label,
            s=s,
            kind=kind,
            parameters=settled(problem.system, problem.values_of(z) | {problem.free: float(z[-1])}),
            state=dict(zip(problem.system.state_names, z[: problem.states].tolist(), strict=True)),
            spectrum=tuple(complex(v) for v in sample.spectrum),
            error=located.error,
            errors=self.errors(problem, located, sample),
            criticality=criticality,
            coefficients=coefficients,
            note=note,
            unknowns=tuple(z.tolist()),
            tangent=tuple(sample.tangent.tolist()),
            admissible=problem.limited is None or within(problem.limited.margins(z, sample.weights)),
        )

    def _told(self, problem: Any, located: Located, sample: Sample) -> Form:
        kind, criticality, coefficients, note = self.form(problem, located, sample)
        if located.turns:
            turns = "the parameter turns here as well: a fold that is not told apart"
            note = f"{note}; {turns}" if note else turns
        return kind, criticality, coefficients, note
