"""What curves in two parameters are of: the condition that holds along each, and the eigenvalues it holds.

Along curves of folds, of Hopf points and of branch points these are critical. Along curves of marked values
(UZ) nothing is, unless the value is that of an eigenvalue.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any, ClassVar

import numpy as np

from contwalk.problems.locus.bordered import pair_borders, zero_borders
from contwalk.problems.locus.branch_points import branch_point
from contwalk.problems.locus.conditions import Condition, Level, Pair, ParameterAt, Zero
from contwalk.problems.locus.plane import Plane

MARKED = "UZ"


class Curve(ABC):
    """What is followed.

    Attributes
    ----------
    of : str
        The label of its points.
    name : str
        As it is stored, where several kinds of curves have one label.
    own : int
        How many unknowns its condition adds.
    pair : bool
        Whether that is the square of a frequency.
    """

    of: ClassVar[str]
    name: ClassVar[str] = ""
    own: ClassVar[int] = 0
    pair: ClassVar[bool] = False

    @property
    def real_part(self) -> float | None:
        """The largest real part of eigenvalues, where it is that which has a value."""
        return None

    @abstractmethod
    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """What holds along it, with borders for z, shape (N + 2,), and its own unknown there."""

    def held(self, own: float) -> np.ndarray:
        """The critical eigenvalues that it holds, shape (k,)."""
        return np.zeros(0, dtype=complex)

    def facts(self) -> dict[str, Any]:
        """What is stored of it."""
        own: dict[str, Any] = asdict(self) if is_dataclass(self) else {}
        return {"of": self.of, **({"curve": {"name": self.name, **own}} if self.name else {})}


def _shifted(plane: Plane, z: np.ndarray, sigma: float) -> np.ndarray:
    return plane.jacobian(z)[:, : plane.size] - sigma * np.diag(plane.finite)


class Folds(Curve):
    """Folds: a zero eigenvalue."""

    of = "LP"

    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """g(z, sigma) = 0, with borders for z, shape (N + 2,)."""
        sigma = self.real_part or 0.0
        return Zero(zero_borders(_shifted(plane, z, sigma)), sigma)

    def held(self, own: float) -> np.ndarray:
        """Zero, shape (1,)."""
        return np.zeros(1, dtype=complex)


class FamilyFolds(Folds):
    """Folds of a held family in what says where on it one is: no eigenvalue beside the held ones is zero."""

    name, held = "family", Curve.held


class HopfPoints(Curve):
    """Hopf points, and neutral saddles: a pair s, -s."""

    of = "HB"
    own = 1
    pair = True

    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """alpha = beta = 0 of F_u - sigma E, with borders for z, shape (N + 2,)."""
        sigma = self.real_part or 0.0
        return Pair(pair_borders(_shifted(plane, z, sigma), plane.finite, own), sigma)

    def held(self, own: float) -> np.ndarray:
        """The pair, shape (2,)."""
        s = np.sqrt(complex(-own))
        return np.array([s, -s]) + 0.0  # no zeros with a sign


class BranchPoints(Curve):
    """Branch points that persist, as with a symmetry or an invariant subspace."""

    of = "BP"
    own = 1

    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """DF by states and a parameter loses rank, with borders for z, shape (N + 2,)."""
        return branch_point(plane, z)

    held = Folds.held


@dataclass(frozen=True)
class ObservableAt(Curve):
    """A declared observable at a value."""

    observable: str
    level: float
    of = MARKED
    name = "observable"

    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """The observable is at its value; z has the shape (N + 2,)."""
        return Level(self.observable, self.level)


@dataclass(frozen=True)
class AtParameter(Curve):
    """One of the two parameters at a value; `place` is its place in z."""

    place: int
    level: float
    of = MARKED
    name = "parameter"

    def condition(self, plane: Plane, z: np.ndarray, own: float) -> Condition:
        """The parameter is at its value; z has the shape (N + 2,)."""
        return ParameterAt(self.place, self.level)


@dataclass(frozen=True)
class _RealPartAt:
    """A largest real part of eigenvalues that is not zero: none of them is critical."""

    level: float

    @property
    def real_part(self) -> float:
        """The value."""
        return self.level

    held = Curve.held


class RealEigenvalueAt(_RealPartAt, Folds):
    """The largest real part of eigenvalues, a real one's, at a value that is not zero."""

    of = MARKED
    name = "real"


class PairAt(_RealPartAt, HopfPoints):
    """The largest real part of eigenvalues, a complex pair's, at a value that is not zero."""

    of = MARKED
    name = "pair"


FOLDS, HOPF_POINTS, BRANCH_POINTS = Folds(), HopfPoints(), BranchPoints()
CURVES: dict[str, Curve] = {curve.of: curve for curve in (FOLDS, HOPF_POINTS, BRANCH_POINTS)}
_NAMED = {kind.name: kind for kind in (FamilyFolds, ObservableAt, AtParameter, RealEigenvalueAt, PairAt)}
# The labels of special points of equilibria that curves are of.
LABELS = (*CURVES, MARKED)


def curve_of(settings: Mapping[str, Any]) -> Curve:
    """The curve of what is stored of a branch."""
    stored = settings.get("curve")
    if stored is None:
        return CURVES[str(settings["of"])]
    return _NAMED[stored["name"]](**{key: value for key, value in stored.items() if key != "name"})
