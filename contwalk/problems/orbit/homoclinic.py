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

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.orbit.solving import error_holding, newton_on
from contwalk.problems.problem import Sample

# An orbit that is this slow somewhere, against its fastest, passes an equilibrium, or where one has been.
CREEPING = 1e-2
# An equilibrium this near to the orbit, in units of its range, is passed by it; so near that it is hidden.
PASSED, AT_REST = 2e-2, 1e-3
# One this near, in the same units, may be what the orbit is on its way to.
NEARING = 0.2
# A parameter this near to its limit, relative to itself, is at it.
LEAST_REST = 1e-10
# A parameter below this part of its magnitude tends to zero.
NEAR_ZERO = 1e-3
# The extrapolated limit is better than the last value by more than this.
REST = 10.0
# Rates times periods are not larger: the rest is not asked for before the slope can be small enough.
MOST_TURNS = 300.0
# How far from the law of its equilibrium the parameter may be, and from it where nothing else is seen.
LAWFUL, ABOUT = 0.25, 4.0


@dataclass(frozen=True)
class Limit:
    """What is left to the limit of the parameter, its error, and how far the parameter may still swing."""

    rest: float
    error: float
    swing: float


# Whether the orbit before, by its slow places, obeys the law by which a limit was found.
Obeyed = Callable[[list[SlowPlace]], bool]


@dataclass(frozen=True)
class _Law:
    """A limit by a law, what else is true of the orbit before if the law holds, and what is passed there."""

    limit: Limit
    obeyed: Obeyed
    where: str


