"""Recognising a branch that is already known, by its points and by their images under declared symmetries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol, cast

import numpy as np

from contwalk.branch import Branch
from contwalk.continuation.newton import correct
from contwalk.errors import NotFinite
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.problems.images import MOST_IMAGES, Product, imaged, in_words
from contwalk.problems.problem import Problem, Sample, at_stored, equations_at
from contwalk.problems.stored_alike import of_the_same, stored_like
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues


class _Comparable(Problem, Protocol):
    """A problem whose branches are recognised: of a system, held along neutral directions."""

    system: System
    pins: Sequence[Neutral]

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, by name."""


class _Imaged(_Comparable, Protocol):
    """One whose solutions are compared as they are."""

    def image(self, symmetry: str, z: np.ndarray) -> np.ndarray:
        """Image of a solution under a declared symmetry."""


class _Closed(_Comparable, Protocol):
    """One whose solutions are closed curves, which begin anywhere on themselves."""

    subharmonic: int
    states: int
    discretization: Any

    @property
    def whole(self) -> tuple[str, int]:
        """How the orbit closes, and how many closures its period has."""

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds."""

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""

    def first_state(self, z: np.ndarray) -> np.ndarray:
        """The state at the start, shape (n,)."""

    def first_passed(self, z: np.ndarray, points: Sequence[np.ndarray], error: float = 0.0) -> int | None:
        """Number of the first of some states that the orbit of z passes; None if it passes none."""


# Solutions nearer than this, in the metric, are the same one: far above the corrector's error, far below a
# step.
SAME = 1e-7
# And this near in the metric of the other branch, in which an unknown may be rounding noise.
MET = 1e-4
# A branch is compared with another by its points and its way: cosine between the two, and how far to look
# for it. The way of an interpolated arc is known to the cube of what it turns, a thousandth after halving.
ALONG = 0.99999
BESIDE = 1e-4
# How often an arc is halved round a solution; how far from the interpolation the branch is, in its lengths.
HALVINGS = 3
NEAR = 1e-2


Pair = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Known:
    """The branch on which a solution lies, or its image under the symmetries of these names in turn."""

    branch: str
    symmetries: tuple[str, ...] = ()

    def sentence(self, what: str) -> str:
        """That a branch is not walked again; `what` tells where it would have begun."""
        if not self.symmetries:
            return f"{what} lies on branch {self.branch}, already known."
        return (
            f"{what} is the image of branch {self.branch} under {in_words(self.symmetries)}, already known."
        )


def images(problem: _Imaged, z: np.ndarray, beyond: np.ndarray) -> Iterator[tuple[Product, Pair]]:
    """z and a point beside it on its branch, and their images under products of the declared symmetries.

    All of them have the shape (N + 1,). At most `MOST_IMAGES` are given, no two alike.
    """
    found = [(Product(), (z, beyond))]
    for product, current in found:
        yield product, current
        for symmetry in problem.system.symmetries:
            image = problem.image(symmetry.name, current[0])
            new = all(not np.allclose(image, other[0], rtol=1e-12, atol=1e-14) for _, other in found)
            if new and len(found) < MOST_IMAGES:
                found.append((product.then(symmetry), (image, problem.image(symmetry.name, current[1]))))


def known_branch(problem: Problem, sample: Sample, branches: list[Branch]) -> Known | None:
    """The branch that a solution and its tangent lie on, or their images; None if it is new."""
    if problem.meshed is not None:
        return known_orbit(cast(_Closed, problem), sample, branches)
    problem = cast(_Imaged, problem)
    candidates = [b for b in branches if _comparable(problem, b)]
    beyond = sample.z + BESIDE * sample.tangent
    for product, pair in images(problem, sample.z, beyond):
        for branch in candidates:
            if _on(problem, pair, sample.weights, branch):
                return Known(branch.name, product.names)
    return None


def _comparable(problem: _Comparable, branch: Branch) -> bool:
    """Whether a branch belongs to the same equations at the same fixed parameters."""
    info = branch.info
    if info.problem != problem.kind or info.free != problem.line.names or len(branch.points) < 2:
        return False
    if branch.info.settings.get("pins") != [pin.name for pin in problem.pins]:
        return False
    if "of" in info.settings and not of_the_same(info.settings, problem.branch_facts()["settings"]):
        return False  # curves of other special points
    # Along a path, a problem may have been made at any of its points.
    moving = problem.line.moving_names
    fixed = {name: v for name, v in problem.line.parameters.items() if name not in moving}
    return all(branch.info.parameters.get(name) == v for name, v in fixed.items())


def _on(problem: _Imaged, pair: Pair, weights: np.ndarray, branch: Branch) -> bool:
    """Whether z lies on the curve through a branch's points, each piece recomputed where it passes z.

    Arcs are measured in the metric that the branch was walked in: in another one they may not be short. At
    last z must be met in its own metric (`weights`) too.
    """
    z, along = pair[0], pair[1] - pair[0]
    # At a special point the equations may not determine the way, as those of a curve at a double zero.
    points = np.delete(branch.points, [each.index for each in branch.special_points if each.label != "EP"])
    own, tangents = points["weights"], points["tangent"]
    rows = np.column_stack([points["unknowns"], points["free"][:, 0]])
    turned = problem.equivalence.nearest_turn(z, rows[0])
    a, chord = rows[:-1], np.diff(rows, axis=0)
    normal = chord / own[:-1] ** 2
    length = np.sum(normal * chord, axis=1)
    usable = length > 0
    theta = np.full(len(a), np.nan)
    theta[usable] = np.sum(normal[usable] * (turned - a[usable]), axis=1) / length[usable]
    foot = a + theta[:, None] * chord
    distance = np.linalg.norm((turned - foot) / own[:-1], axis=1)
    near = (theta > -0.01) & (theta < 1.01) & (distance < 0.5 * np.sqrt(length) + SAME)
    return any(
        _passes(
            problem,
            HermiteCurve((rows[i], rows[i + 1]), (tangents[i], tangents[i + 1]), own[i]),
            turned,
            along,
            weights,
        )
        for i in np.flatnonzero(near)
    )


def _passes(
    problem: _Imaged, arc: HermiteCurve, z: np.ndarray, along: np.ndarray, weights: np.ndarray
) -> bool:
    """Whether an arc of a branch passes a solution, of whatever metric, in its direction.

    Near a point where branches cross, the corrector may find the other one, and a place alone tells nothing.
    The arc is made shorter around the solution until its interpolation is far better than branches that
    cross there are apart: it must pass the place, and go the solution's way.
    """
    for _ in range(HALVINGS):
        theta = arc.position(z)
        middle = _middle(problem, arc)
        if middle is None:
            break
        place, way = middle
        if theta < 0.5:
            arc = HermiteCurve((arc.ends[0], place), (arc.tangents[0], way), arc.weights)
        else:
            arc = HermiteCurve((place, arc.ends[1]), (way, arc.tangents[1]), arc.weights)
    theta = arc.position(z)
    there, way, along = arc.guess(theta), arc.direction(theta) / arc.weights, along / arc.weights
    length = np.linalg.norm(way) * np.linalg.norm(along)
    if not abs(way @ along) > ALONG * length:
        return False  # it crosses the branch
    if np.linalg.norm((there - z) / arc.weights) > NEAR * arc.length + SAME:
        return False
    correction = correct(problem, there, arc.normal, arc.weights)
    apart = np.abs(correction.z - z)
    met = float(np.linalg.norm(apart / arc.weights)) < SAME
    return correction.ok and met and float(np.max(apart / weights)) < MET


def _middle(problem: _Imaged, arc: HermiteCurve) -> tuple[np.ndarray, np.ndarray] | None:
    """The branch's own solution half way along an arc and its tangent; None where that is not to be had."""
    guess = arc.guess(0.5)
    found = correct(problem, guess, arc.normal, arc.weights)
    # Farther off it may be another branch.
    near = np.linalg.norm((found.z - guess) / arc.weights) <= NEAR * arc.length
    tangent = found.tangent(arc.normal, arc.weights) if near else None
    return None if tangent is None else (found.z, tangent)


