"""Points at which the condition of another curve holds as well: LPPD, LPNS, PDNS, NSNS, GRLP, GRPD, GRNS."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, near_of, together
from contwalk.problems.orbit import scales, variations
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample, Test


class TwoAtOnce(OrbitLocusPoint):
    """A multiplier beside those of the curve passes the unit circle.

    Parameters
    ----------
    label : str
    other : str
        The label of the curve that crosses: `LP`, `PD` or `NS`.
    """

    test = Test.STABILITY

    def __init__(self, label: str, other: str) -> None:
        self.label, self._other = label, other  # type: ignore[misc]
        self.changes = (-2, 2) if other == "NS" else (-1, 1)  # type: ignore[misc]

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A multiplier as the other curve holds it, where something bifurcates on this one."""
        value = complex(sample.eigenvalues[which])
        told = "NS" if value.imag != 0.0 else "LP" if value.real > 0.0 else "PD"
        return told == self._other and problem.curve.genuine(problem.further(sample.z))

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The conditions of both curves."""
        return self.both(problem, sample, float(np.angle(sample.eigenvalues[which])))

    def both(self, problem: Any, sample: Sample, angle: float = 0.0) -> Augmented:
        """The conditions of both curves; `angle` is that of the critical multipliers, where it is unknown."""
        there, own = problem.plane.first(sample.z)
        near = near_of(problem, sample, own)
        curve, width = CURVES[self._other], len(sample.z)
        further = np.full(curve.further, np.cos(angle))
        places = np.arange(width, width + curve.further)
        held = [problem.condition, Held(curve.system(there, near, further), places)]
        return together(problem, sample, held, further)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """Of grazings the kind: both curves cross."""
        return ("interior" if self.label.startswith("GR") else None), {}, None


class ResonantGrazing(TwoAtOnce):
    """On a curve of orbits whose own event arrives without rate: curves of folds or doublings begin there.

    A multiplier is infinite all along, and changes its sign: L(1) and L(-1) are singular at once.
    """

    test = Test.VALUE

    def __init__(self, label: str, other: str) -> None:
        super().__init__(label, other)
        self.changes = (0,)  # type: ignore[misc]

    def value(self, problem: Any, sample: Sample) -> float:
        """How far L(1), or L(-1), is from singular, with the sign of its determinant; NaN of other
        grazings."""
        if problem.curve.limit.test != "rate":
            return float("nan")
        there, own = problem.plane.first(sample.z)
        rows, columns = scales.cycle_scales(there)
        multiplier = 1.0 if self._other == "LP" else -1.0
        matrix = variations.cycle_matrix(there, there.linearize(own).jacobian, multiplier)
        scaled = matrix / rows[:, None] * columns
        return float(np.linalg.slogdet(scaled)[0] * np.linalg.svd(scaled, compute_uv=False)[-1])

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The conditions of both curves."""
        return self.both(problem, sample)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The kind: both curves are tangent there."""
        return "resonant", {}, None
