"""Whether a family of orbits ends in a homoclinic orbit, and at which parameter.

That the parameter hardly changes while the period grows is true of a fold of an orbit with a slow phase too.
An orbit that comes near a homoclinic one passes an equilibrium, ever more closely, and the equilibrium's own
eigenvalues tell how the parameter converges (Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 2004,
chapters 6 and 7):

| equilibrium | lambda - lambda_h |
|---|---|
| saddle, leading eigenvalue real | falls like exp(-kappa T), kappa the smaller of the two leading rates |
| saddle-focus whose pair leads | Re(c exp((-rho + i omega) T)): folds without end |
| saddle-node, just gone | falls like 1 / (T - T_0)^2, while the least speed does |

They tell how the orbit comes as well: its least distance is where what is drawn in at the rate mu and what is
repelled at the rate nu are alike, and falls like exp(-mu nu T / (mu + nu)).

Far from its limit an orbit that comes to a saddle slowly and leaves it fast is still on its way: it follows
the saddle's stable manifold along what repels it, as a canard, and its rate is not yet the saddle's own. Then
how its least distance falls tells that it comes, and the rate that is seen is the later one but for a factor.

Two neighbouring orbits of the walk raise the suspicion. They decide on the finest steps, their periods held,
with orbits of longer periods: what the walk's own steps do to the parameter is mostly more than what is left
of its way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.branch import Outcome
from contwalk.numerics.laws import LAWFUL, Limit, Pair, falling, inverse_square, swinging
from contwalk.problems.marching import PERIOD, march, pair_of
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.problem import Sample

# An orbit that is this slow somewhere, against its fastest, passes an equilibrium, or where one has been.
CREEPING = 1e-2
# An equilibrium this near to the orbit, in units of its range, is passed by it; one this near is so near that
# its law is hidden, by steps of the walk or by others that are passed; one this near may be what the orbit is
# on its way to.
PASSED, AT_REST, NEARING = 2e-2, 1e-3, 0.3
# How far from the rate of its equilibrium the parameter may be where another one is seen.
ABOUT = 4.0
# A saddle is left far faster than it is come to, if it is so many times.
FAR_FASTER = 10.0
# A parameter this near to its limit, relative to itself, is at it.
LEAST_REST = 1e-10
# What is left of its way, relative to itself, when orbits of longer periods tell no more.
ROUNDING = 1e-13
# A parameter below this part of its magnitude tends to zero.
NEAR_ZERO = 1e-3
# The extrapolated limit is better than the last value by more than this.
REST = 10.0
# Equilibria that are one agree to this part of the orbit's range, eigenvalues of images to this part.
ALIKE = 1e-6
# Rates times periods are not larger: the rest is not asked for before the slope can be small enough.
MOST_TURNS = 300.0


@dataclass(frozen=True)
class _Law:
    """A limit by a law, what else is true of the orbit before if the law holds, and what is passed there."""

    limit: Limit
    obeyed: Callable[[list[SlowPlace]], bool]
    where: str


@dataclass(frozen=True)
class _Approached:
    """A limit of the parameter, its error, from which parameter and period it is extrapolated, and what is
    passed there.
    """

    value: float
    error: float
    last: float
    period: float
    where: str


@dataclass(frozen=True)
class _Equilibrium:
    """An equilibrium beside a slow place, shape (n,), and how an orbit leaves it and comes to it."""

    place: SlowPlace
    rest: np.ndarray

    @cached_property
    def distance(self) -> float:
        """Of the orbit, in units of its range."""
        return self.place.distance(self.rest)

    @cached_property
    def values(self) -> np.ndarray:
        """Eigenvalues, shape (n,)."""
        return np.sort_complex(np.linalg.eigvals(self.place.jacobian(self.rest)))

    @cached_property
    def leading(self) -> list[complex]:
        """The slowest eigenvalue that repels, if there is one, and the slowest that draws in."""
        sides = (self.values[self.values.real > 0.0], self.values[self.values.real < 0.0])
        return [complex(side[np.argmin(np.abs(side.real))]) for side in sides if len(side)]

    @property
    def saddle(self) -> bool:
        """Whether it repels, and draws in as well."""
        return len(self.leading) == 2

    @property
    def slowest(self) -> float:
        """The rate at which orbits that pass come nearer: to a saddle at one rate, and away at the other."""
        return 1.0 / sum(1.0 / abs(value.real) for value in self.leading)

    def is_(self, other: _Equilibrium) -> bool:
        """Whether both are one: an orbit is slow more than once where it winds about it."""
        if self.place.names != other.place.names:
            return False
        apart = (self.rest - other.rest) / self.place.scale
        return bool(np.linalg.norm(apart) <= ALIKE)

    def like(self, other: _Equilibrium) -> bool:
        """Whether their eigenvalues agree, as those of images of each other do."""
        same = self.values.shape == other.values.shape
        return same and bool(np.allclose(self.values, other.values, rtol=ALIKE))

    def come_nearer(self, before: list[SlowPlace]) -> float:
        """The logarithm of by how much an orbit is nearer than one before, with these slow places; NaN where
        that does not pass the equilibrium.
        """
        known = ((p, p.equilibrium(self.rest)) for p in before if p.names == self.place.names)
        distances = [p.distance(old) for p, old in known if old is not None]
        return float(np.log(min(distances, default=np.nan) / self.distance))

    def grown(self, before: list[SlowPlace]) -> float:
        """The logarithm of by how much the range of an orbit is larger than of one before, with these slow
        places; NaN where that is slow elsewhere.
        """
        known = (np.log(self.place.scale / p.scale).max() for p in before if p.names == self.place.names)
        return float(next(known, np.nan))


def homoclinic(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end at a homoclinic or heteroclinic orbit, where two neighbouring orbits show that it is near."""
    if problem.forced or not b.period > a.period:
        return None
    rises = np.array([problem.duration_gradient(s.z) @ s.tangent for s in (a, b)])
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.array([a.tangent[-1], b.tangent[-1]]) / rises
    # A limit at zero is known to a part of what the parameter is elsewhere.
    typical = float(b.weights[-1])
    size = max(abs(float(b.z[-1])), NEAR_ZERO * typical)
    wanted = max(REST * problem.discretization.accuracy, LEAST_REST) * size
    # Errors of the walk's steps turn the parameter by as much, and may hide its law.
    noise = float(np.nan_to_num(a.error + b.error)) * typical
    if not np.all(np.isfinite(slopes)) or abs(slopes[1]) * b.period > max(MOST_TURNS * wanted, noise):
        return None
    pair = Pair(np.array([a.period, b.period]), np.array([a.z[-1], b.z[-1]]), slopes)
    places = _creeping(problem, b.z)
    near = [law for law in _laws(places, pair, problem.eventful, typical) if law.limit.swing <= wanted]
    before = problem.slow_places(a.z) if near else []
    if not (any(law.obeyed(before) for law in near) or _lies_within(places, pair, max(REST * wanted, noise))):
        return None
    found = _approached(problem, (a, b), wanted)
    if found is None:
        return None
    line, digits = problem.line, 12 if found.error >= 1e-10 * abs(found.value) else 16
    last = line.described(found.last, None, digits).removeprefix(f"{line.free} = ")
    return Outcome(
        "stopped",
        "homoclinic",
        f"The period runs off ({problem.system.lasting(b.period, '.4g')} here) while the orbit creeps past "
        f"{found.where}: {_of_what(problem.eventful)} at {line.described(found.value, found.error, digits)}, "
        f"by extrapolation from {last}, where the period is "
        f"{problem.system.lasting(found.period, '.4g')}.{_doubt(b)} Nothing to do.",
    )


