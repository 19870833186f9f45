"""How finely orbits are computed: one wish, and what follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

# Tolerances beyond these do not pay: looser ones lose the branch, tighter ones drown in rounding.
LOOSEST, TIGHTEST = 1e-5, 3e-15
# Where nothing must hide between two steps of a branch.
FINEST = 1e-13
# Local errors of a walk, and of the first attempt at a located point, in units of the wish: estimates of the
# 8th-order pair are two digits on the safe side, and located points are checked on finer steps anyway.
WALKING, LOCATING, MARKING = 100.0, 1.0, 0.03
# A residual counts as solved at this part of the tolerance.
SOLVED = 1e-3
# Evaluations of the field in a step of each method (of the implicit ones, about).
STAGES = {"dop853": 12, "verner98": 16, "radau5": 24, "radau9": 40}
# Degrees of collocation that take least time, by the tolerance from which on they do.
DEGREES = ((4, 1e-6), (5, 1e-9), (6, 1e-11), (7, 0.0))
STAGES |= {f"gauss{2 * degree}": 5 * degree for degree in range(2, 8)}


# What the settings of a run's engine are called here; the others are not of orbits.
OF_ORBITS = {
    "method": "method",
    "discretization": "scheme",
    "tolerance": "tolerance",
    "segments": "segments",
    "phase": "phase",
}


def of_orbits(engine: Mapping[str, Any]) -> dict[str, Any]:
    """What the settings of a run's engine say of a `Discretization`."""
    return {OF_ORBITS[key]: value for key, value in engine.items() if key in OF_ORBITS}


@dataclass(frozen=True)
class Discretization:
    """What a run asks of its orbits.

    Parameters
    ----------
    accuracy : float
        Requested relative error of special points.
    method : str
        `auto`, or one of `flow.METHODS`.
    scheme : str
        `shooting`: an orbit's segments are of equal duration, and integrated by whichever method suits the
        flow. `auto`: as `shooting`, but for an orbit over which deviations grow too much for as many segments
        as there may be: that is cut at times of equal growth. Where their number is given, as `shooting`.
        `collocation`: segments are of equal growth, and solved by collocation at Gauss points; legs between
        events are solved so too, and cut as by `shooting`. `grown`: of equal growth from the second segment
        on, by any method, as `auto` was in databases of before.
    tolerance : float, optional
        Local error of the walk's integration, in units of each state's variation; from `accuracy` by default.
    segments : int, optional
        Segments of multiple shooting; by default from the growth of the flow.
    phase : str
        `section` or `integral`: which condition fixes the phase of an autonomous orbit.
    report_at : tuple of (int, float, float), optional
        The state that stands for an orbit is that where state number i passes a value, rising (1) or falling
        (-1); by default the phase condition's point.
    report_event : tuple of (str, str), optional
        Or that before or after an event: its name, and `before` or `after`.
    share : float
        Part of the tolerance along a branch that steps are made for, where larger errors would tell nothing.
    """

    accuracy: float = 1e-8
    method: str = "auto"
    tolerance: float | None = None
    segments: int | None = None
    phase: str = "section"
    report_at: tuple[int, float, float] | None = None
    report_event: tuple[str, str] | None = None
    scheme: str = "auto"
    share: float = 1.0

    @property
    def uneven(self) -> bool:
        """Whether the times at which an orbit is cut are always chosen, and stand among its unknowns."""
        return self.scheme in ("collocation", "grown")

    @property
    def evenly_first(self) -> bool:
        """Whether segments are of equal duration until deviations grow too much for as many as may be."""
        return self.scheme == "auto" and self.segments is None

    def integrator(self, tolerance: float) -> str:
        """The method for a local error, or `auto`."""
        if self.method != "auto" or self.scheme != "collocation":
            return self.method
        return f"gauss{2 * next(degree for degree, least in DEGREES if tolerance >= least)}"

    def why(self, reason: str) -> str:
        """Why a method was taken, by default for a reason that it was chosen for."""
        asked = self.scheme == "collocation" and self.method == "auto"
        return "collocation at Gauss points, as the run asks for" if asked else reason

    @property
    def walking(self) -> float:
        """Tolerance along a branch."""
        asked = self.tolerance if self.tolerance is not None else WALKING * self.accuracy
        return _clipped(self.share * asked)

    @property
    def marking(self) -> float:
        """Tolerance at marked points, which are not checked on finer steps."""
        return _clipped(min(self.walking, MARKING * self.accuracy))

    @property
    def locating(self) -> float:
        """Tolerance at special points."""
        return _clipped(min(self.walking, LOCATING * self.accuracy))


def _clipped(tolerance: float) -> float:
    return min(max(tolerance, TIGHTEST), LOOSEST)
