"""The result: arrays by name, special points as records, no algorithms.

A `Branch` holds its points in one NumPy structured array, one row a point, ordered along the branch by the
signed arclength `s` (0 at the start). A special point is a point too: it has a row (its `index`) and a
record with what is known about it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, overload

import numpy as np

from contwalk import quantities, tables
from contwalk.branch_point import SpecialPoints, StoredPoint
from contwalk.branch_words import small_diagram, table_of_special_points, told_branch
from contwalk.labels import EVERY_MEANING
from contwalk.other_libraries import as_axes, as_pandas, as_xarray
from contwalk.signatures import is_iterated
from contwalk.special_point import SpecialPoint

LABELS = tuple(EVERY_MEANING)
ORBITS = ("periodic_orbit", "hybrid_orbit")
FIXED_POINT = "fixed_point"
# A parameter that changes by less than this part of itself along a whole curve does so by rounding.
STANDS_STILL = 1e-9
# What is stored of a row, and given of counts, where stability is not known.
NOT_KNOWN = -1


@dataclass(frozen=True)
class BranchInfo:
    """What is true of a whole branch.

    Parameters
    ----------
    name : str
        `b1`, `b2`, ... in the order of their computation.
    problem : str
        `equilibrium`, `periodic_orbit`, `hybrid_orbit` or `locus`; of cycles of a map `hybrid_orbit`, which
        `problem_by_name` calls `fixed_point`.
    states, observables, free : tuple of str
        Names of the states (n), the observables (o) and the free parameters (f).
    parameters : mapping
        Values of all parameters; those that are free, as they were at the start.
    unknowns : int
        Most unknowns that a point of the branch may have (states first). Where a point has fewer, because its
        orbit is cut into fewer segments, its `unknowns`, `tangent` and `weights` end in NaN.
    spectrum : int
        Length m of the spectrum.
    parent : tuple of (str, float), optional
        Name of the parent branch and arclength `s` of its special point.
    origin : str
        How the branch came about, in words: `start: equilibrium balanced`.
    settings : mapping
        What the driver needs to go on from a stored point (plain JSON values).
    """

    name: str
    problem: str
    states: tuple[str, ...]
    observables: tuple[str, ...]
    free: tuple[str, ...]
    parameters: Mapping[str, float]
    unknowns: int
    spectrum: int
    parent: tuple[str, float] | None = None
    closure: str | None = None
    signature: tuple[str, ...] | None = None
    subharmonic: int = 1
    origin: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def problem_by_name(self) -> str:
        """The problem as it is called: that of cycles of a map is `fixed_point`."""
        return FIXED_POINT if is_iterated(self.signature) and self.problem in ORBITS else self.problem

    def point_dtype(self) -> np.dtype:
        """NumPy dtype of one stored point."""
        sizes = len(self.free), len(self.states), len(self.observables)
        return _point_dtype(*sizes, self.spectrum, self.unknowns)


@cache
def _point_dtype(free: int, states: int, observables: int, spectrum: int, unknowns: int) -> np.dtype:
    """What `BranchInfo.point_dtype` gives: one object for the same numbers, which is compared at once."""
    return np.dtype(
        [
            ("s", "f8"),  # signed arclength from the start of the branch, in the problem's metric
            ("free", "f8", (free,)),
            ("state", "f8", (states,)),
            ("observables", "f8", (observables,)),
            ("period", "f8"),  # NaN for an equilibrium
            ("trivial_error", "f8"),  # |M f - f| / |f| of an orbit; NaN otherwise
            ("spectrum", "c16", (spectrum,)),
            ("spectrum_error", "f8"),  # estimated error of the leading eigenvalue
            ("unstable", "i4"),  # of these whose sign is not known as many as beside it
            ("undecided", "i4"),  # eigenvalues whose sign, of which stability depends, is not known
            ("stable", "i1"),  # 1, 0, or -1: not known
            ("admissible", "?"),
            ("special", "?"),  # the row of a special point
            ("unknowns", "f8", (unknowns,)),
            ("tangent", "f8", (unknowns + 1,)),  # unit vector, towards growing s
            ("weights", "f8", (unknowns + 1,)),  # of the metric
            ("step", "f8"),  # next step length from here
            ("error", "f8"),  # estimated error of the point in its metric; NaN where the branch is born
            ("residual", "f8"),  # residual over its own rounding error
            ("iterations", "i4"),
            ("rhs", "i8"),  # evaluations of the vector field spent on this point
            ("seconds", "f8"),
        ]
    )


@dataclass(frozen=True)
class Outcome:
    """How a branch ended: `status` complete | stopped | failed, reason code, a sentence with a remedy."""

    status: str
    reason: str
    message: str


def narrowed(info: BranchInfo, points: np.ndarray) -> tuple[BranchInfo, np.ndarray]:
    """A branch of hybrid orbits without the columns of unknowns that it has room for and never needed."""
    if info.problem != "hybrid_orbit" or not len(points):
        return info, points
    used = int(np.isfinite(points["unknowns"]).sum(axis=1).max())
    if used == info.unknowns:
        return info, points
    narrow = replace(info, unknowns=used)
    result = np.zeros(len(points), dtype=narrow.point_dtype())
    for name in result.dtype.names or ():
        width = result.dtype[name].shape
        result[name] = points[name][:, : width[0]] if width else points[name]
    return narrow, result


@dataclass(repr=False)
class Branch:
    """A computed branch.

    `points` is a structured array of dtype `info.point_dtype()`, sorted by `s`. `branch["m"]` gives the array
    of a free parameter, a state or an observable by its name; `branch["unstable"]` and the other
    columns by theirs, -1 where it is not known; `branch["stable"]` is 1, 0, or -1 where it is not known;
    `branch["max:X"]`, `branch["min:X"]` and `branch["amp:X"]` are the largest and the
    least value of a state over each orbit, and half their difference.
    """

    info: BranchInfo
    points: np.ndarray
    special_points: SpecialPoints
    outcome: Outcome
    cost: Mapping[str, float] = field(default_factory=lambda: {"seconds": 0.0, "rhs": 0})
    complete: bool = True

    @property
    def name(self) -> str:
        """`b1`, `b2`, ..."""
        return self.info.name

    def unknowns(self, row: int) -> np.ndarray:
        """Unknowns of a point and its free parameter: the vector z of its problem."""
        u = self.points["unknowns"][row]
        return np.append(u[np.isfinite(u)], self.points["free"][row, 0])

    def gaps(self) -> list[int]:
        """Numbers of the points after which a curve in two parameters was outside its range.

        It leaves at an end of the range, facing out of it, and the next point is where it comes back.
        """
        if len(self.info.free) < 2 or len(self) < 2:
            return []
        free = self.points["free"]
        low, high = free.min(axis=0), free.max(axis=0)
        ways = np.array([self._way(k) for k in range(len(self))])
        # A parameter that stands still along the curve is at both ends, and moves by rounding either way.
        ways[:, high - low <= STANDS_STILL * np.maximum(np.abs(low), np.abs(high))] = 0.0
        ways[np.abs(ways) <= STANDS_STILL * (high - low)] = 0.0
        outward = ((free == high) & (ways > 0.0)) | ((free == low) & (ways < 0.0))
        inward = ((free == high) & (ways < 0.0)) | ((free == low) & (ways > 0.0))
        return np.flatnonzero(outward[:-1].any(axis=1) & inward[1:].any(axis=1)).tolist()

    def _way(self, row: int) -> np.ndarray:
        """The tangent's shares of both free parameters of a curve, shape (2,)."""
        tangent = self.points["tangent"][row][: len(self.unknowns(row))]
        return np.asarray(tangent[[-1, -2]])

    def parameters_at(self, row: int) -> dict[str, float]:
        """Values of all parameters at a point, by its number: those that are free as they are there."""
        return {**self.info.parameters, **dict(zip(self.info.free, self.points["free"][row], strict=True))}

    def names(self) -> tuple[str, ...]:
        """Names that `branch[name]` understands besides those of `columns()`."""
        return (*self.info.free, *self.info.observables, *self.info.states)

    def knows(self, name: str) -> bool:
        """Whether `branch[name]` is one real number a point."""
        dtype = self.points.dtype
        scalar = name in (dtype.names or ()) and dtype[name].shape == () and dtype[name].kind != "c"
        known = name in (*self.names(), *self.info.parameters) or self._extreme(name) is not None
        return scalar or known or name in self._spectral()

    def __repr__(self) -> str:
        return f"<{told_branch(self)}>"

    def _repr_html_(self) -> str:
        return small_diagram([self]) + tables.html(told_branch(self), table_of_special_points(self))

    def __len__(self) -> int:
        return len(self.points)

    def __iter__(self) -> Iterator[StoredPoint]:
        return (StoredPoint(self, row) for row in range(len(self)))

    @overload
    def __getitem__(self, name: str) -> np.ndarray: ...

    @overload
    def __getitem__(self, name: int) -> StoredPoint: ...

    @overload
    def __getitem__(self, name: slice) -> list[StoredPoint]: ...

    def __getitem__(self, name: str | int | slice) -> np.ndarray | StoredPoint | list[StoredPoint]:
        """An array by its name; the point in a row, counted from the end where negative; those of a slice."""
        if isinstance(name, slice):
            return [StoredPoint(self, row) for row in range(len(self))[name]]
        if not isinstance(name, str):
            return StoredPoint(self, range(len(self))[name])
        return self._array(name)

    def _array(self, name: str) -> np.ndarray:
        for column, known in (
            ("free", self.info.free),
            ("observables", self.info.observables),
            ("state", self.info.states),
        ):
            if name in known:
                return self.points[column][:, known.index(name)]
        extreme = self._extreme(name)
        if extreme is not None:
            return extreme
        if name == "unstable":
            return self._unstable()
        if name in (self.points.dtype.names or ()):
            return self.points[name]
        if name in self.info.parameters:
            return np.full(len(self), self.info.parameters[name])
        columns = self.columns()
        if name in columns:
            return columns[name]
        possible = dict.fromkeys((*self.names(), *self.info.parameters, *columns))
        raise KeyError(f"Branch {self.name} has no '{name}'. Known: {', '.join(possible)}.")

    def _extreme(self, name: str) -> np.ndarray | None:
        """`max:X`, `min:X` or `amp:X`: stored of orbits; of an equilibrium X itself, or zero."""
        kind, _, state = name.partition(":")
        if state in self.info.states and self.info.problem == "equilibrium":
            at_rest = {"max": self[state], "min": self[state], "amp": np.zeros(len(self))}
            return at_rest.get(kind)
        return quantities.column(name, self.info.observables, self.points["observables"])

    def columns(self) -> dict[str, np.ndarray]:
        """The columns of `points` by name, one entry a point.

        Free parameters, observables and states have their own names. One whose name is taken already gets the
        kind in front, such as `state_period`. Eigenvalues or multipliers are `re_1`, `im_1`, `re_2`, ...
        """
        columns = {"s": self.points["s"], "special_point": self._names_by_row()}
        own = [name for name in self.points.dtype.names or () if self.points.dtype[name].shape == ()]
        taken = {*own, "special_point"}
        for column, names in (
            ("free", self.info.free),
            ("observables", self.info.observables),
            ("state", self.info.states),
        ):
            for position, name in enumerate(names):
                name = name if name not in taken else f"{column}_{name}"
                taken.add(name)
                columns[name] = self.points[column][:, position]
        stored = {name: self.points[name] for name in own} | {"unstable": self._unstable()}
        return columns | self._spectral() | stored

    def _unstable(self) -> np.ndarray:
        """How many directions are unstable at each point, shape (k,); -1 where it is not known."""
        return np.where(self.points["undecided"] > 0, NOT_KNOWN, self.points["unstable"])

    def _spectral(self) -> dict[str, np.ndarray]:
        """Eigenvalues or multipliers: `re_1`, `im_1`, `re_2`, ..."""
        found = {}
        for position in range(self.info.spectrum):
            found[f"re_{position + 1}"] = self.points["spectrum"][:, position].real
            found[f"im_{position + 1}"] = self.points["spectrum"][:, position].imag
        return found

    def plot(self, y: str | None = None, x: str | None = None, ax: Any = None, **options: Any) -> Any:
        """Draw the branch: `y` over `x`, the free parameter by default; a curve in two parameters in both.

        Parameters
        ----------
        y, x : str, optional
            What `branch[name]` understands; of orbits largest and least values of a state are drawn.
        ax : matplotlib.axes.Axes, optional
            Where to draw, as beside other branches; new axes by default.
        **options
            Those of `cw.plot_bifurcation_diagram`, of a curve those of `cw.plot_locus`.

        Returns
        -------
        matplotlib.axes.Axes
            `cw.save(axes, "x.png")` writes its figure.
        """
        return as_axes(self, x, y, ax, **options)

    def to_pandas(self) -> Any:
        """`columns()` as a `pandas.DataFrame`; see `other_libraries.as_pandas`."""
        return as_pandas(self)

    def to_xarray(self) -> Any:
        """Points and spectra as an `xarray.Dataset`; see `other_libraries.as_xarray`."""
        return as_xarray(self)

    def _names_by_row(self) -> np.ndarray:
        """Names of the special points in the rows they have, separated by a space where they share one."""
        names = [""] * len(self)
        for point in self.special_points:
            if point.index < len(names):
                names[point.index] = f"{names[point.index]} {point.name}".strip()
        return np.array(names, dtype=object)

    def special(self, name: str) -> SpecialPoint:
        """The special point of this name, as `HB1`."""
        for point in self.special_points:
            if point.name == name:
                return point
        known = ", ".join(point.name for point in self.special_points)
        raise KeyError(f"Branch {self.name} has no special point '{name}'. Known: {known or 'none'}.")