def saddle_ahead(problem: OrbitData, before: np.ndarray, z: np.ndarray) -> str | None:
    """The saddle that an orbit creeps past, or is on its way to, as `x = 1, y = 2`; None where there is none,
    or it has not come nearer since the orbit before as its eigenvalues say.

    Both have the shape (N + 1,).
    """
    near = _equilibria([] if problem.forced else _creeping(problem, z))
    earlier = problem.slow_places(before) if near else []
    longer = problem.duration(z) - problem.duration(before)
    comes = (
        own.place.described(own.rest)
        for own in near
        if own.saddle and own.distance <= NEARING
        if own.come_nearer(earlier) >= own.slowest / ABOUT * longer
    )
    return next(comes, None)


def _approached(problem: OrbitData, samples: tuple[Sample, Sample], wanted: float) -> _Approached | None:
    """The limit as orbits of longer and longer periods tell it, until rounding is all that is left of the way
    to it.

    None where there are none. The first two must come to what they pass as its law says; each later one must
    tell the limit within the error of the one before: where it does not, its parameter is rounding.
    """
    a, b = samples
    found: _Approached | None = None
    last, before = None, list[SlowPlace]()
    left = max(wanted, abs(b.parameter - a.parameter))
    for place in march(problem, PERIOD, samples, b.period - a.period, left):
        slow, value = _creeping(place.problem, place.z), float(place.z[-1])
        if last is not None:
            with np.errstate(over="ignore", invalid="ignore"):  # what overflows obeys none
                pair = pair_of(last, place)
                laws = _standing(slow, pair, last.error + place.error)
                laws = laws or _laws(slow, pair, problem.eventful, float(b.weights[-1]))
            if found is None:
                laws = [law for law in laws if law.limit.swing <= wanted and law.obeyed(before)]
            elif laws:
                told, allowed = found.value, found.error
                laws = [law for law in laws if abs(value + law.limit.rest - told) <= allowed]
            if not laws:
                break
            nearest = min(laws, key=lambda law: law.limit.error)
            error = nearest.limit.error + place.error
            if found is not None and error >= found.error:
                break
            where = nearest.where if found is None else found.where
            found = _Approached(value + nearest.limit.rest, error, value, place.at, where)
            if nearest.limit.swing <= max(ROUNDING * abs(value), place.error):
                break
        last, before = place, slow
    return found


