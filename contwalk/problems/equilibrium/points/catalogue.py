"""All kinds of special points of equilibria."""

from __future__ import annotations

from contwalk.problems.equilibrium.points.boundary import BOUNDARY_EQUILIBRIUM
from contwalk.problems.equilibrium.points.branch_point import BranchPoint
from contwalk.problems.equilibrium.points.fold import Fold
from contwalk.problems.equilibrium.points.hopf import Hopf
from contwalk.problems.equilibrium.points.krein_collision import KreinCollision
from contwalk.problems.equilibrium.points.marked_value import EndPoint, MarkedValue
from contwalk.problems.equilibrium.points.multiple_zero import MultipleZero
from contwalk.problems.equilibrium.points.point import EquilibriumPoint

POINT_TYPES: tuple[EquilibriumPoint, ...] = (
    Fold(),
    BranchPoint(),
    MultipleZero(),
    KreinCollision(),
    Hopf(),
    BOUNDARY_EQUILIBRIUM,
    MarkedValue(),
    EndPoint(),
)