def along(rows: np.ndarray) -> np.ndarray:
    """Rows in the order of appending, in their order along the branch.

    Those at one place are met in the order of appending, the other way round where the walk went backwards.
    """
    met = np.arange(len(rows))
    return rows[np.lexsort((np.where(rows["s"] < 0.0, -met, met), rows["s"]))]


def named(special_points: list[SpecialPoint], points: np.ndarray) -> SpecialPoints:
    """Special points in their order along the branch, with names counted along it and their rows."""
    counts: Counter[str] = Counter()  # labels of a later version too
    taken: set[int] = set()
    result = SpecialPoints()
    for point in sorted(special_points, key=lambda q: q.s):
        counts[point.label] += 1
        row = _row_of(point, points, taken)
        taken.add(row)
        result.append(replace(point, name=f"{point.label}{counts[point.label]}", index=row))
    return result


def _row_of(point: SpecialPoint, points: np.ndarray, taken: set[int]) -> int:
    """The row of a special point: at its arclength a special one, or for an end point a regular one."""
    low = int(np.searchsorted(points["s"], point.s, side="left"))
    high = int(np.searchsorted(points["s"], point.s, side="right"))
    special = point.label != "EP"
    fitting = [i for i in range(low, high) if bool(points["special"][i]) == special]
    free = [i for i in fitting if i not in taken or not special]
    return (free or fitting or [low])[0]