def _creeping(problem: OrbitData, z: np.ndarray) -> list[SlowPlace]:
    """The slow places that may be beside an equilibrium; z has the shape (N + 1,)."""
    return [place for place in problem.slow_places(z) if place.slowness <= CREEPING]


def _equilibria(places: list[SlowPlace]) -> list[_Equilibrium]:
    """The equilibria beside slow places, one for each place that has one."""
    return [_Equilibrium(place, rest) for place in places if (rest := place.equilibrium()) is not None]


def _lies_within(places: list[SlowPlace], pair: Pair, hidden: float) -> bool:
    """Whether a saddle is passed so closely, and its slowest rate tells a limit so near, that the walk's own
    steps may hide the law: its slope is noise then, and a walk would go on in that for ever.
    """
    slope = abs(float(pair.slopes[1]))
    return any(
        own.saddle and own.distance <= AT_REST and slope <= hidden * np.abs(own.values.real).min()
        for own in _equilibria(places)
    )


def _of_what(eventful: bool) -> str:
    if not eventful:
        return "a homoclinic or heteroclinic orbit"
    return "a homoclinic or heteroclinic orbit, or one that an event begins or ends at that equilibrium,"


def _doubt(sample: Sample) -> str:
    """A sentence where the multipliers of an orbit are not known to their size."""
    largest = float(np.abs(sample.eigenvalues).max(initial=1.0))
    lost = np.any((sample.errors >= np.abs(sample.measures)) & (sample.measures > 0.0))
    if (sample.spectrum_error or 0.0) < largest and not lost:
        return ""
    return " Its last multipliers are not known to their size, and are not counted as unstable."


def _laws(places: list[SlowPlace], pair: Pair, eventful: bool, size: float) -> list[_Law]:
    """The laws that the parameter, of a size, obeys: of equilibria passed, or of one that has gone."""
    found, near = list[_Law | None](), list[_Equilibrium]()
    for own in _equilibria(places):
        if own.distance <= NEARING and not any(own.is_(other) for other in near):
            near.append(own)
    passed = [own for own in near if own.distance <= PASSED]
    for own in near:
        alike = max(sum(other.like(own) for other in passed), 1)
        law = _passing(own, pair, eventful, alike) if own.distance <= PASSED else None
        found.append(law or _coming(own, pair, eventful))
    if places and not passed:
        found.append(_gone(places[0], pair, size))
    return [law for law in found if law is not None]


