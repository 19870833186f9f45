"""Points of curves of orbits at which a limit is met: GRLP, GRPD, GRNS, GRGR, and OC, AZ as of orbits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.labels import OF_LOCI
from contwalk.problems.hybrid import limits_in_words
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.locus.condensed import limit_system
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points import crossing, tangency
from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, near_of, together
from contwalk.problems.locus.orbit_points.switching import limit_born
from contwalk.problems.locus.orbit_points.touches import edge_system
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import LimitType, Located, Sample, Seed, Test

# What two grazings at once are told as; how small a margin is at a point that is located roughly.
GRAZINGS, MET = "GRGR", 1e-3
# Curves that are tangent to the grazing curve where the orbit's own event loses its rate.
TANGENT = ("LP", "PD")


class LimitOnCurve(OrbitLocusPoint, LimitType):
    """The orbits of a curve meet a limit.

    Parameters
    ----------
    label : str
    reason : str
        The reason code of a curve that ends there.
    like : str
        The label of orbits under which a run file says what is done there.
    """

    test = Test.MARGIN

    def __init__(self, label: str, reason: str, like: str) -> None:
        self.label, self.reason, self.like = label, reason, like  # type: ignore[misc]
        self.shared, self.declared = like == "OC", like == "AZ"  # type: ignore[misc]

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The equations of the limit, and the condition of the curve."""
        there, own = problem.plane.first(sample.z)
        if which >= len(there.limits):
            return edge_system(problem, sample, problem.limited.limits[which].own, which)
        near = near_of(problem, sample, own)
        found = limit_system(there, which, near)
        if found is None:
            return None
        width, further = len(sample.z), found.start[len(own) :]
        # The limit first: where a leg vanishes it unfolds the orbit's own equations.
        held = [Held(found, np.arange(width, width + len(further))), problem.condition]
        system = together(problem, sample, held, further)
        scale = np.append(sample.weights, found.scale[len(own) :])
        limit = there.limits[which]

        def described(found: Located, y: np.ndarray) -> Located:
            lasting = y[found.problem.orbit.layout.durations][limit.leg]
            return replace(found, limit=which, data=float(y[-1] if limit.test == "dip" else lasting))

        return Augmented(system.evaluate, system.start, scale, described)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample.

        Where an event loses its velocity on a curve of grazings both touches may be one: what has the event
        without velocity is a curve of grazings itself, and the limit alone is met all along it.
        """
        if self.label == GRAZINGS and problem.limited.limits[which].own.test == "rate":
            found = self._at_crossing(problem, sample, which)
            if found is not None:
                return found
        return super().locate(problem, sample, which)

    def _at_crossing(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample at which curves cross, if the limit is met there."""

        def described(found: Located, y: np.ndarray) -> Located:
            there, leg = found.problem, found.problem.limited.limits[which].own.leg
            return replace(found, limit=which, data=float(y[there.orbit.layout.durations][leg]))

        found = crossing.crossing_near(problem, sample, described)
        met = found is not None and abs(problem.margins(found.z).relative[which]) < MET
        return found if met else None

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """That of the curve that `near` is on, where curves cross. Shape (N + k + 2,)."""
        return crossing.tangent_through(located, near)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of that grazing, where the curve of these orbits is told to cross it.

        At a change of order it is the curve of the orbits beyond.
        """
        if self.like == "OC":
            return problem.limited.neighbours(point)[0]
        if self.label not in OF_LOCI or point.kind == "resonant":
            return ()
        return limit_born(problem, point, self.like)

    def has(self, point: SpecialPoint) -> bool:
        """A point of that label where both curves cross, or of two grazings; not one where they are
        tangent."""
        return point.label == self.label and (point.kind != "resonant" or self.label == GRAZINGS)

    def form(self, problem: Any, located: Located[float], sample: Sample) -> Form:
        """The kind, where in the cycle it is met, and where both curves are tangent how they part."""
        limit, told = located.among(problem.limited.limits), {}
        there, own = problem.plane.first(located.z)
        soft = isinstance(there, SoftEquations)
        if limit.kind == "resonant" and problem.curve.of in TANGENT and not soft:
            told = tangency.coefficients(problem, there, own, float(located.z[-2]), problem.curve.of)
        return limit.kind, told, limits_in_words.place_of(problem.orbit, limit.own, located)


_ORDER, _CONDITION = LimitOnCurve("OC", "order_change", "OC"), LimitOnCurve("AZ", "inadmissible", "AZ")


def _on(label: str) -> dict[str, LimitOnCurve]:
    return {"GR": LimitOnCurve(label, "grazing", "GR"), "OC": _ORDER, "AZ": _CONDITION}


# By what the curve is of, then by the label of the limit of orbits.
LIMITS_ON: dict[str, dict[str, LimitOnCurve]] = {
    "LP": _on("GRLP"),
    "PD": _on("GRPD"),
    "NS": _on("GRNS"),
    "GR": _on("GRGR"),
    "BP": _on("GR"),
    "UZ": _on("GR"),
    "OC": _on("GR"),
    "AZ": _on("GR"),
}
