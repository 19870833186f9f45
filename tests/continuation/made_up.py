"""A problem in closed form for tests of the engine's parts: F, DF, eigenvalues and points are told.

What it says may be wrong on purpose: a guard is only seen where nothing before it has already refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.continuation.segment import Segment
from contwalk.problems.capabilities import OwnMeasures
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.problem import Linearization, Located, PointType, Sample, Test
from contwalk.problems.sample import Rates

# What an evaluation of these equations may be off by.
LEVEL = 4e-16
# What moves along a made-up branch.
LINE = ParameterLine("lam", {"lam": 0.0})


class Told(PointType):
    """A kind of point whose places and tangents the made-up problem tells, under a name."""

    def __init__(
        self, name: str, label: str, test: Test, changes: tuple[int, ...], flat: tuple[PointType, ...] = ()
    ) -> None:
        self.name, self.label, self.test, self.changes, self.flat = name, label, test, changes, flat

    def tells(self, problem: MadeUp, sample: Sample, which: int) -> bool:
        return sample.eigenvalues[which].imag != 0.0

    def locate(self, problem: MadeUp, sample: Sample, which: int) -> Located | None:
        return problem.locate(self.name, sample, which)

    def tangent(self, problem: MadeUp, located: Located, near: Sample) -> np.ndarray | None:
        return problem.tangents.get(self.name)

    def describe(self, problem: MadeUp, located: Located, sample: Sample, s: float) -> SpecialPoint:
        return SpecialPoint(self.label, s, parameters={"lam": sample.parameter})


KINDS = {
    kind.name: kind
    for kind in (
        Told("LP", "LP", Test.TURN, (-1, 1)),
        Told("BP", "BP", Test.ORIENTATION, (-1, 0, 1)),
        Told("MULTIPLE", "BP", Test.TOGETHER, (0,)),
        Told("HB", "HB", Test.STABILITY, (-2, 2)),
        Told("UZ", "UZ", Test.MARK, (0,)),
        Told("EP", "EP", Test.END, (0,)),
    )
}


@dataclass
class MadeUp(OwnMeasures):
    """F(z) = 0 for z of N unknowns and the parameter.

    `eigenvalues(z)` is told apart from F; `special` holds the special points by label, and `locate` answers
    with the nearest one.
    """

    f: Callable[[np.ndarray], Sequence[float]]
    df: Callable[[np.ndarray], Any]
    eigenvalues: Callable[[np.ndarray], Sequence[complex]] | None = None
    special: dict[str, list[Located]] = field(default_factory=dict)
    tangents: dict[str, np.ndarray] = field(default_factory=dict)
    observe: dict[str, Callable[[np.ndarray], float]] = field(default_factory=dict)
    slopes: dict[str, Callable[[np.ndarray], float]] = field(default_factory=dict)  # along the branch
    error: float = 1e-14
    evaluated: int = 0

    kind, line, meshed, limited, anchored = "made_up", LINE, None, None, None
    evaluations, point_types = 0, tuple(KINDS.values())

    @property
    def diagnosis(self) -> MadeUp:
        return self

    @property
    def observable_names(self) -> tuple[str, ...]:
        return tuple(self.observe)

    def linearize(self, z: np.ndarray) -> Linearization:
        self.evaluated += 1
        residual, jacobian = np.array(self.f(z), dtype=float), np.array(self.df(z), dtype=float)
        levels = LEVEL * (1.0 + np.abs(jacobian) @ np.abs(z))
        return Linearization(residual, jacobian, lambda: (levels, np.ones(len(z))))

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        return np.array(self.df(z), dtype=float)

    def values(self, z: np.ndarray) -> np.ndarray:
        if self.eigenvalues is None:
            found = np.linalg.eigvals(self.jacobian(z)[:, :-1]).astype(complex)
        else:
            found = np.array(self.eigenvalues(z), dtype=complex)
        return found[np.lexsort((-found.imag, -found.real))]

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
    ) -> Sample:
        unit = tangent / np.linalg.norm(tangent / weights)
        values = self.values(z)
        errors = np.full(len(values), self.error)
        orientation, error = linearization.orientation_and_error(unit, weights, linearization.levels[0])
        as_before = np.arange(len(values)) < (before or 0)
        positive = np.where(np.abs(values.real) > errors, values.real > 0.0, as_before)
        h = 1e-6  # central differences: 1e-12 of truncation, 1e-10 of rounding
        rates = (self.values(z + h * unit).real - self.values(z - h * unit).real) / (2.0 * h)
        return Sample(
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            eigenvalues=values,
            errors=errors,
            rates=Rates.known(rates),
            measures=values.real,
            unstable=int(positive.sum()),
            observables=np.array([f(z) for f in self.observe.values()]),
            magnitudes=np.ones(len(z)),
            excess=0.0,
            error=error,
        )

    def locate(self, label: str, sample: Sample, which: int) -> Located | None:
        known = self.special.get(label, [])
        return min(known, key=lambda p: np.linalg.norm(p.z - sample.z), default=None)

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        return self.locate(name, sample, 0)

    def rate(self, name: str, sample: Sample) -> float:
        if name in self.slopes:
            return self.slopes[name](sample.z)
        h, value = 1e-5, self.observe[name]
        return (value(sample.z + h * sample.tangent) - value(sample.z - h * sample.tangent)) / (2.0 * h)

    def many_branches(self, z: np.ndarray) -> bool:
        return any(np.allclose(p.z, z, atol=1e-12) for p in self.special.get("BP", []))

    def passed(self, a, b):
        return ()

    def kinks_between(self, a, b):
        return ()

    def obstacle(self, z: np.ndarray) -> str:
        return ""

    def growth(self, z: np.ndarray) -> str:
        return ""

    def explain(self, z: np.ndarray) -> str:
        return "the made-up equations"

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        return z

    def end_functions(self, sample: Sample) -> tuple[float, ...]:
        return ()

    def ended(self, a: Sample, b: Sample) -> None:
        return None

    # -- for the tests -----------------------------------------------------------------------------------

    def sample(self, z: Sequence[float], toward: Sequence[float]) -> Sample:
        """The sample at a solution; its tangent is the null vector of DF that points along `toward`."""
        z, toward = np.array(z, dtype=float), np.array(toward, dtype=float)
        linearization = self.linearize(z)
        tangent = linearization.tangent(toward, np.ones(len(z)))
        values = self.values(z)
        before = int(np.sum(values.real > self.error))
        return self.examine(z, tangent, np.ones(len(z)), linearization, before)

    def segment(self, a: Sequence[float], b: Sequence[float]) -> Segment:
        """The piece of branch between two solutions."""
        way = np.array(b, dtype=float) - np.array(a, dtype=float)
        return Segment(self, self.sample(a, way), self.sample(b, way))  # type: ignore[arg-type]


def at(*z: float, error: float = 1e-15, **rest: Any) -> Located:
    """A located point."""
    return Located(np.array(z, dtype=float), error, **rest)


def circle(**rest: Any) -> MadeUp:
    """x^2 + lam^2 = 1: folds at lam = -1 and 1; a branch that closes."""
    return MadeUp(lambda z: [z[0] ** 2 + z[1] ** 2 - 1.0], lambda z: [[2.0 * z[0], 2.0 * z[1]]], **rest)


def parabola(**rest: Any) -> MadeUp:
    """lam = x^2: a fold at zero, the eigenvalue -2 x."""
    rest.setdefault("special", {"LP": [at(0.0, 0.0)]})
    return MadeUp(lambda z: [z[1] - z[0] ** 2], lambda z: [[-2.0 * z[0], 1.0]], **rest)


def pitchfork(unfolded: float = 0.0, **rest: Any) -> MadeUp:
    """lam x - x^3 + unfolded = 0, along x = 0 where it is not unfolded."""
    rest.setdefault("special", {"BP": [at(0.0, 0.0)]})
    rest.setdefault("tangents", {"BP": np.array([0.0, 1.0])})
    return MadeUp(
        lambda z: [z[1] * z[0] - z[0] ** 3 + unfolded], lambda z: [[z[1] - 3.0 * z[0] ** 2, z[0]]], **rest
    )


def line(eigenvalues: Callable[[np.ndarray], Sequence[complex]], **rest: Any) -> MadeUp:
    """x = 0 for every lam, with eigenvalues that are told: F_u is -1 and knows nothing of them."""
    return MadeUp(lambda z: [-z[0]], lambda z: [[-1.0, 0.0]], eigenvalues, **rest)


def unrefined(z: Sequence[float]) -> Located:
    """A point that refinement finds to be none."""
    return replace(at(*z), refine=lambda: None)
