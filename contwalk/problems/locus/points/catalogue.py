"""All kinds of special points of curves of equilibria, by what the curve is of."""

from __future__ import annotations

from contwalk.problems.locus.count_change import CountChange
from contwalk.problems.locus.points.bogdanov_takens import (
    SecondZero,
    SecondZeroOnBranchPoints,
    VanishingFrequency,
)
from contwalk.problems.locus.points.crossing import Crossing
from contwalk.problems.locus.points.cusp import Cusp
from contwalk.problems.locus.points.degenerate_crossing import CrossingOfFolds, DegenerateBranchPoint
from contwalk.problems.locus.points.double_hopf import DoubleHopf
from contwalk.problems.locus.points.generalized_hopf import GeneralizedHopf
from contwalk.problems.locus.points.marked_value import EndPoint, MarkedValue
from contwalk.problems.locus.points.on_marked import FoldOnIt, HopfOnIt
from contwalk.problems.locus.points.zero_hopf import (
    PairOnBranchPoint,
    PairOnFold,
    ZeroOnHopf,
    ZeroWhereCurvesCross,
)
from contwalk.problems.problem import PointType

_MARKS = (MarkedValue(), EndPoint())
_OF_ALL = (Crossing(), *_MARKS)
POINT_TYPES: dict[str, tuple[PointType, ...]] = {
    "LP": (Cusp(), SecondZero(), PairOnFold(), CrossingOfFolds(), *_MARKS),
    "BP": (SecondZeroOnBranchPoints(), PairOnBranchPoint(), DegenerateBranchPoint(), *_OF_ALL),
    "UZ": (FoldOnIt(), HopfOnIt(), *_OF_ALL),
    "HB": (
        VanishingFrequency(),
        GeneralizedHopf(),
        ZeroOnHopf(),
        DoubleHopf(),
        CountChange(saddles=True),
        ZeroWhereCurvesCross(),
        *_MARKS,
    ),
}
