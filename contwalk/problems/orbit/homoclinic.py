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

Far from its limit an orbit that comes to a saddle slowly and leaves it fast is still on its way: it follows
the saddle's stable manifold along what repels it, as a canard, and its rate is not yet the saddle's own. Then
how its least distance falls tells that it comes, and the rate that is seen is the later one but for a factor.

All of it follows from two neighbouring orbits, so that a walk that is taken up again sees the same. The last
of them is solved once more on the finest steps, its period held: what the walk's own steps do to the
parameter is mostly more than what is left of its way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.marching import PERIOD, march
from contwalk.problems.orbit.homoclinic_laws import (
    ABOUT,
    AT_REST,
    LAWFUL,
    Limit,
    Obeyed,
    coming,
    drawn,
    gone,
    passing,
)
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.problem import Sample
from contwalk.problems.solving import error_holding, newton_on

# An orbit that is this slow somewhere, against its fastest, passes an equilibrium, or where one has been.
CREEPING = 1e-2
# An equilibrium this near to the orbit, in units of its range, is passed by it.
PASSED = 2e-2
# One this near, in the same units, may be what the orbit is on its way to.
NEARING = 0.3
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
    obeyed: Obeyed
    where: str


class _Equilibrium:
    """An equilibrium beside a slow place, shape (n,), and its eigenvalues."""

    def __init__(self, place: SlowPlace, rest: np.ndarray) -> None:
        self.place, self.rest = place, rest
        self.values = np.sort_complex(np.linalg.eigvals(place.jacobian(rest)))

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


@dataclass(frozen=True)
class _Approached:
    """A limit of the parameter, its error, and from which parameter and period it is extrapolated."""

    value: float
    error: float
    last: float
    period: float


