"""Generalized Hopf points (GH, Bautin): the first Lyapunov coefficient vanishes."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import Critical
from contwalk.problems.locus.normal_forms import bautin_coefficients, lyapunov_known, lyapunov_numerator
from contwalk.problems.locus.plane import FloatPlace
from contwalk.problems.locus.points.point import ConditionsMet, LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test


class GeneralizedHopf(LocusPoint):
    """Hopf points change between super- and subcritical."""

    label, test, of_place = "GH", Test.VALUE, True

    def value(self, problem: Any, sample: Sample) -> float:
        """The first Lyapunov coefficient; NaN of neutral saddles, and at zero eigenvalues: poles."""
        kappa = problem.kappa(sample.z)
        if not kappa > 0.0:
            return float("nan")
        place = FloatPlace(problem.plane, problem.in_plane(sample.z))
        found: Critical = problem.augmented.told(place, [kappa])[0]
        try:
            with np.errstate(divide="ignore", invalid="ignore"):  # where p and q are orthogonal: a pole too
                return lyapunov_known(place, found, float(kappa))
        except np.linalg.LinAlgError:
            return float("nan")  # at a zero eigenvalue itself

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The generalized Hopf point near a sample."""
        kappa = problem.kappa(sample.z)
        return located_by(problem, problem.augmented, sample, [kappa], lyapunov_numerator, positive=True)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of folds of cycles that is born there."""
        births: Any = import_module("contwalk.problems.locus.births")  # compiled flows, where they are wanted
        found: Sequence[Seed] = births.folds_of_cycles(problem, point)
        return found

    def form(self, problem: Any, located: Located[ConditionsMet], sample: Sample) -> Form:
        """The second Lyapunov coefficient, whose sign tells the criticality."""
        numbers = bautin_coefficients(problem.plane, problem.in_plane(located.z), located.data.own[0])
        criticality = (
            "supercritical" if numbers["l2"] < 0.0 else "subcritical" if numbers["l2"] > 0.0 else None
        )
        return None, criticality, numbers, None
