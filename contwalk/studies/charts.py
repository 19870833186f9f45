"""Charts: the regions between curves in two parameters, and the solutions at one computed point of each.

Nothing is guessed from the curves: in each region the place farthest from all curves is taken, and there the
branches along the first parameter are computed, at that value of the second. They begin at what is known: the
study's own branches, carried over to that value, and places where curves pass it. What is found at the place
is what the chart tells of its region.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from contwalk.branch import Branch, Outcome
from contwalk.chart import Chart, Region, Solution
from contwalk.continuation import outcomes
from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Mark, Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram
from contwalk.diagram.events import Plan
from contwalk.errors import ContwalkError
from contwalk.labels import BORDERS, CROSSINGS, END, LOCUS, MARK, RANGES
from contwalk.numerics.linear import kernel_direction
from contwalk.numerics.regions import Raster, Regions, regions
from contwalk.numerics.threads import one_thread
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.quantities import FREQUENCY_SQUARED
from contwalk.studies.opening import opened
from contwalk.studies.verbs import continue_branch
from contwalk.system import System

# How far beside a fold a branch is begun, in typical magnitudes.
BESIDE_FOLD = 0.05
# A line passes what lies no more cells beside it.
BESIDE_LINE = 3
# Points of the branches at a place of a region, each way.
POINTS = 2000


@one_thread()
def chart(system: System, branches: Sequence[Branch], names: tuple[str, str] | None = None) -> Chart:
    """The chart of curves of equilibria in two parameters.

    Parameters
    ----------
    system : System
        The one that the branches were computed with.
    branches : sequence of Branch
        Curves in two parameters, and the branches along the first one that they were begun from.
    names : tuple of str, optional
        The parameters along both axes; by default as they are free on the first curve.

    Raises
    ------
    ContwalkError
        If there is no curve, or curves are of orbits.
    """
    curves = [branch for branch in branches if branch.info.problem == LOCUS and len(branch)]
    if not curves:
        raise ContwalkError(
            "There is no curve in two parameters to make a chart of.",
            "Compute some, as with loci: {with: PARAMETER, range: [lowest, highest]}.",
        )
    x, y = names or (curves[0].info.free[0], curves[0].info.free[1])
    curves = [branch for branch in curves if {x, y} == set(branch.info.free)]
    of_orbits = [branch for branch in curves if branch.info.settings["of_problem"] != "equilibrium"]
    equilibria = [b for b in curves if b not in of_orbits]
    if not equilibria:
        raise ContwalkError(
            f"There is no curve of equilibria along {x} and {y}.",
            "A chart is of equilibria; draw other curves with --kind locus.",
        )
    known = [
        b for b in branches if b.info.problem == "equilibrium" and b.info.free in ((x,), (y,)) and len(b)
    ]
    raster = _raster(equilibria, known, x, y)
    lines = [line for curve in equilibria for line in _borders(curve, x, y)]
    found = regions(raster, lines)
    places = [raster.center(*cell) for cell in found.inside]
    cuts = [_cut(system, equilibria, known, (x, y), at, raster) for at in places]
    computed = tuple(Region(at, tuple(_solutions(cut))) for at, cut in zip(places, cuts, strict=True))
    missed = _missed([(at[1], cut) for at, cut in zip(places, cuts, strict=True)], (x, y), raster, lines)
    notes = (*_notes(equilibria, of_orbits, found), *missed)
    return Chart((x, y), tuple(raster.low), tuple(raster.high), found.labels, computed, notes)


def _raster(curves: Sequence[Branch], known: Sequence[Branch], x: str, y: str) -> Raster:
    """The rectangle that the curves were looked for in; of curves that do not tell, what they and branches
    span.
    """
    spans = []
    for name in (x, y):
        asked = [np.array(b.info.settings.get(RANGES, {}).get(name, ())) for b in curves]
        values = np.concatenate([*asked, *(b[name] for b in (*curves, *known) if name in b.info.free)])
        spans.append((float(values.min()), float(values.max())))
    low, high = np.array(spans).T
    return Raster(low, np.where(high > low, high, low + np.maximum(np.abs(low), 1.0)))


def _borders(curve: Branch, x: str, y: str) -> Iterator[np.ndarray]:
    """The pieces of a curve at which solutions change, shape (m, 2) each: neutral saddles change nothing."""
    if curve.info.settings["of"] not in BORDERS:
        return
    points = np.stack([curve[x], curve[y]], axis=1)
    real = np.ones(len(points), dtype=bool)
    if FREQUENCY_SQUARED in curve.info.observables:
        real = np.asarray(curve[FREQUENCY_SQUARED] >= 0.0)
        # The Bogdanov-Takens point itself may be a rounding below.
        real |= np.isin(np.arange(len(points)), [p.index for p in curve.special_points if p.label == "BT"])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], real.astype(int), [0]])))
    outside = np.array(curve.gaps(), dtype=int) + 1
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        yield from np.split(points[start:stop], outside[(outside > start) & (outside < stop)] - start)
    if curve.outcome.reason == "closed" and real.all():
        yield points[[-1, 0]]


def _notes(curves: Sequence[Branch], of_orbits: Sequence[Branch], found: Regions) -> Iterator[str]:
    open_ends = ("bound", "closed")
    for curve in curves:
        ends = [p for p in curve.special_points if p.label == END and p.kind not in open_ends]
        if ends and curve.info.settings["of"] in BORDERS and curve.outcome.reason not in open_ends:
            yield (
                f"{curve.name} ends inside the chart ({curve.outcome.reason}): regions on its sides run into "
                "each other there."
            )
    if found.too_small:
        count = found.too_small
        which = f"{count} regions are" if count > 1 else "1 region is"
        yield f"{which} too small to be told from the lines, and not filled."
    if of_orbits:
        names = ", ".join(branch.name for branch in of_orbits)
        yield f"Curves of orbits ({names}) do not change equilibria, and divide no region."


# -- what is at a place ------------------------------------------------------------------------------------


def _cut(
    system: System,
    curves: Sequence[Branch],
    known: Sequence[Branch],
    names: tuple[str, str],
    at: tuple[float, float],
    raster: Raster,
) -> list[Branch]:
    """All branches along the first parameter that begin at what is known, the place marked on them."""
    x, x0 = names[0], at[0]
    settings = Settings(
        range=(float(raster.low[0]), float(raster.high[0])),
        max_points=POINTS,
        marks=(Mark(x, (x0,)),),
    )

    def starts() -> Iterator[Start]:
        for parameters, state in _beginnings(system, curves, known, names, at, raster):
            try:
                opening = opened(system, parameters, x, state, settings)
            except outcomes.BREAKDOWNS:
                continue
            if not isinstance(opening, Outcome):
                yield Start(system, x, dict(parameters), opening, "chart")

    diagram = Diagram(starts(), Plan(settings, CROSSINGS, 3))
    for _ in diagram.events():
        pass
    return diagram.branches


def _solutions(cut: Sequence[Branch]) -> list[Solution]:
    """The solutions at the place of a cut."""
    found: list[Solution] = []
    for branch in cut:
        for point in branch.special_points:
            if point.label == MARK and point.kind == "parameter":
                found.append(Solution(point.unstable_after, point.admissible, dict(point.state)))
    return _different(found)


def _missed(
    cuts: Sequence[tuple[float, Sequence[Branch]]],
    names: tuple[str, str],
    raster: Raster,
    lines: Sequence[np.ndarray],
) -> Iterator[str]:
    """Where solutions change on a cut, at a value of the second parameter, and no line is."""
    met = np.concatenate([np.zeros((0, 2), dtype=int), *(raster.met(line) for line in lines)])
    x, y = names
    places: dict[tuple[str, int, int], str] = {}
    for y0, cut in cuts:
        for point in (p for branch in cut for p in branch.special_points if p.label in BORDERS):
            x0 = point.parameters[x]
            for cell in raster.met(np.array([[x0, y0], [x0, y0]]))[:1]:
                if np.min(np.abs(met - cell).max(axis=1), initial=BESIDE_LINE + 1) > BESIDE_LINE:
                    place = f"{point.label} at {x} = {x0:.6g}, {y} = {y0:.6g}"
                    places.setdefault((point.label, int(cell[0]), int(cell[1])), place)
    if places:
        every = "; ".join(places.values())
        yield (
            f"Solutions change where no curve was followed ({every}): the numbers of the "
            "region there hold on one side only. Compute the branches there too, and follow these points."
        )


def _different(solutions: Sequence[Solution]) -> list[Solution]:
    """Each solution once."""
    kept: list[Solution] = []
    for solution in solutions:
        state = np.array(list(solution.state.values()))
        if not any(np.allclose(state, list(k.state.values()), rtol=1e-7, atol=1e-10) for k in kept):
            kept.append(solution)
    return kept


def _beginnings(
    system: System,
    curves: Sequence[Branch],
    known: Sequence[Branch],
    names: tuple[str, str],
    at: tuple[float, float],
    raster: Raster,
) -> Iterator[tuple[dict[str, float], np.ndarray]]:
    """Parameters and states, shape (n,), at the place's value of the second parameter."""
    (x, y), y0 = names, at[1]
    for branch in known:
        yield from _carried(system, branch, names, at)
    for curve in curves:
        values, gaps = curve[y] - y0, curve.gaps()
        for k in np.flatnonzero(values[:-1] * values[1:] <= 0.0):
            if values[k] == values[k + 1] or int(k) in gaps:
                continue
            part = values[k] / (values[k] - values[k + 1])
            row, following = curve.points[k], curve.points[k + 1]
            state = row["state"] + part * (following["state"] - row["state"])
            value = float(curve[x][k] + part * (curve[x][k + 1] - curve[x][k]))
            parameters = {**curve.info.parameters, x: value, y: y0}
            beside = _beside(system, parameters, x, state)
            if beside is not None:
                yield beside