def _passing(own: _Equilibrium, pair: Pair, eventful: bool, alike: int) -> _Law | None:
    """The limit of orbits that pass an equilibrium, or several alike in a round, by its leading eigenvalue.

    A reset may put the state beside the equilibrium, or an event take it away from there, and forget how it
    came: then either of the leading ones may tell, and there may be one only. A pair swings about a
    saddle-focus only: what is drawn in by a focus on all sides does not leave it, and what a reset puts
    beside one that repels all leaves it the faster, the further away it begins. A round past several alike,
    as images of each other are, grows by a part of the period at each: whether it does, the way between both
    orbits tells.
    """
    leading = sorted(own.leading, key=lambda value: abs(value.real))
    shares = sorted({1, alike})
    allowed = (1.0 / ABOUT, ABOUT) if own.distance < AT_REST else (1.0 - LAWFUL, 1.0 + LAWFUL)
    for value in leading if eventful else leading[:1] if own.saddle else []:
        if own.saddle and abs(value.imag) > 1e-9 * abs(value):
            exponent = complex(-abs(value.real), abs(value.imag))
            limit = swinging(pair, [exponent / share for share in shares])
        else:
            limit = falling(pair, [abs(value.real) / share for share in shares], *allowed)
        if limit is not None:
            # A reset, or an event, may see one of both rates alone; a pair winds about the equilibrium.
            fastest = abs(leading[-1].real) if eventful or value.imag else own.slowest
            return _law(own, limit, pair, own.slowest / alike / ABOUT, (1.0 + LAWFUL) * fastest)
    return None


def _coming(own: _Equilibrium, pair: Pair, eventful: bool) -> _Law | None:
    """The limit of orbits on their way to a saddle that they leave fast.

    What repels orbits with events on the way does so less than the saddle itself: the parameter falls at a
    rate that grows to the saddle's own. Without events an orbit comes back to a saddle that it leaves far
    faster: along what repels it so fast the parameter stands still, however it came. What is left of how it
    came is small, and its square may be more: the parameter falls at the rate at which it comes, or faster,
    and later at this rate.
    """
    if not own.saddle or any(value.imag for value in own.leading):
        return None
    out, into = (abs(value.real) for value in own.leading)
    if into * (1.0 if eventful else FAR_FASTER) >= out:
        return None
    allowed = (1.0 / ABOUT, 1.0 + LAWFUL) if eventful else (1.0 - LAWFUL, ABOUT)
    limit = falling(pair, [out if eventful else into], *allowed)
    return None if limit is None else _law(own, limit, pair, (1.0 - LAWFUL) * into, (1.0 + LAWFUL) * into)


def _standing(places: list[SlowPlace], pair: Pair, known: float) -> list[_Law]:
    """The limit of orbits that come to a saddle while their parameter stands still to what it is known to, as
    where something is conserved at one value of it: that value.

    They come to one where their range has a limit, and changes by no more than what they come nearer by.
    """
    if np.abs([*np.diff(pair.values), *(pair.slopes * pair.apart)]).max() > known:
        return []
    limit, fastest = Limit(0.0, known, known), 1.0 + LAWFUL
    passed = (own for own in _equilibria(places) if own.saddle and own.distance <= PASSED)
    return [
        _law(own, limit, pair, own.slowest / ABOUT, fastest * own.slowest, ABOUT * own.distance)
        for own in passed
    ]


def _law(
    own: _Equilibrium, limit: Limit, pair: Pair, slowest: float, fastest: float, grows: float = np.inf
) -> _Law:
    """The law of an equilibrium, to which orbits come at a rate between two, while their range grows by no
    more than a part of what they come nearer by.
    """

    def comes(before: list[SlowPlace]) -> bool:
        nearer = own.come_nearer(before)
        return slowest <= nearer / pair.apart <= fastest and not own.grown(before) > grows * np.expm1(nearer)

    return _Law(limit, comes, f"the equilibrium {own.place.described(own.rest)}")


def _gone(place: SlowPlace, pair: Pair, size: float) -> _Law | None:
    """A saddle-node that has gone: lambda - lambda_h and the least speed fall like 1 / (T - T_0)^2.

    Two equilibria meet at the limit, where the orbit is slow: else it was never one that has gone, and the
    parameter stands still for another reason, as along a canard.
    """
    found = inverse_square(pair)
    if found is None:
        return None
    limit, longer = found
    value = float(pair.values[1])
    there = place.meeting(value, size)
    if there is None or abs(there - value - limit.rest) > ABOUT * limit.error + LAWFUL * abs(limit.rest):
        return None

    def slower(before: list[SlowPlace]) -> bool:
        times = before[0].speed / max(place.speed, 1e-300)
        return times > 1.0 and bool(abs(np.log(times) / np.log(longer) - 2.0) <= 0.5)

    return _Law(limit, slower, "where an equilibrium has gone")
