"""All kinds of special points of orbits."""

from __future__ import annotations

from contwalk.problems.orbit.points.admissibility import Admissibility
from contwalk.problems.orbit.points.branch_point import BranchPoint
from contwalk.problems.orbit.points.event_order import EventOrder
from contwalk.problems.orbit.points.fold import Fold
from contwalk.problems.orbit.points.grazing import Grazing
from contwalk.problems.orbit.points.krein_collision import KreinCollision
from contwalk.problems.orbit.points.limit import OrbitLimit
from contwalk.problems.orbit.points.marked_value import EndPoint, MarkedValue
from contwalk.problems.orbit.points.neimark_sacker import NeimarkSacker
from contwalk.problems.orbit.points.period_doubling import PeriodDoubling, SymmetryBreaking
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.orbit.points.several_multipliers import SeveralMultipliers

# Of all orbits, and of those through events.
POINT_TYPES: tuple[OrbitPoint, ...] = (
    Fold(),
    SeveralMultipliers(),
    BranchPoint(),
    PeriodDoubling(),
    SymmetryBreaking(),
    KreinCollision(),
    NeimarkSacker(),
    MarkedValue(),
    EndPoint(),
)
LIMIT_TYPES: tuple[OrbitLimit, ...] = (Grazing(), EventOrder(), Admissibility())
