"""What all special points of curves of orbits share: how they are located, and the record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, PluginError
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_places import Held, evaluated
from contwalk.problems.locus.valued import BESIDE
from contwalk.problems.orbit import normal_forms_of_codim_two, point_records
from contwalk.problems.orbit.augmented import Augmented, along
from contwalk.problems.orbit.multipliers import GLOBAL
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.problem import Located, PointType, Sample

# Kind, coefficients and note of a special point.
Form = tuple[str | None, dict[str, Any], str | None]


class OrbitLocusPoint(PointType):
    """A kind of special point of curves of orbits."""

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The equations whose solution near a sample is such a point; None if there are none."""
        return None

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample."""
        try:
            found: Located | None = problem.located(self.system(problem, sample, which), sample)
        except (NotFinite, PluginError, np.linalg.LinAlgError):
            return None  # Newton's method has gone where the plugin has no motion: as if it did not converge
        return found

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """Kind, coefficients and note of a located point: those of its label's normal form, if it has one.

        Raises
        ------
        numpy.linalg.LinAlgError
            Where its critical directions are not determined.
        NotFinite
            Where there is no motion beside it.
        """
        if self.label not in FORMS:
            return None, {}, None
        there, own = problem.plane.first(located.z)
        return None, FORMS[self.label](there.return_map(own)), LEFT_OUT.get(self.label)

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        there = problem if located.problem is None else located.problem

        def form() -> point_records.Form:
            kind, coefficients, note = self.form(there, located, sample)
            return kind, None, coefficients, note

        more: dict[str, Any] = {"label": self.label, "s": s}
        told = point_records.with_reason(form)
        if there.limited is not None:
            margins = there.margins(located.z)
            more |= {"admissible": margins.admissible, "margin": margins.by_name}
        return point_records.record(there, there, located, sample, sample.spectrum, told, **more)


FORMS: dict[str, Callable[[SectionMap], dict[str, Any]]] = {
    "R1": normal_forms_of_codim_two.one_to_one,
    "R2": normal_forms_of_codim_two.one_to_two,
    "R3": normal_forms_of_codim_two.one_to_three,
    "R4": normal_forms_of_codim_two.one_to_four,
    "LPPD": normal_forms_of_codim_two.fold_and_flip,
    "LPNS": normal_forms_of_codim_two.fold_and_torus,
    "PDNS": normal_forms_of_codim_two.flip_and_torus,
    "NSNS": normal_forms_of_codim_two.two_tori,
}


# What is missing of a normal form.
_CUBIC = "the terms of third order of its normal form, which tell what is born beside it, are not computed"
LEFT_OUT = {"LPPD": _CUBIC, "LPNS": _CUBIC}


def alone(sample: Sample, which: int) -> bool:
    """Whether a complex multiplier has no conjugate among those of a sample.

    Where a second real one meets that of a curve, rounding makes a pair of both, and one of the pair is the
    curve's own.
    """
    value = complex(sample.eigenvalues[which])
    return value.imag != 0.0 and value.conjugate() not in [complex(v) for v in sample.eigenvalues]


def known_to(problem: Any) -> float:
    """What multipliers, and what is made of them, are known to on the steps of a curve."""
    mesh = problem.mesh
    return float(GLOBAL * mesh.amplified * mesh.tolerance)


def near_of(problem: Any, sample: Sample, own: np.ndarray) -> At:
    """The place of a sample, whose orbit is `own`, shape (N + 1,), that a condition is made near."""
    return At(own, problem.of_orbit(sample.weights), float(sample.weights[-2]))


def where_zero(sample: Sample, problem: Any, value: Callable[[Any, np.ndarray], float]) -> Augmented | None:
    """The equations of the point of a curve at which a function of (problem, z) passes zero, near a sample.

    Its slope is taken along the curve: across it the curve's equations hold.

    The result has the shape (p,), a number for each parameter.
    """
    ahead, behind = (value(problem, sample.z + h * sample.tangent) for h in (BESIDE, -BESIDE))
    return along(sample, value, (ahead - behind) / (2.0 * BESIDE))


def together(problem: Any, sample: Sample, held: Sequence[Held], further: np.ndarray) -> Augmented:
    """The equations of an orbit with several conditions, near a sample.

    `further` are the unknowns behind those of the curve, shape (r,): where the conditions have them tells
    `Held`.
    """
    width = len(sample.z)

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return evaluated(there.plane, width, y, held)

    start, scale = np.append(sample.z, further), np.append(sample.weights, np.ones(len(further)))
    return Augmented(evaluate, start, scale)
