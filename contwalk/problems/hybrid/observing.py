"""What is told of a hybrid orbit: its motion, its observables, the state that stands for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk.errors import called
from contwalk.problems.hybrid import limits
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.sampling import MOST_BISECTIONS
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit


def legs(problem: HybridOrbit, z: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Times in seconds and full states of each leg, its two ends and the extremes of its states included."""
    return [view.motion for view in problem.view(z)]


def motion(problem: HybridOrbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The closure's motion: times in seconds, (k,), and states, (k, n); both sides of each event."""
    found = legs(problem, z)
    return np.concatenate([t for t, _ in found]), np.concatenate([x for _, x in found])


def values(problem: HybridOrbit, z: np.ndarray, found: Multipliers, margins: limits.Margins) -> list[float]:
    """Values of `observable_names`."""
    p = ParameterValues(**problem.values_of(z))
    own = problem.system.observables
    t, x = motion(problem, z) if any(o.at is None for o in own) else (np.zeros(0), np.zeros((0, 0)))
    result = []
    for o in own:
        if o.at is None:
            given: tuple = (t, x)
        else:
            place = at_event(problem, z, o.at, o.side)
            if place is None:
                result.append(float("nan"))
                continue
            given = place
        result.append(called(f"observable '{o.name}'", lambda f, g: float(f(*g, p)), o.function, given))
    named = [name for name in problem.system.margins if name not in [o.name for o in own]]
    result += [margins.least(name) for name in named]
    largest = float(np.abs(found.values[0])) if len(found.values) else float("nan")
    return [*result, split(found.values), largest]


def split(multipliers: np.ndarray) -> float:
    """Signed square of the smallest difference of two multipliers: negative of a complex pair.

    It is smooth where two real multipliers meet and become a pair, and passes zero there.
    """
    best, finite = np.nan, multipliers[np.isfinite(multipliers)]
    for k, a in enumerate(finite):
        for b in finite[k + 1 :]:
            square = (a - b) ** 2
            if (a.imag == 0.0) != (b.imag == 0.0) or (a.imag != 0.0 and b != np.conj(a)):
                continue
            if not abs(square.real) >= abs(best):
                best = float(square.real)
    return best


def at_event(problem: HybridOrbit, z: np.ndarray, name: str, side: str) -> tuple[float, np.ndarray] | None:
    """Time and full state before or after the first event of a name; None if the orbit has none."""
    times, m = problem.starting_times(z), problem.layout.legs
    for k in range(-1, m - 1):
        i = k % m  # the leg that the signature's next event ends
        if problem.word.legs[i].name != name:
            continue
        time = float(times[i + 1])
        if side == "after":
            x, _ = problem.layout.inputs((i + 1) % m, z)
            return time, problem.passages[(i + 1) % m].full(x)
        return time, before_event(problem, z, i)
    return None


def before_event(problem: HybridOrbit, z: np.ndarray, i: int) -> np.ndarray:
    """Full state at the end of leg i, before its transition."""
    view = problem.view(z)[i]
    return view.full(view.end)


def reported(problem: HybridOrbit, z: np.ndarray) -> np.ndarray:
    """The state before the first event of the signature, or where the run asks for it, shape (n,)."""
    place, event = problem.discretization.report_at, problem.discretization.report_event
    if event is not None:
        found = at_event(problem, z, *event)
        return np.full(problem.states, np.nan) if found is None else found[1]
    if place is not None:
        return _passing(problem, z, *place)
    if not problem.word.eventful:
        return problem.passages[0].full(problem.layout.inputs(0, z)[0])
    return before_event(problem, z, problem.layout.legs - 1)


def _passing(problem: HybridOrbit, z: np.ndarray, index: int, value: float, direction: float) -> np.ndarray:
    """The state at which state number `index` first passes a value inside a leg; NaN if it never does."""
    for i, (t, x) in enumerate(legs(problem, z)):
        side = (x[:, index] - value) * direction
        passes = np.flatnonzero((side[:-1] < 0.0) & (side[1:] >= 0.0))
        if not len(passes):
            continue
        view, k = problem.view(z)[i], int(passes[0])
        low, high = ((t[j] - view.start) / view.duration for j in (k, k + 1))
        there = x[k]
        for _ in range(MOST_BISECTIONS):
            middle = 0.5 * (low + high)
            there = view.full(view.at(np.array([middle]))[0])
            low, high = (middle, high) if (there[index] - value) * direction < 0.0 else (low, middle)
            if high - low < 1e-15:
                break
        return there
    return np.full(problem.states, np.nan)
