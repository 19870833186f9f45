"""Points at which the condition of another curve holds as well: LPPD, LPNS, PDNS, NSNS, GRLP, GRPD, GRNS."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.point import OrbitLocusPoint, together
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Sample, Test


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
        there, own = problem.plane.first(sample.z)
        near = At(own, np.append(sample.weights[: problem.plane.size], sample.weights[-1]))
        curve, width = CURVES[self._other], len(sample.z)
        angle = float(np.angle(sample.eigenvalues[which]))
        further = np.full(curve.further, np.cos(angle))
        places = np.arange(width, width + curve.further)
        held = [problem.condition, Held(curve.system(there, near, further), places)]
        return together(problem, sample, held, further)
