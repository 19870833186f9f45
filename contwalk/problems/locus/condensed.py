"""Conditions of curves of orbits whose soft transitions are condensed: those of the explicit orbits.

A condition is made of an explicit orbit, and its derivatives go through what is eliminated there, exactly.
Where other soft transitions are met the explicit orbit is another one, and has a condition of its own: both
vanish at the same orbits.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.hybrid.eliminated import Eliminated
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.orbit.augmented import Augmented, Near

Found = Eliminated[HybridOrbit]


class Condensed(ABC):
    """A condition of explicit orbits, near a place of an orbit whose soft transitions are condensed.

    `further` are the unknowns of the condition there, shape (k,).
    """

    in_units = False

    def __init__(self, orbit: SoftEquations, near: Near, further: np.ndarray) -> None:
        self.orbit, self.near, self.further = orbit, near, further
        self._known: dict[Hashable, Augmented] = {}

    @abstractmethod
    def made(self, found: Found, near: At, own: np.ndarray) -> Augmented:
        """The condition near an explicit orbit; `own` are its further unknowns, shape (k,)."""

    def place(self, found: Found, own: np.ndarray) -> int:
        """The piece of the motion that the condition is of: explicit orbits have others for other pieces.

        `own` has the shape (k,).
        """
        return 0

    def before(self, found: Found, own: np.ndarray) -> list[int]:
        """Places of the durations, of all unknowns, by which an instant is later in its leg than in its
        piece.

        `own` has the shape (k,).
        """
        return []

    def _of(self, found: Found, own: np.ndarray, piece: np.ndarray) -> Augmented:
        key = found.explicit.itinerary, self.place(found, own)
        if key not in self._known:
            weights = self.orbit._explicit_weights(found.explicit, self.near.weights)
            self._known[key] = self.made(found, At(found.unknowns, weights, 1.0), piece)
        return self._known[key]

    def evaluate(self, there: SoftEquations, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The equations that are left with the condition, shape (N + m,), and their derivatives by all of y,
        shape (N + 1 + k,).
        """
        found, system, place = self._explicit(there, y)
        return self._left(found, y, *system.evaluate(found.explicit, place))[:2]

    def in_plane(
        self, there: SoftEquations, across: SoftEquations, y: np.ndarray, second: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `evaluate`, and derivatives by a second parameter, shape (N + m,).

        What is eliminated is the same on both lines: it is solved for once. y has the shape (N + 1 + k,).
        """
        found, system, place = self._explicit(there, y)
        line, whole = across.line, found.explicit.size
        explicit = found.explicit.varied(line=line, free=line.free)
        residual, jacobian, column = system.over(found.explicit, explicit, place, second)
        *left, eliminated = self._left(found, y, residual, jacobian)
        own, soft = found.along(column[:whole])
        return left[0], left[1], np.concatenate([own, column[whole:] + eliminated @ soft])

    def _explicit(self, there: SoftEquations, y: np.ndarray) -> tuple[Found, Augmented, np.ndarray]:
        """The explicit orbit, the condition of it, and the vector that this is evaluated at."""
        size = there.size
        found, own = there._at(y[: size + 1]), y[size + 1 :]
        piece = own - sum(found.unknowns[k] for k in self.before(found, own))
        return found, self._of(found, own, piece), np.concatenate([found.unknowns, piece])

    def _left(
        self, found: Found, y: np.ndarray, residual: np.ndarray, jacobian: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What `evaluate` returns, and derivatives of the condition by what is eliminated, shape (m, e)."""
        whole, size = found.explicit.size, len(found.residual)
        held, by_own = jacobian[whole:, : whole + 1].copy(), jacobian[whole:, whole + 1 :]
        for k in self.before(found, y[size + 1 :]):
            held[:, k] -= by_own[:, 0]
        left, eliminated = found.grouping.columns(held)
        matrix = np.zeros((size + len(held), len(y)))
        matrix[:size, : size + 1] = found.jacobian
        matrix[size:, : size + 1] = left + eliminated @ found.slope
        matrix[size:, size + 1 :] = by_own
        return np.concatenate([found.residual, residual[whole:]]), matrix, eliminated

    def critical(self, there: SoftEquations, y: np.ndarray) -> np.ndarray:
        """The critical vector of the orbit, of a condition that has one; y has the shape (N + 1 + k,)."""
        found, own = there._at(y[: there.size + 1]), y[there.size + 1 :]
        of_explicit = self._of(found, own, own).critical
        assert of_explicit is not None
        known = of_explicit(found.explicit, np.concatenate([found.unknowns, own]))
        return found.grouping.split(np.append(known, 0.0))[0][:-1]

    @property
    def augmented(self) -> Augmented:
        """The equations."""
        start = np.append(self.near.z, self.further)
        scale = np.append(self.near.weights, np.where(self.further == 0.0, 1.0, np.abs(self.further)))
        own: Any = self  # these are orbits too
        further = {"in_units": self.in_units, "in_plane": own.in_plane, "critical": own.critical}
        return Augmented(own.evaluate, start, scale, **further)


class OfMultipliers(Condensed):
    """A condition that is made the same way of any orbit.

    Parameters
    ----------
    orbit, near, further
        As of `Condensed`; `further` has the shape (k,).
    system : callable
        Makes it of an explicit orbit, a place and further unknowns.
    """

    def __init__(
        self,
        orbit: SoftEquations,
        near: At,
        further: np.ndarray,
        system: Callable[[HybridOrbit, At, np.ndarray], Any],
    ) -> None:
        super().__init__(orbit, near, further)
        self._system, self._second = system, near.second
        self._first: tuple[Found, Augmented, np.ndarray] | None = None

    def made(self, found: Found, near: At, own: np.ndarray) -> Augmented:
        """The condition of the explicit orbit, with the sign of the one that was made first.

        A bordered inverse has the sign of its borders, which singular vectors leave open: with another one
        the orientation of the curve would change where other soft transitions are met, as at a crossing.
        `own` has the shape (k,).
        """
        system: Augmented = self._system(found.explicit, At(near.z, near.weights, self._second), self.further)
        if self._first is None:
            self._first = found, system, own
            return system
        one, other = (self._slopes(*each) for each in (self._first, (found, system, own)))
        return turned(system) if len(one) == 1 and one[0] @ other[0] < 0.0 else system

    def _slopes(self, found: Found, system: Augmented, own: np.ndarray) -> np.ndarray:
        """Derivatives of a condition by the unknowns that are left, in the metric, shape (m, N + 1)."""
        place = np.concatenate([found.unknowns, own])
        held = system.evaluate(found.explicit, place)[1][found.explicit.size :, : len(found.unknowns)]
        left, eliminated = found.grouping.columns(held)
        return np.asarray((left + eliminated @ found.slope) * self.near.weights)


def of_any_orbit(
    orbit: Any, near: At, further: np.ndarray, system: Callable[[Any, At, np.ndarray], Any]
) -> Any:
    """A condition of multipliers near a place: of the explicit orbit, where soft transitions are condensed.

    Parameters
    ----------
    orbit : PeriodicOrbit, HybridOrbit or SoftOrbit
    near : At
    further : ndarray, shape (k,)
        Values of its further unknowns.
    system : callable
        Makes it of an orbit whose legs are all there, a place and further unknowns.
    """
    if isinstance(orbit, SoftEquations):
        return OfMultipliers(orbit, near, further, system).augmented
    return system(orbit, near, further)


def turned(system: Augmented) -> Augmented:
    """A condition with the other sign."""

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = (part.copy() for part in system.evaluate(there, y))
        residual[there.size :] *= -1.0
        jacobian[there.size :] *= -1.0
        return residual, jacobian

    def in_plane(
        there: Any, across: Any, y: np.ndarray, second: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        residual, jacobian, column = (part.copy() for part in system.over(there, across, y, second))
        for part in (residual, jacobian, column):
            part[there.size :] *= -1.0
        return residual, jacobian, column

    return replace(system, evaluate=evaluate, in_plane=in_plane)


class OfLimit(Condensed):
    """A limit is met: where it is an instant, that since its leg between hard transitions began.

    `further` has the shape (k,).
    """

    in_units = True

    def __init__(self, orbit: SoftEquations, limit: Limit, near: Near, further: np.ndarray) -> None:
        super().__init__(orbit, near, further)
        self.limit = limit

    def place(self, found: Found, own: np.ndarray) -> int:
        """The number of the explicit orbit's limit. `own` has the shape (k,)."""
        explicit, limit = found.explicit, self.limit
        if limit.test != "dip":
            chosen = self.orbit._least(found.grouping, explicit.margins(found.unknowns), limit)
            if chosen is None:
                raise NotFinite(f"'{limit.name}' has no value there")
            return chosen
        leg = self._leg(found, float(own[0]))
        same = (leg, limit.name, limit.test)
        return next(k for k, o in enumerate(explicit.limits) if (o.leg, o.name, o.test) == same)

    def _leg(self, found: Found, instant: float) -> int:
        """The piece nearest to an instant of the leg, of those in which the limit's event may happen.

        The instant may be that of the soft transition which disarms the event: the height of a foot in its
        ground is extreme where its damper switches.
        """
        group, limit = found.grouping.groups[self.limit.leg], self.limit
        ends = np.cumsum(found.unknowns[found.explicit.layout.durations][group])
        begins = np.append(0.0, ends[:-1])
        armed = {o.leg for o in found.explicit.limits if (o.name, o.test) == (limit.name, limit.test)}
        beyond = [
            (max(begin - instant, instant - end, 0.0), leg)
            for begin, end, leg in zip(begins, ends, group, strict=True)
            if leg in armed
        ]
        if not beyond:
            raise NotFinite(f"'{limit.name}' ends none of the pieces of that leg")
        return min(beyond)[1]

    def before(self, found: Found, own: np.ndarray) -> list[int]:
        """The pieces before that of the instant. `own` has the shape (k,)."""
        if self.limit.test != "dip":
            return []
        group, leg = found.grouping.groups[self.limit.leg], self._leg(found, float(own[0]))
        return [found.explicit.layout.durations.start + k for k in group[: group.index(leg)]]

    def made(self, found: Found, near: At, own: np.ndarray) -> Augmented:
        """The limit of the explicit orbit; `own` is the instant in its piece, shape (k,)."""
        chosen = self.place(found, own + sum(near.z[k] for k in self.before(found, self.further)))
        system = locating_limits.system_of(found.explicit, chosen, near, own if len(own) else None)
        if system is None or len(system.start) != len(near.z) + len(self.further):
            raise NotFinite(f"what passes zero at '{self.limit.name}' is another instant, or none")
        return system


def limit_system(orbit: Any, which: int, near: Near, further: np.ndarray | None = None) -> Augmented | None:
    """`locating_limits.system_of`, of orbits with condensed soft transitions; None where it is not met.

    `further` are known values of the unknowns that the limit has beside those of the orbit, shape (k,).
    """
    if not isinstance(orbit, SoftEquations):
        return locating_limits.system_of(orbit, which, near, further)
    limit = orbit.limits[which]
    if limit.test != "dip":
        return OfLimit(orbit, limit, near, np.zeros(0)).augmented
    if further is None:
        found = orbit._at(near.z)
        seen = found.explicit.margins(found.unknowns)
        chosen = orbit._least(found.grouping, seen, limit)
        if chosen is None or not np.isfinite(seen.places[chosen]):
            return None
        group, leg = found.grouping.groups[limit.leg], seen.limits[chosen].leg
        lasting = found.unknowns[found.explicit.layout.durations]
        earlier = float(np.sum(lasting[group[: group.index(leg)]]))
        further = np.array([earlier + float(seen.places[chosen]) * float(lasting[leg])])
    return OfLimit(orbit, limit, near, further).augmented
