"""All kinds of special points of curves of orbits, by what the curve is of."""

from __future__ import annotations

from contwalk.problems.locus.count_change import CountChange
from contwalk.problems.locus.orbit_points.crossing import Crossing
from contwalk.problems.locus.orbit_points.cubic import Chenciner, GeneralizedDoubling
from contwalk.problems.locus.orbit_points.cusp import CuspOfCycles
from contwalk.problems.locus.orbit_points.degenerate_grazing import DegenerateGrazing
from contwalk.problems.locus.orbit_points.halves import R2OfHalves, TwoOfHalves
from contwalk.problems.locus.orbit_points.limits import LIMITS_ON
from contwalk.problems.locus.orbit_points.marked_value import EndPoint, MarkedValue
from contwalk.problems.locus.orbit_points.resonances import (
    R3,
    R4,
    R1OnFolds,
    R1OnTori,
    R2OnDoublings,
    R2OnTori,
)
from contwalk.problems.locus.orbit_points.two_at_once import ResonantGrazing, TwoAtOnce
from contwalk.problems.locus.orbit_points.where_branches_cross import (
    OnBranchPoints,
    R1OnBranchPoints,
    WhereBranchesCross,
)
from contwalk.problems.problem import PointType

_MARKS = (MarkedValue(), EndPoint())
_OF_ALL = (Crossing(), *_MARKS)
_ON_TORI = (Chenciner(), R1OnTori(), R2OnTori(), R3(), R4())
POINT_TYPES: dict[str, tuple[PointType, ...]] = {
    "LP": (
        CuspOfCycles(),
        R1OnFolds(),
        TwoAtOnce("LPPD", "PD"),
        TwoAtOnce("LPNS", "NS"),
        *LIMITS_ON["LP"].values(),
        *_OF_ALL,
    ),
    "PD": (
        GeneralizedDoubling(),
        TwoAtOnce("LPPD", "LP"),
        R2OnDoublings(),
        TwoAtOnce("PDNS", "NS"),
        *LIMITS_ON["PD"].values(),
        WhereBranchesCross("LPPD"),
        *_MARKS,
    ),
    "NS": (
        *_ON_TORI,
        TwoAtOnce("LPNS", "LP"),
        TwoAtOnce("PDNS", "PD"),
        TwoAtOnce("NSNS", "NS"),
        CountChange(saddles=True),
        *LIMITS_ON["NS"].values(),
        WhereBranchesCross("LPNS"),
        *_MARKS,
    ),
    "GR": (
        ResonantGrazing("GRLP", "LP"),
        ResonantGrazing("GRPD", "PD"),
        TwoAtOnce("GRLP", "LP"),
        TwoAtOnce("GRPD", "PD"),
        TwoAtOnce("GRNS", "NS"),
        DegenerateGrazing(),
        *LIMITS_ON["GR"].values(),
        *_OF_ALL,
    ),
    "UZ": (
        TwoAtOnce("LP", "LP"),
        TwoAtOnce("PD", "PD"),
        TwoAtOnce("NS", "NS"),
        *LIMITS_ON["UZ"].values(),
        *_OF_ALL,
    ),
    "BP": (
        OnBranchPoints("LPPD", "PD"),
        OnBranchPoints("LPNS", "NS"),
        R1OnBranchPoints(),
        TwoOfHalves("LPPD", "LP"),
        TwoOfHalves("PDNS", "NS"),
        R2OfHalves(),
        CountChange(),
        *LIMITS_ON["BP"].values(),
        *_OF_ALL,
    ),
    "OC": (CountChange(), *LIMITS_ON["OC"].values(), *_OF_ALL),
    "AZ": (CountChange(), *LIMITS_ON["AZ"].values(), *_OF_ALL),
}
