"""What curves of orbits are of: the label of their points, their condition, the multipliers they hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, StartError
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.locus.condensed import limit_system
from contwalk.problems.locus.flips import Flips
from contwalk.problems.locus.orbit_conditions import At, pair_system
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.pair_values import NEAR, pair_values
from contwalk.problems.locus.valued import Valued
from contwalk.problems.locus.valued_curves import KINDS, BranchPoints, SymmetryBreakings, marked_at
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.points.fold import fold_system
from contwalk.quantities import COSINE


@dataclass(frozen=True)
class Folds(OrbitCurve):
    """Folds: a multiplier one."""

    of = "LP"

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Augmented:
        """F_u is singular.

        `further` has the shape (k,).
        """
        return fold_system(orbit, near)

    def critical(self, further: np.ndarray) -> np.ndarray:
        """One.

        `further` has the shape (k,).
        """
        return np.ones(1, dtype=complex)


@dataclass(frozen=True)
class Doublings(Flips):
    """Period doublings."""

    of = "PD"


@dataclass(frozen=True)
class Tori(OrbitCurve):
    """Neimark-Sacker points: a pair of multipliers whose product is one."""

    of = "NS"
    further: int = 1
    observables = (COSINE,)

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Augmented | Valued:
        """L(mu) is singular at both.

        `further` has the shape (k,).
        """
        if abs(float(further[0]) + 1.0) < NEAR:
            return pair_values(near, float(further[0]))
        return pair_system(orbit, near, float(further[0]))

    def asks_explicit(self, further: np.ndarray) -> bool:
        """Not near half a turn, where product and sum of both multipliers are held: these are values.

        `further` has the shape (1,).
        """
        return abs(float(further[0]) + 1.0) >= NEAR

    def critical(self, further: np.ndarray) -> np.ndarray:
        """Both, of length one or real."""
        k = float(further[0])
        root = np.sqrt(complex(k * k - 1.0))
        return np.array([k + root, k - root])

    def genuine(self, further: np.ndarray) -> bool:
        """Where they are no real pair.

        `further` has the shape (k,).
        """
        return abs(float(further[0])) <= 1.0


@dataclass(frozen=True)
class Limits(OrbitCurve):
    """Grazings, changes of the order of events, conditions: a limit that is met."""

    limit: Limit
    further: int = 0
    of: str = field(init=False, default="")  # type: ignore[misc]
    by_values = True  # its own equations know condensed transitions

    def __post_init__(self) -> None:
        object.__setattr__(self, "of", self.limit.label)

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Augmented:
        """The equations of the limit.

        `further` has the shape (k,).
        """
        found = limit_system(orbit, orbit.limits.index(self.limit), near, further)
        if found is None or len(found.start) != len(near.z) + self.further:
            raise NotFinite(f"what passes zero at '{self.limit.name}' is another instant, or none")
        return found

    def facts(self) -> dict[str, Any]:
        """The limit, and how many unknowns it has."""
        kept = self.limit
        told = {"label": kept.label, "kind": kept.kind, "name": kept.name, "leg": kept.leg, "test": kept.test}
        return {"of": self.of, "limit": {**told, "acts": kept.acts}, "further": self.further}


CURVES: dict[str, OrbitCurve] = {curve.of: curve for curve in (Folds(), Doublings(), Tori())}
LIMITS = ("GR", "OC", "AZ")
VALUED = ("BP", "UZ")


def curve_of(facts: Mapping[str, Any]) -> OrbitCurve:
    """What a stored curve is of."""
    if "limit" in facts:
        return Limits(Limit(**facts["limit"]), int(facts["further"]))
    stored = facts.get("curve")
    if stored is None:
        return CURVES[str(facts["of"])]
    return KINDS[stored["name"]](**{key: value for key, value in stored.items() if key != "name"})


def begun_at(
    orbit: Any, point: SpecialPoint, near: At, free: tuple[str, str]
) -> tuple[OrbitCurve, np.ndarray]:
    """The curve of a special point of orbits, and its further unknowns there, shape (k,).

    `orbit` is discretised for the point, `free` are both parameters.

    Raises
    ------
    StartError
        If no curve begins there.
    """
    if point.label == "NS":
        return CURVES["NS"], np.array([np.cos(float(point.coefficients["theta"]))])
    if point.label in CURVES:
        return CURVES[point.label], np.zeros(0)
    if point.label == "UZ":
        return marked_at(orbit, point, free), np.zeros(0)
    if point.label == "BP":
        return _branch_point_at(point)
    which = orbit.limited.limit_of(point)
    found = limit_system(orbit, which, near)
    if found is None:
        raise NotFinite(f"the instant of {point.label} is not found on the orbit")
    further = found.start[len(near.z) :]
    return Limits(orbit.limits[which], len(further)), further


def _branch_point_at(point: SpecialPoint) -> tuple[OrbitCurve, np.ndarray]:
    """The curve of a branch point, and its further unknowns there, shape (k,)."""
    if point.kind == "symmetry-breaking":
        return SymmetryBreakings(), np.zeros(0)
    if not point.coefficients:
        raise StartError(
            f"No curve in two parameters can be followed from {point.name or point.label}: the orbit is its "
            "parent again there.",
            "Start at the point of the parent that the branch was born at.",
        )
    return BranchPoints(), np.zeros(1)