# -- orbits ------------------------------------------------------------------------------------------------

# Relative change of the period between neighbouring points within which a piece of branch is looked at.
NEAR_PERIOD = 0.05
# How exactly an orbit is brought to the level of another one, against its scale; in how many steps.
AT_LEVEL, LEVEL_STEPS = 1e-10, 8


@dataclass(frozen=True)
class Level:
    """By what the orbits of an arc are told apart, and compared with another one.

    Parameters
    ----------
    place : int, optional
        Where a free parameter stands among the unknowns; None for the period of orbits that nothing forces:
        along a canard the parameter stands still to its last digits while the period goes on.
    value : float
        Of the other orbit.
    ends : tuple of two floats
        Of the arc's ends.
    scale : float
    """

    place: int | None
    value: float
    ends: tuple[float, float]
    scale: float

    @property
    def moved(self) -> float:
        """How far the arc goes, in units of the scale."""
        return abs(self.ends[1] - self.ends[0]) / self.scale

    @property
    def passed(self) -> bool:
        """Whether the arc passes the other orbit's value."""
        low, high = sorted(self.ends)
        slack = 1e-9 * abs(self.value)
        return low - slack <= self.value <= high + slack and low < high


def known_orbit(problem: _Closed, sample: Sample, branches: list[Branch]) -> Known | None:
    """The branch that an orbit, or an image of it under a declared symmetry, lies on.

    An orbit begins anywhere on itself: candidates are recomputed at the same parameter, or of the same
    period, and compared as curves.
    """
    own = _kinds(problem, problem.branch_facts().get("signature"))
    for branch in branches:
        if not _comparable(problem, branch) or branch.info.subharmonic != problem.subharmonic:
            continue
        closures = 1
        if branch.info.closure != problem.whole[0]:
            # Of a whole orbit that is its own image, half may be what is stored.
            if problem.whole[0] != "full" or not branch.info.settings.get("image"):
                continue
            closures = 2
        if sorted(_kinds(problem, branch.info.signature) * closures) != own:
            continue
        symmetries = _orbit_on(problem, sample, branch, closures)
        if symmetries is not None:
            return Known(branch.name, symmetries)
    return None


