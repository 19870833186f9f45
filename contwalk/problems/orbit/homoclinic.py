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

All of it follows from two neighbouring orbits, so that a walk that is taken up again sees the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.orbit.protocol import Orbit
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.orbit.solving import error_holding
from contwalk.problems.problem import Sample

# An orbit that is this slow somewhere, against its fastest, passes an equilibrium, or where one has been.
CREEPING = 1e-2
# An equilibrium this near to the orbit, in units of its range, is passed by it; so near that it is hidden.
PASSED, AT_REST = 2e-2, 1e-3
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


# Whether the orbit before, by its slowest place, obeys the law by which a limit was found.
Obeyed = Callable[[SlowPlace], bool]


def homoclinic(problem: Orbit, a: Sample, b: Sample) -> Outcome | None:
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
    after = problem.slow_place(b.z)
    if after.slowness > CREEPING:
        return None
    limit, obeyed = _limit(after, (a, b), slopes, problem.eventful)
    if limit is None or limit.swing > wanted or not obeyed(problem.slow_place(a.z)):
        return None
    error = limit.error + error_holding(problem, b.z, b.weights, problem.duration_gradient(b.z))
    return Outcome(
        "stopped",
        "homoclinic",
        f"The period runs off ({problem.system.lasting(b.period, '.4g')} here) while the orbit creeps past "
        f"an equilibrium: {_of_what(problem.eventful)} at "
        f"{problem.free} = {value + limit.rest:.12g} +- {error:.1e}, by "
        f"extrapolation from {value:.12g}.{_doubt(b)} Nothing to do; a finer accuracy follows it further.",
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


def _limit(
    after: SlowPlace, samples: tuple[Sample, Sample], slopes: np.ndarray, eventful: bool
) -> tuple[Limit | None, Obeyed]:
    """The limit by the law of the equilibrium that is passed, None where it is not obeyed; what else has
    to be true of the orbit before, at which nobody needs to look until then.
    """
    rest = after.equilibrium()
    if rest is None or after.distance(rest) > PASSED:
        return _gone(after, samples, slopes)
    distance = after.distance(rest)

    def nearer(before: SlowPlace) -> bool:
        old = before.equilibrium()
        return old is not None and distance < before.distance(old)

    return _passing(after.jacobian(rest), distance, samples, slopes, eventful), nearer


def _passing(
    jacobian: np.ndarray,
    distance: float,
    samples: tuple[Sample, Sample],
    slopes: np.ndarray,
    eventful: bool = False,
) -> Limit | None:
    """The limit of orbits that pass an equilibrium, by its leading eigenvalue.

    A reset may put the state beside the equilibrium, or an event take it away from there, and forget how it
    came: then either of the leading ones may tell, and there may be one only.
    """
    values = np.linalg.eigvals(jacobian)
    growing, falling = values[values.real > 0.0], values[values.real < 0.0]
    leading = [growing[np.argmin(growing.real)]] if len(growing) else []
    leading += [falling[np.argmax(falling.real)]] if len(falling) else []
    leading.sort(key=lambda v: abs(v.real))
    if not eventful:
        leading = leading[:1] if len(leading) == 2 else []
    for value in leading:
        if abs(value.imag) > 1e-9 * abs(value):
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

    def slower(before: SlowPlace) -> bool:
        times = before.speed / max(after.speed, 1e-300)
        return times > 1.0 and bool(abs(np.log(times) / np.log(longer) - 2.0) <= 0.5)

    rest = 0.5 * float(slopes[1]) * since
    return (None if since > 2.0 * b else Limit(rest, 0.5 * abs(rest), abs(rest))), slower
