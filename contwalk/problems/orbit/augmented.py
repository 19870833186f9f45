"""Special points of orbits as regular solutions of minimally augmented systems.

Beside F(u, lambda) = 0 stands a scalar g that vanishes where a matrix L is singular: the corner of its
bordered inverse, [L b; c* 0] [v; g] = [0; 1], with gradient g' = -psi* L' v and psi from the adjoint
system (W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, chapter 3).

L, and further unknowns, are those of the kind of point: see `points`.

L' v is a second derivative of the flow. It is integrated as the derivative of the tangent lift, on the same
steps; nothing is differenced. What is left is the error of the steps themselves: a point is solved for again
on steps of a hundredth of the tolerance, and on still finer ones, whose correction is the error estimate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contwalk import quantities
from contwalk.errors import NotFinite, StartError
from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.discretization import TIGHTEST
from contwalk.problems.orbit.lacking import Lacking
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.problem import Located, Sample, Test
from contwalk.problems.solving import newton_on

ITERATIONS = 14
# A correction this small, in the metric, ends the iteration at once; one that no longer shrinks below the
# second bound is rounding.
SMALL, ROUNDED = 1e-13, 1e-6
# Steps of the check that gives the error, in units of the tolerance before.
CHECK = 0.03
MOST_REFINEMENTS = 4
# A point moves by less from steps to finer ones, in the metric; where it is told by a multiplier along a
# branch on which that changes by 1e100 while the parameter stands still, by less than the second.
MOVED, MOVED_ALONG = 1e-2, 0.3
# Along such a branch: steps at most, their length, and how near to the zero they end, in the metric and in g.
MOST_MOVES, LONGEST, NEAREST, NEARLY = 100, 5e-3, 1e-8, 0.1
# A point's own multiplier is this near to what it should be there, or so many times what it is known to.
CRITICAL, KNOWN = 0.1, 10.0
# Displacement along the branch, in the metric, for the rate of a function that has no derivatives.
BESIDE = 1e-4

# residual (N + r,) and Jacobian (N + r, N + 1 + r') of an augmented system at its unknowns
Evaluate = Callable[["OrbitData", np.ndarray], tuple[np.ndarray, np.ndarray]]
# Both on the line along a first parameter, and the column (N + r,) of derivatives by a second one: of the
# orbits on the lines along each, the unknowns on the first, and the second parameter
EvaluateInPlane = Callable[
    ["OrbitData", "OrbitData", np.ndarray, float], tuple[np.ndarray, np.ndarray, np.ndarray]
]
# What is located, and all unknowns there: the same with what else is known of it.
Described = Callable[[Located, np.ndarray], Located | None]


def as_found(found: Located, y: np.ndarray) -> Located:
    """Nothing else is known of it; y has the shape (N + 1 + r',)."""
    return found


class Near(Protocol):
    """A place that a system is made near: the unknowns and their typical magnitudes, shape (N + 1,) each."""

    @property
    def z(self) -> np.ndarray:
        """The unknowns. Shape (N + 1,)."""

    @property
    def weights(self) -> np.ndarray:
        """Typical magnitudes. Shape (N + 1,)."""


@dataclass(frozen=True)
class Augmented:
    """An augmented system for any discretisation of a problem, its start, and typical magnitudes.

    `in_units`: whether its last rows are numbers in units of their own, as a guard or an observable is; else
    they are bordered inverses, whose terms are of size one. `across`: the gradient along the branch,
    shape (N + 1,), where on other steps the point may lie so far along theirs that it has to be walked to.
    `in_plane`: derivatives by two parameters at once, where that is cheaper than `evaluate` on both lines.
    `described`: a point that solves it, at unknowns of shape (N + 1 + r',), with what else is known of it;
    None where it turns out to be none. `critical`: the null vector of L, shape (N,).
    """

    evaluate: Evaluate
    start: np.ndarray
    scale: np.ndarray
    described: Described = as_found
    in_units: bool = False
    across: np.ndarray | None = None
    in_plane: EvaluateInPlane | None = None
    critical: Callable[[OrbitData, np.ndarray], np.ndarray] | None = None

    def over(
        self, first: OrbitData, second: OrbitData, y: np.ndarray, value: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual and Jacobian of the orbit on a line along a parameter, and derivatives by another one.

        `second` is the orbit on the line along that, which has the `value`; the column has the shape
        (N + r,).
        """
        place, n = y.copy(), first.size
        place[n] = value
        first, second = first.at_kinks(y[: n + 1]), second.at_kinks(place[: n + 1])
        if self.in_plane is not None:
            return self.in_plane(first, second, y, value)
        return *self.evaluate(first, y), self.evaluate(second, place)[1][:, n]


def located(problem: OrbitData, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
    """The point of a kind near a sample, found on its own steps; `refine` finds it on finer ones."""
    try:
        system = kind.system(problem, sample, which)
        found = None if system is None else solved(problem, system, sample)
    except (np.linalg.LinAlgError, NotFinite):
        return None
    # A fold of pinned equations moves no multiplier.
    told = kind.multiplier == -1.0 or (kind.test is Test.TURN and not problem.pins)
    if found is None or kind.multiplier is None or not told:
        return found
    critical = kind.multiplier
    return replace(found, refine=lambda: _with_multiplier(found.settled(), critical))


def _with_multiplier(found: Located | None, critical: float) -> Located | None:
    """A point that has a critical multiplier, as far as that is known, or None.

    Where deviations grow by more than double precision holds, an augmented system may be singular elsewhere.
    """
    if found is None:
        return None
    known = found.problem.multipliers(found.z, found.problem.linearize(found.z).jacobian)
    each = known.accuracy if known.accuracies is None else known.accuracies
    return None if np.all(np.abs(known.values - critical) > CRITICAL + KNOWN * each) else found


def solved(problem: OrbitData, system: Augmented, sample: Sample) -> Located | None:
    """The solution of an augmented system with its refinement."""
    size = problem.size
    lacking = _lacking(problem, system, sample)
    rough = _newton(problem, system, system.start, lacking)
    if rough is None:
        return None
    walking = 1e3 * problem.mesh.tolerance * abs(float(rough[size]))
    found = system.described(Located(rough[: size + 1], walking, problem=problem), rough)
    return found and replace(found, refine=lambda: _refined(problem, system, rough, sample, lacking))


def _lacking(problem: OrbitData, system: Augmented, sample: Sample) -> Lacking:
    """What derivatives of the last rows lack where the field bends, as differences along the branch tell it.

    Where it is linear by pieces, nothing else is in them.
    """
    size = problem.size
    lacking = Lacking(size, system.scale)
    if problem.at_kinks(sample.z) is problem:
        return lacking
    direction = np.zeros(len(system.start))
    direction[: size + 1] = sample.tangent
    ahead, behind = (
        _evaluated(problem, system, system.start + h * direction)[0][size:] for h in (BESIDE, -BESIDE)
    )
    lacking.along(direction, (ahead - behind) / (2.0 * BESIDE), _evaluated(problem, system, system.start)[1])
    return lacking


def _refined(
    problem: OrbitData, system: Augmented, rough: np.ndarray, sample: Sample, lacking: Lacking
) -> Located | None:
    """The point on steps fine enough for the accuracy that is asked for, with its estimated error."""
    size, wanted = problem.size, problem.discretization.accuracy
    free = {name: size - k for k, name in enumerate(problem.line.names)}
    tolerance = min(problem.discretization.locating, problem.mesh.tolerance)
    found, finer = rough, problem
    best: tuple[dict[str, float], np.ndarray, OrbitData] | None = None
    for _ in range(MOST_REFINEMENTS):
        try:  # on finer steps a motion may meet what it stepped over before
            finer = problem.refined(found[: size + 1], sample.weights, tolerance)
            solution = _newton(finer, system, found, lacking)
            if solution is None:
                break
            found = solution
            checked = max(CHECK * tolerance, TIGHTEST)
            check = problem.refined(found[: size + 1], sample.weights, checked)
            correction = _checked(check, system, found, lacking)
        except NotFinite:
            if best is not None or tolerance >= problem.mesh.tolerance:
                break
            tolerance = min(tolerance / CHECK, problem.mesh.tolerance)  # the field is not smooth to so much
            continue
        if correction is None:
            break
        rounding = _rounding(check, system, found, list(free.values()))
        errors = {
            name: 4.0 * abs(float(correction[place])) + noise
            for (name, place), noise in zip(free.items(), rounding, strict=True)
        }
        found, finer = found - correction, check
        if best is None or all(errors[name] < best[0][name] for name in free):
            best = (errors, found, finer)
        enough = all(errors[name] <= 0.3 * wanted * abs(float(found[place])) for name, place in free.items())
        if enough or tolerance <= 4.0 * TIGHTEST:
            break
        tolerance = max(0.01 * tolerance, 4.0 * TIGHTEST)
    if best is None:
        return None
    errors, found, finer = best
    moved = np.abs(found - rough)[: size + 1] / sample.weights
    if not np.max(moved) < (MOVED if system.across is None else MOVED_ALONG):
        return None  # refinement has left the neighbourhood
    named = errors if len(free) > 1 else {}
    error = errors[problem.line.free]
    point: Located = Located(found[: size + 1], error, refined=True, problem=finer, errors=named)
    return system.described(point, found)


def _rounding(problem: OrbitData, system: Augmented, y: np.ndarray, places: Sequence[int]) -> list[float]:
    """What rounding of the equations does to the free parameters, which stand at some places."""
    size = problem.size
    level, _ = problem.linearize(y[: size + 1]).levels
    own = np.minimum(
        level, 1e2 * EPSILON * (np.abs(problem.jacobian(y[: size + 1])) @ system.scale[: size + 1])
    )
    _, jacobian, _ = _evaluated(problem, system, y)
    last = jacobian[size:]
    terms = np.abs(last) @ system.scale if system.in_units else np.ones(len(last))
    noise = np.concatenate([own, 1e2 * EPSILON * terms])
    factored = problem.factored(jacobian, system.scale)
    rows = (factored.solve_adjoint(np.eye(len(y))[place]) for place in places)
    each = zip(places, rows, strict=True)
    return [float(np.abs(row) @ noise) + EPSILON * abs(float(y[place])) for place, row in each]


def _newton(problem: OrbitData, system: Augmented, start: np.ndarray, lacking: Lacking) -> np.ndarray | None:
    """Newton's method to the rounding of the equations; None where it does not get there."""
    lacking.on_other_steps()
    y, before = _begun(problem, system, start).copy(), np.inf
    for iteration in range(ITERATIONS):
        correction = _correction(problem, system, y, lacking)
        if correction is None:
            return None
        size = float(np.max(np.abs(correction) / system.scale))
        if iteration and size > 0.5 * before and before < ROUNDED:
            return y
        if not size < 1e3:
            return None
        y, former, before = y - correction, before, size
        # One more step from here would be the square of this one, and this one times the last by secants.
        further = size if problem.at_kinks(y[: problem.size + 1]) is problem else former
        if size < SMALL or size * further < 1e-3 * problem.mesh.tolerance:
            return y
    return None


def _begun(problem: OrbitData, system: Augmented, start: np.ndarray) -> np.ndarray:
    """Where Newton's method begins on some steps: at a start, or at the zero of g along their branch."""
    if system.across is None:
        return start
    try:
        return _along_branch(problem, system, start, system.across)
    except (StartError, np.linalg.LinAlgError):
        return start


def _along_branch(problem: OrbitData, system: Augmented, start: np.ndarray, across: np.ndarray) -> np.ndarray:
    """The orbit nearest to where g vanishes, by secants of g, between its signs once both are known.

    `start` and `across` have the shape (N + 1,).

    Raises
    ------
    StartError, numpy.linalg.LinAlgError
        If the branch cannot be followed there.
    """
    weights = system.scale
    y = newton_on(problem, start, weights, across)
    residual, jacobian, _ = _evaluated(problem, system, y)
    g, slope = float(residual[-1]), 0.0
    place, other = 0.0, np.nan  # along the branch, and where g has the other sign, as far as that is known
    for _ in range(MOST_MOVES):
        tangent = problem.linearize(y).tangent(across, weights)
        slope = slope or float(jacobian[-1] @ tangent)
        move = -g / slope if slope else np.nan
        if not (abs(move) > NEAREST or abs(g) > NEARLY):
            break
        if other == place:  # to rounding, both signs are here
            break
        if not np.isnan(other) and not 0.0 < move / (other - place) < 1.0:
            move = 0.5 * (other - place)
        move = float(np.clip(move, -LONGEST, LONGEST))
        further = newton_on(problem, y + move * tangent, weights, across)
        after = float(_evaluated(problem, system, further)[0][-1])
        if not np.isfinite(after):
            break
        if after * g < 0.0:
            other = place
        y, g, slope, place = further, after, (after - g) / move, place + move
    return y


def _checked(problem: OrbitData, system: Augmented, y: np.ndarray, lacking: Lacking) -> np.ndarray | None:
    """The correction of a solution on other steps."""
    begun = _begun(problem, system, y)
    lacking.on_other_steps()
    correction = _correction(problem, system, begun, lacking)
    return correction if correction is None or begun is y else y - begun + correction


def _correction(problem: OrbitData, system: Augmented, y: np.ndarray, lacking: Lacking) -> np.ndarray | None:
    try:
        residual, jacobian, bent = _evaluated(problem, system, y)
        jacobian = lacking.added(y, residual, jacobian) if bent else jacobian
        if not (np.all(np.isfinite(residual)) and np.all(np.isfinite(jacobian))):
            return None
        return problem.factored(jacobian, system.scale).solve(residual)
    except (np.linalg.LinAlgError, NotFinite):
        return None


def _evaluated(problem: OrbitData, system: Augmented, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Residual and Jacobian at y, on steps that hold no kink of the field, and whether there are any."""
    there = problem.at_kinks(y[: problem.size + 1])
    return *system.evaluate(there, y), there is not problem


# -- marks -------------------------------------------------------------------------------------------------


def observed(problem: OrbitData, name: str, level: float, sample: Sample) -> Located | None:
    """The point near a sample at which an observable has a value: Newton's method along the branch."""
    from contwalk.problems.orbit import rates

    def value(there: OrbitData, z: np.ndarray) -> float:
        if name != there.observable_names[-1]:
            return there.observable(name, z) - level
        found = there.multipliers(z, there.linearize(z).jacobian)
        return float(there.observables(z, found)[-1]) - level

    try:
        if name == quantities.PERIOD:
            system: Augmented | None = _lasting(level, sample)
        else:
            system = along(sample, value, rates.of_observable(problem, name, sample))
        found = None if system is None else solved(problem, system, sample)
    except (np.linalg.LinAlgError, NotFinite):
        return None
    return found if found is not None and np.all(np.isfinite(found.z[: problem.size + 1])) else None


def _lasting(level: float, sample: Sample) -> Augmented:
    """A closure that lasts so long; unlike other observables its derivatives are known."""

    def evaluate(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return there.linearize(z).with_row(there.duration(z) - level, there.duration_gradient(z))

    return Augmented(evaluate, sample.z, sample.weights, in_units=True)


def along(sample: Sample, value: Callable[[OrbitData, np.ndarray], float], slope: float) -> Augmented | None:
    """F = 0 and a function that vanishes at a point of the branch; `slope` is its rate along it there."""
    if not np.isfinite(slope) or slope == 0.0:
        return None
    gradient = slope * sample.tangent / sample.weights**2

    def evaluate(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return there.linearize(z).with_row(value(there, z), gradient)

    return Augmented(evaluate, sample.z, sample.weights, in_units=True)


def where_zero(
    problem: OrbitData,
    sample: Sample,
    value: Callable[[OrbitData, np.ndarray], float],
    beside: float = BESIDE,
) -> Augmented | None:
    """F = 0 and a function of an orbit and its unknowns (N + 1,) that passes zero near a sample.

    Its rate is the difference of the motions displaced by `beside` along the tangent to both sides; None
    where there is none, as at an extremum.
    """
    ahead, behind = (value(problem, sample.z + h * sample.tangent) for h in (beside, -beside))
    return along(sample, value, (ahead - behind) / (2.0 * beside))