def homoclinic(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end at a homoclinic or heteroclinic orbit, where two neighbouring orbits show that it is near."""
    if problem.forced or not b.period > a.period:
        return None
    rises = [float(problem.duration_gradient(s.z) @ s.tangent) for s in (a, b)]
    if 0.0 in rises:
        return None
    slopes = np.array([float(s.tangent[-1]) / rise for s, rise in zip((a, b), rises, strict=True)])
    # A limit at zero is known to a part of what the parameter is elsewhere.
    size = max(abs(float(b.z[-1])), NEAR_ZERO * float(b.weights[-1]))
    wanted = max(REST * problem.discretization.accuracy, LEAST_REST) * size
    if not np.all(np.isfinite(slopes)) or abs(slopes[1]) * b.period > MOST_TURNS * wanted:
        return None
    places = _creeping(problem, b.z)
    laws = _laws(places, (a, b), slopes, problem.eventful)
    law = _obeyed(problem, laws, a, wanted)
    if law is None and _lies_within_noise(places, abs(slopes[1]), REST * wanted):
        law = _obeyed(problem, _laws_on_finest_steps(problem, places, (a, b)), a, wanted)
    if law is None:
        return None
    near = _approached(problem, law.limit, (a, b), wanted) or _extrapolated(problem, law.limit, b)
    line, digits = problem.line, _digits(near)
    last = line.described(near.last, None, digits).removeprefix(f"{line.free} = ")
    return Outcome(
        "stopped",
        "homoclinic",
        f"The period runs off ({problem.system.lasting(b.period, '.4g')} here) while the orbit creeps past "
        f"{law.where}: {_of_what(problem.eventful)} at {line.described(near.value, near.error, digits)}, "
        f"by extrapolation from {last}, where the period is "
        f"{problem.system.lasting(near.period, '.4g')}.{_doubt(b)} Nothing to do.",
    )


def saddle_ahead(problem: OrbitData, z: np.ndarray) -> str | None:
    """The saddle that an orbit creeps past, or is on its way to, as `x = 1, y = 2`; None where there is none.

    z has the shape (N + 1,).
    """
    for place in [] if problem.forced else _creeping(problem, z):
        rest = place.equilibrium()
        if rest is not None and place.distance(rest) <= NEARING:
            rates = np.linalg.eigvals(place.jacobian(rest)).real
            if rates.min() < 0.0 < rates.max():
                return place.described(rest)
    return None


def _digits(near: _Approached) -> int:
    """Two digits more than an error leaves, and twelve at least."""
    return 12 if near.error >= 1e-10 * abs(near.value) else 16


def _approached(
    problem: OrbitData, limit: Limit, samples: tuple[Sample, Sample], wanted: float
) -> _Approached | None:
    """The limit as orbits of longer periods tell it, until rounding is all that is left of the way to it.

    None where there are none. Each must tell the limit within the error that the one before claims: where
    it does not, its parameter is rounding.
    """
    a, b = samples
    found: _Approached | None = None
    before: tuple[Sample, float] | None = None
    told, allowed = float(b.z[-1]) + limit.rest, limit.error + wanted
    for place in march(problem, PERIOD, b, b.period - a.period, limit.swing):
        here, last = (replace(b, z=place.z, period=place.at), float(place.rates[-1])), before
        before = here
        laws = [] if last is None else _laws_beside(problem, last, here)
        if not laws:  # as where the slope of one that swings is zero
            continue
        value = float(place.z[-1])
        agree = [law.limit for law in laws if abs(value + law.limit.rest - told) <= allowed]
        if not agree:
            break
        nearest = min(agree, key=lambda x: x.error)
        error = nearest.error + place.error
        if found is not None and error >= found.error:
            break
        found = _Approached(value + nearest.rest, error, value, place.at)
        told, allowed = found.value, error
        if nearest.swing <= max(ROUNDING * abs(value), place.error):
            break
    return found


def _laws_beside(problem: OrbitData, a: tuple[Sample, float], b: tuple[Sample, float]) -> list[_Law]:
    """The laws that two orbits obey, each with its d lambda / dT."""
    slopes = np.array([a[1], b[1]])
    if not np.all(slopes):
        return []
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows obeys none
        return _laws(_creeping(problem, b[0].z), (a[0], b[0]), slopes, problem.eventful)


def _extrapolated(problem: OrbitData, limit: Limit, b: Sample) -> _Approached:
    """The limit as the law tells it from the last orbit of the walk."""
    held, known = _held(problem, b)
    return _Approached(held + limit.rest, limit.error + known, float(b.z[-1]), b.period)


def _creeping(problem: OrbitData, z: np.ndarray) -> list[SlowPlace]:
    """The slow places that may be beside an equilibrium; z has the shape (N + 1,)."""
    return [place for place in problem.slow_places(z) if place.slowness <= CREEPING]


def _obeyed(problem: OrbitData, laws: list[_Law], a: Sample, wanted: float) -> _Law | None:
    """The law that tells the limit as near as it is wanted, and that the orbit before obeys too."""
    near = [law for law in laws if law.limit.swing <= wanted]
    before = problem.slow_places(a.z) if near else []
    return next((law for law in near if law.obeyed(before)), None)


def _lies_within_noise(places: list[SlowPlace], slope: float, most: float) -> bool:
    """Whether a saddle is passed so closely, and the limit by its slowest rate within `most`, that the walk's
    own steps may hide the law.
    """
    for place in places:
        rest = place.equilibrium()
        if rest is not None and place.distance(rest) <= AT_REST:
            rates = np.linalg.eigvals(place.jacobian(rest)).real
            if rates.min() < 0.0 < rates.max() and slope <= most * np.abs(rates).min():
                return True
    return False


def _laws_on_finest_steps(
    problem: OrbitData, places: list[SlowPlace], samples: tuple[Sample, Sample]
) -> list[_Law]:
    """The laws as both orbits tell them on the finest steps, their periods held.

    What is left of the way of the parameter may be less than what the walk's own steps do to it: then its
    slope there is noise, and a walk would go on in that for ever.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is no orbit
            told = [_followed(problem, sample) for sample in samples]
    except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
        return []
    a, b = (replace(sample, z=z) for sample, (z, _) in zip(samples, told, strict=True))
    slopes = np.array([slope for _, slope in told])
    if not np.all(np.isfinite(slopes)) or 0.0 in slopes:
        return []
    return _laws(places, (a, b), slopes, problem.eventful)


def _followed(problem: OrbitData, sample: Sample) -> tuple[np.ndarray, float]:
    """The orbit of the same period on the finest steps, shape (N + 1,), and d lambda / dT there."""
    fine = problem.finest(sample.z, sample.weights)
    held = fine.duration_gradient(sample.z)
    z = newton_on(fine, sample.z, sample.weights, held)
    return z, float(fine.linearize(z).tangent(held, sample.weights)[-1])


def _held(problem: OrbitData, b: Sample) -> tuple[float, float]:
    """The parameter of the orbit of this period on the finest steps, and its error; that of the walk's own
    steps where it is not found there.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is no orbit
            fine = problem.finest(b.z, b.weights)
            held = fine.duration_gradient(b.z)
            z = newton_on(fine, b.z, b.weights, held)
            known = error_holding(fine, z, b.weights, held)
        if np.isfinite(known):
            return float(z[-1]), known
    except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
        pass
    return float(b.z[-1]), error_holding(problem, b.z, b.weights, problem.duration_gradient(b.z))


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


def _laws(
    places: list[SlowPlace], samples: tuple[Sample, Sample], slopes: np.ndarray, eventful: bool
) -> list[_Law]:
    """The laws that the parameter obeys: of the equilibria that are passed, or of one that has gone."""
    found, passed = list[_Law](), list[_Equilibrium]()
    near = [_Equilibrium(place, rest) for place in places if (rest := place.equilibrium()) is not None]
    for own in near:
        if own.place.distance(own.rest) <= PASSED and not any(own.is_(other) for other in passed):
            passed.append(own)
    for own in near:
        alike = sum(other.like(own) for other in passed)
        found += _laws_of(own.place, own.rest, samples, slopes, eventful, max(alike, 1))
    if places and not passed:
        limit, obeyed = gone(places[0], samples, slopes)
        if limit is not None and _meet(places[0], samples[1], limit):
            found.append(_Law(limit, obeyed, "where an equilibrium has gone"))
    return found


def _meet(place: SlowPlace, sample: Sample, limit: Limit) -> bool:
    """Whether two equilibria meet at the limit, where the orbit is slow: else it was never one that has gone,
    and the parameter stands still for another reason, as along a canard.
    """
    value = float(sample.z[-1])
    there = place.meeting(value, float(sample.weights[-1]))
    allowed = ABOUT * limit.error + LAWFUL * abs(limit.rest)
    return there is not None and abs(there - value - limit.rest) <= allowed


def _laws_of(
    place: SlowPlace,
    rest: np.ndarray,
    samples: tuple[Sample, Sample],
    slopes: np.ndarray,
    eventful: bool,
    alike: int,
) -> list[_Law]:
    """The law of one equilibrium, one of so many alike that are passed, if the parameter obeys it."""
    distance, jacobian = place.distance(rest), place.jacobian(rest)
    lasting = samples[1].period - samples[0].period

    def distances(before: list[SlowPlace]) -> list[float]:
        known = (p for p in before if p.names == place.names)
        found = ((p, p.equilibrium(rest)) for p in known)
        return [p.distance(old) for p, old in found if old is not None]

    where = f"the equilibrium {place.described(rest)}"
    near = distance <= PASSED
    limit = passing(jacobian, distance, samples, slopes, eventful, alike) if near else None
    if limit is not None:
        return [_Law(limit, lambda before: min(distances(before), default=0.0) > distance, where)]
    # Without events a homoclinic orbit comes back to the saddle, which tells by the slower of both rates.
    law = coming if eventful else drawn
    on_its_way = law(jacobian, samples, slopes) if distance <= NEARING else None
    if on_its_way is None:
        return []
    limit, rate = on_its_way

    def comes(before: list[SlowPlace]) -> bool:
        nearest = min(distances(before), default=distance)
        return abs(float(np.log(nearest / distance)) / (rate * lasting) - 1.0) < LAWFUL

    return [_Law(limit, comes, where)]