def _kinds(problem: _Closed, signature: Sequence[str] | None) -> list[str]:
    """The events of an orbit in no order, those that are images of each other under one name.

    What closes up to a mirror may begin in either half.
    """
    images = [s.events for s in problem.system.symmetries if s.role == "spatial"]

    def kind(name: str) -> str:
        alike = [name]
        for other in alike:
            alike += [image[other] for image in images if image.get(other, name) not in alike]
        return min(alike)

    return sorted(kind(name) for name in signature or ())


def _orbit_on(problem: _Closed, sample: Sample, branch: Branch, closures: int = 1) -> tuple[str, ...] | None:
    """The symmetries whose image of an orbit a branch passes, none of them first; None if it passes none."""
    period = sample.period / closures
    # On the steps of a branch orbits are known to their error only. One that has just left another, which the
    # unknowns of a single parameter do not tell from it within that error, is another one.
    in_plane = len(problem.line.names) == 2
    alike, error = (min(float(np.fmax(SAME, sample.error)), MET),) * 2 if in_plane else (SAME, 0.0)
    for k, (ta, tb) in enumerate(pairwise(branch.points["period"])):
        a, b = branch.unknowns(k), branch.unknowns(k + 1)
        if len(a) != len(b):
            continue
        if not (1 - NEAR_PERIOD) * min(ta, tb) <= period <= (1 + NEAR_PERIOD) * max(ta, tb):
            continue
        weights = branch.points["weights"][k][: len(a)]
        levels = [Level(n, sample.z[n], (a[n], b[n]), weights[n]) for n in range(-len(problem.line.names), 0)]
        if problem.system.period is None:  # at a cusp of a curve in the plane both parameters turn
            levels.append(Level(None, period, (ta, tb), period))
        level = max(levels, key=lambda each: each.moved)
        if not level.passed:
            continue
        before, after = (branch.points["tangent"][i][: len(a)] for i in (k, k + 1))
        try:
            found = _at_level(problem, branch, HermiteCurve((a, b), (before, after), weights), level)
        except (NotFinite, np.linalg.LinAlgError):
            continue
        if found is None:
            continue
        there, z = found
        if abs(there.duration(z) - period) > alike * period:
            continue
        # A parameter that is zero along a curve is known to the errors of the others, in the metric.
        units = weights[-2:] if in_plane else 0.0
        apart = np.abs(np.subtract(_free(there, z), free := _free(problem, sample.z)))
        met = 10.0 * AT_LEVEL * weights[len(weights) - len(apart) :]  # where the parameter is zero itself
        if np.any(apart > np.maximum(alike * np.maximum(np.abs(free), units), met)):
            continue
        x, p = problem.first_state(sample.z), ParameterValues(**problem.values_of(sample.z))
        spatial = [s for s in problem.system.symmetries if s.role == "spatial"]
        passed = there.first_passed(z, [x, *[imaged(symmetry, x, p) for symmetry in spatial]], error)
        if passed is not None:
            return (spatial[passed - 1].name,) if passed else ()
    return None


def _free(problem: _Closed, z: np.ndarray) -> list[float]:
    """Values of the parameters that are free; none along a path."""
    values = problem.values_of(z)
    return [values[name] for name in problem.line.names if name in values]


def _at_level(
    problem: _Closed, branch: Branch, arc: HermiteCurve, level: Level
) -> tuple[_Closed, np.ndarray] | None:
    """The orbit on an arc of a stored branch at a level, with its problem.

    It is corrected across the arc: at the parameter itself the equations are singular at a fold, and nearly
    so where a doubled branch begins or ends, beside its parent.
    """
    value, by = level.value, np.zeros(len(arc.chord))
    if level.place is None:
        begin = arc.ends[0]
        by = at_stored(stored_like(problem, branch, begin), begin, arc.weights).duration_gradient(begin)
    else:
        by[level.place] = 1.0
    low, high = 0.0, 1.0
    rising = by @ arc.chord > 0.0
    for _ in range(60):  # of the interpolation
        theta = 0.5 * (low + high)
        low, high = (theta, high) if (by @ arc.guess(theta) < value) == rising else (low, theta)
    guess = arc.guess(theta)
    there = at_stored(stored_like(problem, branch, guess), guess, arc.weights)
    for _ in range(LEVEL_STEPS):
        correction = correct(there, guess, arc.normal, arc.weights)
        if not correction.ok or correction.linearization is None:
            return None
        left = value - float(by @ correction.z)
        if abs(left) <= AT_LEVEL * level.scale:
            return equations_at(there, correction.z)[0], correction.z
        tangent = correction.linearization.tangent(arc.normal, arc.weights)
        slope = float(by @ tangent)
        if slope == 0.0 or abs(left / slope) > 1.0:  # the tangent is one arc long
            return None
        guess = correction.z + left / slope * tangent
    return None