def homoclinic(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end at a homoclinic or heteroclinic orbit, where two neighbouring orbits show that it is near."""
    if problem.forced or not b.period > a.period:
        return None
    rises = [float(problem.duration_gradient(s.z) @ s.tangent) for s in (a, b)]
    if 0.0 in rises:
        return None
    slopes = np.array([float(s.tangent[-1]) / rise for s, rise in zip((a, b), rises, strict=True)])
    value = float(b.z[-1])
    # A limit at zero is known to a part of what the parameter is elsewhere.
    size = max(abs(value), NEAR_ZERO * float(b.weights[-1]))
    wanted = max(REST * problem.discretization.accuracy, LEAST_REST) * size
    if not np.all(np.isfinite(slopes)) or abs(slopes[1]) * b.period > MOST_TURNS * wanted:
        return None
    places = [place for place in problem.slow_places(b.z) if place.slowness <= CREEPING]
    laws = _laws(places, (a, b), slopes, problem.eventful)
    law = _obeyed(problem, laws, a, wanted)
    if law is None and _lies_within_noise(places, abs(slopes[1]), REST * wanted):
        law = _obeyed(problem, _laws_on_finest_steps(problem, places, (a, b)), a, wanted)
    if law is None:
        return None
    held, known = _held(problem, b)
    error = law.limit.error + known
    return Outcome(
        "stopped",
        "homoclinic",
        f"The period runs off ({problem.system.lasting(b.period, '.4g')} here) while the orbit creeps past "
        f"{law.where}: {_of_what(problem.eventful)} at "
        f"{problem.free} = {held + law.limit.rest:.12g} +- {error:.1e}, by "
        f"extrapolation from {value:.12g}.{_doubt(b)} Nothing to do; a finer accuracy follows it further.",
    )


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
    found, passes = [], False
    for place in places:
        rest = place.equilibrium()
        if rest is None:
            continue
        passes |= place.distance(rest) <= PASSED
        found += _laws_of(place, rest, samples, slopes, eventful)
    if places and not passes:
        limit, obeyed = _gone(places[0], samples, slopes)
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
    place: SlowPlace, rest: np.ndarray, samples: tuple[Sample, Sample], slopes: np.ndarray, eventful: bool
) -> list[_Law]:
    """The law of one equilibrium, if the parameter obeys it."""
    distance, jacobian = place.distance(rest), place.jacobian(rest)
    lasting = samples[1].period - samples[0].period

    def distances(before: list[SlowPlace]) -> list[float]:
        known = (p for p in before if p.names == place.names)
        found = ((p, p.equilibrium(rest)) for p in known)
        return [p.distance(old) for p, old in found if old is not None]

    where = ", ".join(f"{name} = {x:.5g}" for name, x in zip(place.names, rest, strict=True))
    where = f"the equilibrium {where}"
    limit = _passing(jacobian, distance, samples, slopes, eventful) if distance <= PASSED else None
    if limit is not None:
        return [_Law(limit, lambda before: min(distances(before), default=0.0) > distance, where)]
    # Without events a homoclinic orbit comes back to the saddle, which tells by the slower of both rates.
    coming = _coming(jacobian, samples, slopes) if eventful and distance <= NEARING else None
    if coming is None:
        return []
    limit, rate = coming

    def comes(before: list[SlowPlace]) -> bool:
        nearest = min(distances(before), default=distance)
        return abs(float(np.log(nearest / distance)) / (rate * lasting) - 1.0) < LAWFUL

    return [_Law(limit, comes, where)]


def _coming(
    jacobian: np.ndarray, samples: tuple[Sample, Sample], slopes: np.ndarray
) -> tuple[Limit, float] | None:
    """The limit of orbits on their way to a saddle that they leave fast, and the rate at which they come.

    What repels them on the way does so less than the saddle itself: the parameter falls at a rate that grows
    to the saddle's own.
    """
    values = np.linalg.eigvals(jacobian)
    growing, falling = values[values.real > 0.0], values[values.real < 0.0]
    if not len(growing) or not len(falling) or slopes[0] * slopes[1] <= 0.0:
        return None
    out, into = growing[np.argmin(growing.real)], falling[np.argmax(falling.real)]
    if out.imag or into.imag or -into.real >= out.real:
        return None
    measured = float(np.log(slopes[0] / slopes[1])) / (samples[1].period - samples[0].period)
    if not 1.0 / ABOUT < measured / float(out.real) < 1.0 + LAWFUL:
        return None
    rest = float(slopes[1]) / measured
    off = abs(measured / float(out.real) - 1.0)
    return Limit(rest, (off + LAWFUL) * abs(rest), abs(rest)), -float(into.real)


def _passing(
    jacobian: np.ndarray,
    distance: float,
    samples: tuple[Sample, Sample],
    slopes: np.ndarray,
    eventful: bool = False,
) -> Limit | None:
    """The limit of orbits that pass an equilibrium, by its leading eigenvalue.

    A reset may put the state beside the equilibrium, or an event take it away from there, and forget how it
    came: then either of the leading ones may tell, and there may be one only. A pair swings about a
    saddle-focus only: what is drawn in by a focus on all sides does not leave it, and what a reset puts
    beside one that repels all leaves it the faster, the further away it begins.
    """
    values = np.linalg.eigvals(jacobian)
    growing, falling = values[values.real > 0.0], values[values.real < 0.0]
    leading = [growing[np.argmin(growing.real)]] if len(growing) else []
    leading += [falling[np.argmax(falling.real)]] if len(falling) else []
    leading.sort(key=lambda v: abs(v.real))
    saddle = len(leading) == 2
    if not eventful:
        leading = leading[:1] if saddle else []
    for value in leading:
        if saddle and abs(value.imag) > 1e-9 * abs(value):
            found = _swinging(complex(-abs(value.real), abs(value.imag)), samples, slopes)
        else:
            found = _falling(float(abs(value.real)), samples, slopes, distance < AT_REST)
        if found is not None:
            return found
    return None


def _falling(rate: float, samples: tuple[Sample, Sample], slopes: np.ndarray, at_rest: bool) -> Limit | None:
    """lambda - lambda_h falls like exp(-rate T); of a cycle past several equilibria, with another rate."""
    if slopes[0] * slopes[1] <= 0.0:
        return None
    measured = float(np.log(slopes[0] / slopes[1])) / (samples[1].period - samples[0].period)
    if measured <= 0.0:
        return None
    off = abs(measured / rate - 1.0)
    lawful = off < LAWFUL
    if not lawful and not (at_rest and 1.0 / ABOUT < measured / rate < ABOUT):
        return None
    rest = float(slopes[1]) / measured
    return Limit(rest, abs(rest - float(slopes[1]) / rate) + (off + LAWFUL) * abs(rest), abs(rest))


def _swinging(exponent: complex, samples: tuple[Sample, Sample], slopes: np.ndarray) -> Limit | None:
    """lambda - lambda_h = Re(c exp(exponent T)): c from the slopes at two periods."""
    a, b = samples
    back = np.exp(-exponent * (b.period - a.period))
    if abs(back.imag) < 0.05 * abs(back):  # half a turn apart, or hardly apart: the phase is not told
        return None
    slope = complex(slopes[1], (slopes[1] * back.real - slopes[0]) / back.imag)
    amplitude = slope / exponent
    predicted = amplitude.real - (amplitude * back).real
    off = abs(predicted - float(b.z[-1] - a.z[-1])) / max(abs(amplitude), abs(amplitude * back))
    if off > LAWFUL:
        return None
    return Limit(-amplitude.real, abs(amplitude), abs(amplitude))


def _gone(
    after: SlowPlace, samples: tuple[Sample, Sample], slopes: np.ndarray
) -> tuple[Limit | None, Obeyed]:
    """A saddle-node that has gone: lambda - lambda_h and the least speed fall like 1 / (T - T_0)^2."""
    ratio = float(slopes[0] / slopes[1]) if slopes[1] else 0.0
    if not ratio > 1.0:
        return None, lambda _: False
    a, b = (s.period for s in samples)
    longer = ratio ** (1.0 / 3.0)  # (b - T_0) / (a - T_0)
    since = (b - a) * longer / (longer - 1.0)  # b - T_0

    def slower(before: list[SlowPlace]) -> bool:
        times = before[0].speed / max(after.speed, 1e-300)
        return times > 1.0 and bool(abs(np.log(times) / np.log(longer) - 2.0) <= 0.5)

    rest = 0.5 * float(slopes[1]) * since
    # From the slopes at both ends the law predicts the way in between. What it misses of that, as a part of
    # it, is as the square of how much longer one lasts against what is missed of the rest.
    way = 0.5 * float(slopes[0]) * since / longer - rest
    missed = abs(float(samples[1].z[-1] - samples[0].z[-1]) / way - 1.0)
    part = min(REST * missed / (longer - 1.0) ** 2, 0.5)
    return (None if since > 2.0 * b else Limit(rest, part * abs(rest), abs(rest))), slower