def _carried(
    system: System, branch: Branch, names: tuple[str, str], at: tuple[float, float]
) -> Iterator[tuple[dict[str, float], np.ndarray]]:
    """Solutions of a known branch, carried along the parameter that is fixed on it to the place's value."""
    (x, y), (x0, y0) = names, at
    free = branch.info.free[0]
    other, value, there = (y, y0, x0) if free == x else (x, x0, y0)
    begun = float(branch.info.parameters[other])
    values = branch[free] - there
    rows = [int(k) for k in np.flatnonzero(values[:-1] * values[1:] <= 0.0)]
    for k in dict.fromkeys([*rows, 0, len(branch) // 2, len(branch) - 1]):
        state = np.array(branch.points["state"][k])
        parameters = {**branch.info.parameters, free: float(branch[free][k])}
        if begun == value:
            yield {**parameters, other: value}, state
            return
        low, high = sorted((begun, value))
        try:
            carried = continue_branch(
                Equilibrium(system, parameters, other),
                state.tolist(),
                range=(low, high),
                direction="forward" if value > begun else "backward",
            )
        except outcomes.BREAKDOWNS:
            continue
        ends = np.flatnonzero(carried[other] == value)
        for end in ends[-1:]:
            yield {**parameters, other: value}, np.array(carried.points["state"][end])
        if len(ends):
            return


def _beside(
    system: System, parameters: dict[str, float], x: str, state: np.ndarray
) -> tuple[dict[str, float], np.ndarray] | None:
    """A regular solution beside a place on a curve, where it may be a fold."""
    problem = Equilibrium(system, parameters, x)
    z = np.append(state, parameters[x])
    try:
        linearization = problem.linearize(z)
        magnitudes = linearization.magnitudes
        weights = np.where(np.isfinite(magnitudes) & (magnitudes > 0.0), magnitudes, 1.0)
        tangent = kernel_direction(linearization.jacobian, weights)
        found = correct(problem, z + BESIDE_FOLD * tangent, tangent / weights**2, weights, 20)
    except outcomes.BREAKDOWNS:
        return None
    if not found.ok:
        return None
    return {**parameters, x: float(found.z[-1])}, found.z[:-1]
