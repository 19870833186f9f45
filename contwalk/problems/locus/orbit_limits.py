"""Limits along curves of orbits through events: beyond one, the curve's orbits are not the machine's."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.hybrid import limits_in_words, locating_limits
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.locus import beyond_order
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_curves import Limits
from contwalk.problems.locus.orbit_points.limits import LIMITS_ON
from contwalk.problems.locus.orbit_points.touches import edges, inside
from contwalk.problems.problem import LimitType, Located, Sample, Seed

# Limits of two events that are one, at a leg that lasts no time.
OF_TWO_EVENTS = ("duration", "start", "end", "past")
# A touch is at an edge of its leg within this part of it.
AT_EDGE = 1e-6

ELSEWHERE = "Curves of the orbits beyond are not begun there: start at points of their own branches."


@dataclass(frozen=True)
class LimitOnCurve:
    """A limit of the orbits of a curve, as the engine sees it.

    Parameters
    ----------
    own : Limit
        That of the orbits.
    of : str
        What the curve is of.
    """

    own: Limit
    of: str

    @property
    def kind(self) -> str | None:
        """Of a grazing `resonant` where the orbit's own event loses its rate; one that would happen earlier
        than it does is touched like any other."""
        if self.own.label != "GR":
            return self.own.kind
        return "interior" if self.own.test == "dip" else "resonant"

    @property
    def name(self) -> str:
        """What it is."""
        return self.own.name

    @property
    def acts(self) -> bool:
        """Whether something happens there."""
        return self.own.acts

    @property
    def type(self) -> LimitType:
        """The kind of special point where it passes zero."""
        return LIMITS_ON[self.of][self.own.label]

    @property
    def rank(self) -> int:
        """Which of several that tell the same is told."""
        return self.own.rank


class LimitsOnCurve:
    """What curves of orbits through events have: limits, in the order of those of their orbits."""

    def __init__(self, locus: Any) -> None:
        self._locus, self._plane = locus, locus.plane
        self._orbit, self._free = self._plane.orbit, self._plane.free[0]
        curve = locus.curve
        own = (*self._orbit.limits, *edges(self._orbit, curve))
        self.limits: Sequence[LimitOnCurve] = [LimitOnCurve(limit, curve.of) for limit in own]

    def margins(self, z: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Not told off the curve; z and the weights have the shape (M + 1,)."""
        return np.full(len(self.limits), np.nan)

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        z, tangent = np.array(point.unknowns), np.array(point.tangent)
        there, own = self._plane.first(z)
        if (edge := self._edge_at(z)) is not None and self.limits[edge].type.label == point.label:
            return edge
        grazing = point.label not in ("OC", "AZ")
        orbit = replace(
            point,
            label="GR" if grazing else point.label,
            unknowns=tuple(own.tolist()),
            tangent=(*tangent[: self._plane.size].tolist(), float(tangent[-1])),
        )
        if not grazing:
            return locating_limits.nearest(there, orbit)
        # An orbit's own event is touched earlier than it happens as any other is, and is of the other kind.
        kinds = ("terminal",) if point.kind == "resonant" else ("interior", "terminal")
        for kind in kinds[:-1]:
            with suppress(StartError):
                return locating_limits.nearest(there, replace(orbit, kind=kind))
        return locating_limits.nearest(there, replace(orbit, kind=kinds[-1]))

    def _edge_at(self, z: np.ndarray) -> int | None:
        """The edge of its leg that a touch is at; None where it is inside. z has the shape (N + k + 2,)."""
        off = np.abs(inside(self._orbit, self._locus.curve, z))
        return len(self._orbit.limits) + int(np.argmin(off)) if np.any(off < AT_EDGE) else None

    def stopped(self, located: Located, sample: Sample) -> str:
        """Why the orbits of a curve beyond a limit are not the machine's."""
        limit = located.among(self.limits)
        where = limits_in_words.place_of(self._orbit, limit.own, located)
        return f"At {self._free} = {float(located.z[-1]):.12g} {where}."

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The curve of orbits beyond a change of order, and in words what was found, or tried; of other
        limits none is begun.
        """
        if point.label != "OC" or isinstance(self._locus.curve, Limits):
            return (), ELSEWHERE
        return beyond_order.found(self._locus, point)


def told(orbit: Any, curve: OrbitCurve, margins: np.ndarray) -> np.ndarray:
    """Margins of all limits, shape (k,), one of what the curve itself holds at zero."""
    if not isinstance(curve, Limits):
        return margins
    own, legs = curve.limit, orbit.itinerary.legs
    names, around = {own.name}, {(own.leg + k) % len(legs) for k in (-1, 0, 1)}
    if own.test in OF_TWO_EVENTS:
        names |= {legs[own.leg].name, legs[own.leg - 1].name}
    held = np.array([limit.name in names and limit.leg in around for limit in orbit.limits], dtype=bool)
    return np.where(held, 1.0, margins)
