"""What is true of any branch of hybrid orbits, checked by integrations that are not the engine's.

Everything is taken from the plugin's own functions: scipy integrates, and derivatives of fields, guards and
resets are differences of fourth order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from special_point_invariants import check_special_points

from contwalk.branch import Branch
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import System, Transition

# What may become, at the end of a leg, of local errors that a run asks for; and what scipy misses by itself.
GLOBAL, INDEPENDENT = 100.0, 1e-11
# scipy's DOP853 takes no less; of variational equations the differences are known to 1e-13 only.
RELATIVE, VARIED = 3e-14, 1e-12
# Of what an orbit may miss, so much is asked of the integrations: a hundredth at the most is their own then.
ASKED = 1e-4
# Differences of fourth order with this part of a state's size: truncation 1e-13, rounding 1e-13.
STEP = 1e-3
# A margin nearer to zero than this part of the guard's largest value has no certain sign.
CERTAIN = 1e-6
SAMPLES = 200


@dataclass(frozen=True)
class Leg:
    """A leg of a stored orbit, integrated anew.

    `factor` is the derivative of what follows its event by its start, saltation included: the flow's own
    direction at its start becomes that of the next leg.
    """

    mode: str
    transition: Transition | None
    start: float
    duration: float
    x: np.ndarray
    end: np.ndarray
    after: np.ndarray
    factor: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]


def differentiated(
    function: Callable[[np.ndarray], np.ndarray], x: np.ndarray, size: np.ndarray
) -> np.ndarray:
    """Derivative by central differences of fourth order, shape (m, n)."""
    columns = []
    for j in range(len(x)):
        h = np.zeros(len(x))
        h[j] = STEP * size[j]
        values = [np.atleast_1d(function(x + k * h)) for k in (-2.0, -1.0, 1.0, 2.0)]
        columns.append((8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * h[j]))
    return np.column_stack(columns)


def written(function: Callable[..., None], t: float, x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
    """What a function writes into its last argument; zero where it writes nothing."""
    out = np.zeros(len(x))
    function(t, x, p, out)
    return out


def after(system: System, transition: Transition, t: float, x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
    """State after a transition: reset, then relabelled; states that do not exist there are zero."""
    found = x.copy() if transition.reset is None else written(transition.reset, t, x, p)
    if transition.relabel is not None:
        names = next(s for s in system.symmetries if s.name == transition.relabel)
        found = written(names.map, t, found, p)
    kept = np.zeros(len(x))
    place = list(system.states_of(transition.target))
    kept[place] = found[place]
    return kept


def parameters_at(branch: Branch, system: System, row: np.void) -> SimpleNamespace:
    """All parameters at a row."""
    value = float(row["free"][0])
    path = branch.info.settings.get("path")
    if path is None:
        return SimpleNamespace(**{**branch.info.parameters, branch.info.free[0]: value})
    begin, end = path
    return SimpleNamespace(**{n: begin[n] + value * (end[n] - begin[n]) for n in system.parameter_names})


def legs_of(branch: Branch, system: System, row: np.void, relative: float = RELATIVE) -> list[Leg]:
    """The legs of a stored orbit, each integrated from its stored start for its stored duration.

    `relative` is the local error that scipy is asked for.
    """
    p, word = parameters_at(branch, system, row), branch.info.settings["legs"]
    z = row["unknowns"]
    by_name = {t.name: t for t in system.transitions}
    places = [list(system.states_of(mode)) for mode, _, _ in word]
    ends = np.cumsum([0, *(len(place) for place in places)])
    durations = z[ends[-1] : ends[-1] + len(word)]
    time = float(z[ends[-1] + len(word)]) if system.period is not None else 0.0
    starts = []
    for k, place in enumerate(places):
        x = np.zeros(len(system.states))
        x[place] = z[ends[k] : ends[k + 1]]
        starts.append(x)
    begins = time + np.concatenate([[0.0], np.cumsum(durations)])
    motions = [
        _motion(system, p, word[k][0], starts[k], float(begins[k]), float(durations[k]), relative)
        for k in range(len(word))
    ]
    size = _sizes(motions)
    return [
        _leg(system, p, mode, by_name.get(name), size, motion, max(relative, VARIED))
        for (mode, name, _), motion in zip(word, motions, strict=True)
    ]


@dataclass(frozen=True)
class Motion:
    """A motion in one mode: from where, from when and for how long; `at` takes shares of its duration."""

    x: np.ndarray
    start: float
    duration: float
    end: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]


def _full(system: System, place: list[int], y: np.ndarray) -> np.ndarray:
    result = np.zeros(len(system.states))
    result[place] = y
    return result


def _motion(
    system: System,
    p: SimpleNamespace,
    mode: str,
    x: np.ndarray,
    start: float,
    duration: float,
    relative: float,
) -> Motion:
    place, field = list(system.states_of(mode)), system.mode(mode).field

    def right(tau: float, y: np.ndarray) -> np.ndarray:
        return duration * written(field, start + tau * duration, _full(system, place, y), p)[place]

    solved = solve_ivp(
        right, (0.0, 1.0), x[place], "DOP853", rtol=relative, atol=1e-15, dense_output=True, max_step=0.05
    )
    assert solved.success, solved.message

    def at(times: np.ndarray) -> np.ndarray:
        return np.array([_full(system, place, y) for y in solved.sol(times).T])

    return Motion(x, start, duration, _full(system, place, solved.y[:, -1]), at)


def _sizes(motions: list[Motion]) -> np.ndarray:
    """Half the range of each state over the orbit, not less than a thousandth of its size."""
    states = np.concatenate([motion.at(np.linspace(0.0, 1.0, 40)) for motion in motions])
    half, largest = 0.5 * np.ptp(states, axis=0), np.abs(states).max(axis=0)
    return np.maximum(np.maximum(half, 1e-3 * largest), 1e-12)


def _leg(
    system: System,
    p: SimpleNamespace,
    mode: str,
    transition: Transition | None,
    sizes: np.ndarray,
    motion: Motion,
    relative: float,
) -> Leg:
    """A leg with the variational equations, in units of the states' sizes."""
    own, field, start, duration = (
        list(system.states_of(mode)),
        system.mode(mode).field,
        motion.start,
        motion.duration,
    )
    n, size = len(own), sizes[own]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return written(field, t, _full(system, own, y), p)[own]

    def right(tau: float, y: np.ndarray) -> np.ndarray:
        t, x = start + tau * duration, size * y[:n]
        slopes = differentiated(lambda u: rate(t, u), x, size) / size[:, None] * size
        return duration * np.concatenate([rate(t, x) / size, (slopes @ y[n:].reshape(n, n)).ravel()])

    first = np.concatenate([motion.x[own] / size, np.eye(n).ravel()])
    solved = solve_ivp(right, (0.0, 1.0), first, "DOP853", rtol=relative, atol=0.1 * relative)
    assert solved.success, solved.message
    moved = solved.y[n:, -1].reshape(n, n) * size[:, None] / size
    end, t = motion.end[own], start + duration
    if transition is None:
        return Leg(mode, None, start, duration, motion.x, motion.end, motion.end, moved, motion.at)
    target = list(system.states_of(transition.target))
    later = after(system, transition, t, motion.end, p)

    def mapped(time: float, y: np.ndarray) -> np.ndarray:
        return after(system, transition, time, _full(system, own, y), p)[target]

    def guard(time: float, y: np.ndarray) -> float:
        return float(transition.guard(time, _full(system, own, y), p))

    seconds = np.array([max(abs(duration), 1e-3)])
    g_x = differentiated(lambda y: mapped(t, y), end, size)
    g_t = differentiated(lambda s: mapped(float(s[0]), end), np.array([t]), seconds)[:, 0]
    h_x = differentiated(lambda y: guard(t, y), end, size)[0]
    h_t = differentiated(lambda s: guard(float(s[0]), end), np.array([t]), seconds)[0, 0]
    before = rate(t, end)
    following = written(system.mode(transition.target).field, t, later, p)[target]
    # A later arrival: what the guard is off by is made up for by a longer leg and a shorter next one.
    jump = g_x + np.outer(following - g_x @ before - g_t, h_x) / (h_x @ before + h_t)
    return Leg(mode, transition, start, duration, motion.x, motion.end, later, jump @ moved, motion.at)


def check_hybrid_branch(
    branch: Branch,
    system: System,
    every: int = 8,
    discretization: Discretization | None = None,
    chosen: np.ndarray | None = None,
) -> None:
    """Assert the invariants of a branch of hybrid orbits.

    Each `every`-th row and the special ones are integrated; of `chosen` rows only, where given.
    """
    assert branch.complete
    assert branch.info.problem == "hybrid_orbit"
    assert branch.info.states == system.state_names
    assert branch.outcome.status in ("complete", "stopped", "failed")
    assert branch.outcome.message.endswith((".", ".)"))
    _check_order(branch)
    check_special_points(branch)
    walking = (discretization or Discretization(accuracy=1e-9)).walking
    for i, row in enumerate(branch.points):
        _check_counts(branch, row)
        wanted = chosen is None or chosen[i]
        if wanted and (i % every == 0 or row["special"]):
            _check_row(branch, system, row, walking)


def _check_order(branch: Branch) -> None:
    s = branch["s"]
    assert np.all(np.isfinite(s))
    assert np.all(np.diff(s) >= 0.0), "points are not ordered by arclength"
    assert np.any(s == 0.0), "the start is missing"
    assert np.all(np.diff(s[~branch["special"]]) > 0.0), "two regular points at the same place"
    for a, b in pairwise(branch.points):
        birth = branch.info.parent is not None and 0.0 in (a["s"], b["s"])
        if not birth and not a["special"] and not b["special"]:
            assert a["unstable"] == b["unstable"], f"a crossing was missed between s = {a['s']} and {b['s']}"


def _check_counts(branch: Branch, row: np.void) -> None:
    values = row["spectrum"][np.isfinite(row["spectrum"])]
    moduli = np.abs(values)
    assert np.all(np.diff(moduli) <= 1e-12 * moduli[:-1]), "multipliers are not in descending order"
    doubt = float(row["spectrum_error"]) + 1e-12
    # Where an event arrives without rate, a multiplier is infinite.
    endless = int(np.isinf(np.abs(row["spectrum"])).sum())
    unstable = row["unstable"] - endless
    assert np.sum(moduli > 1.0 + doubt) <= unstable <= np.sum(moduli >= 1.0 - doubt)
    assert bool(row["stable"]) == (row["unstable"] == 0)
    largest = max(float(moduli.max(initial=0.0)), 1.0)
    assert abs(values.imag.sum()) <= 1e-9 * largest, "complex multipliers are not in pairs"


def _check_row(branch: Branch, system: System, row: np.void, walking: float) -> None:
    where = f"{branch.info.free[0]} = {row['free'][0]}"
    local = GLOBAL * walking + INDEPENDENT
    p, legs = parameters_at(branch, system, row), legs_of(branch, system, row, max(ASKED * local, RELATIVE))
    size = _sizes([Motion(leg.x, leg.start, leg.duration, leg.end, leg.at) for leg in legs])
    total = sum(leg.duration for leg in legs)
    assert abs(total - row["period"]) <= 1e-14 * abs(total)
    if system.period is not None:
        whole = branch.info.subharmonic * float(system.period(p))
        assert abs(total - whole) <= 1e-12 * whole, f"{total} s are no whole periods at {where}"
    turns = np.array(branch.info.settings["turns"])
    growth = max(_scaled_norm(system, legs, k, size) for k in range(len(legs)))
    noise = local * max(growth, 1.0)
    for k, leg in enumerate(legs):
        following = legs[(k + 1) % len(legs)]
        target = following.x + (turns if k == len(legs) - 1 else 0.0)
        gap = np.linalg.norm((leg.after - target) / size)
        assert gap <= noise, f"leg {k} at {where} misses by {gap} of {noise}"
        if leg.transition is not None:
            value = abs(leg.transition.guard(leg.start + leg.duration, leg.end, p))
            # A leg that lasts no time does not tell how large its guard is elsewhere.
            largest = max(_largest(other, leg.transition, p) for other in legs)
            assert value <= noise * largest, f"the guard is {value} at the end of leg {k} at {where}"
    _check_spectrum(branch, system, row, legs, size, noise, where)
    _check_admissible(system, row, legs, p, noise, where)


def _scaled(system: System, legs: list[Leg], k: int, size: np.ndarray) -> np.ndarray:
    leg = legs[k]
    own = list(system.states_of(leg.mode))
    target = own if leg.transition is None else list(system.states_of(leg.transition.target))
    return leg.factor / size[target][:, None] * size[own]


def _scaled_norm(system: System, legs: list[Leg], k: int, size: np.ndarray) -> float:
    return float(np.linalg.norm(_scaled(system, legs, k, size), 2))


def _largest(leg: Leg, transition: Transition, p: SimpleNamespace) -> float:
    times = np.linspace(0.0, 1.0, 40)
    values = [
        abs(transition.guard(leg.start + t * leg.duration, x, p))
        for t, x in zip(times, leg.at(times), strict=True)
    ]
    return max(values)


def _check_spectrum(
    branch: Branch,
    system: System,
    row: np.void,
    legs: list[Leg],
    size: np.ndarray,
    noise: float,
    where: str,
) -> None:
    """Stored multipliers are eigenvalues of the product of the legs' derivatives; 1 is another one of an
    autonomous machine.
    """
    smallest = int(np.argmin([len(system.states_of(leg.mode)) for leg in legs]))
    product = np.eye(_scaled(system, legs, smallest, size).shape[1])
    for k in range(len(legs)):
        product = _scaled(system, legs, (smallest + k) % len(legs), size) @ product
    values = row["spectrum"][np.isfinite(row["spectrum"])]
    expected = values if system.period is not None else np.append(values, 1.0)
    norm = max(1.0, float(np.linalg.norm(product, 2)))
    for value in expected:
        apart = np.linalg.svd(product - value * np.eye(len(product)), compute_uv=False)[-1]
        assert apart <= noise * norm, f"{value} is no multiplier at {where}: {apart} of {noise * norm}"
    if len(expected) == len(product):
        total = abs(expected.sum() - np.trace(product))
        assert total <= len(product) * noise * norm, f"multipliers do not add up at {where}: {total}"


def margins(system: System, legs: list[Leg], p: SimpleNamespace) -> Mapping[str, tuple[float, float]]:
    """Least value under each name, and the largest value there is: of guards inside legs that are not their
    own, and of conditions. Positive is admissible.
    """
    found: dict[str, tuple[float, float]] = {}
    times = np.linspace(0.0, 1.0, SAMPLES)
    for leg in legs:
        states = leg.at(times)
        for other in system.leaving(leg.mode):
            if other == leg.transition or other.role == "soft":
                continue
            sign = -1.0 if other.direction == "rising" else 1.0
            values = np.array(
                [
                    sign * other.guard(leg.start + t * leg.duration, x, p)
                    for t, x in zip(times, states, strict=True)
                ]
            )
            least, most = found.get(other.name, (np.inf, 0.0))
            found[other.name] = (min(least, values.min()), max(most, np.abs(values).max()))
        if leg.transition is None:
            continue
        for condition in system.conditions:
            if condition.at == leg.transition.name:
                x = leg.end if condition.side == "before" else leg.after
                value = float(condition.function(leg.start + leg.duration, x, p))
                least, most = found.get(condition.name, (np.inf, 0.0))
                found[condition.name] = (min(least, value), max(most, abs(value)))
    return found


def _check_admissible(
    system: System, row: np.void, legs: list[Leg], p: SimpleNamespace, noise: float, where: str
) -> None:
    """An orbit is admissible if no margin is negative beyond doubt."""
    total = sum(leg.duration for leg in legs)
    if any(leg.duration < -CERTAIN * total for leg in legs):
        assert not row["admissible"], where
    if any(leg.duration < 0.0 for leg in legs):
        return
    values = margins(system, legs, p)
    doubt = max(CERTAIN, noise)
    if any(v < -doubt * most for v, most in values.values()):
        assert not row["admissible"], f"admissible at {where} with {values}"
    # Samples may miss the bottom of a dip, so that no value here proves an orbit admissible.
    both = [t for leg in legs for t in system.leaving(leg.mode) if t.direction == "both"]
    if not both and not row["admissible"] and not row["special"]:
        grazes = any(_own_dip(leg, p) < 0.0 for leg in legs if leg.transition is not None)
        least = min((v / most for v, most in values.values() if most > 0.0), default=1.0)
        assert grazes or least < 1e-3, f"not admissible at {where} with {values}"


def _own_dip(leg: Leg, p: SimpleNamespace) -> float:
    """Least value of a leg's own guard well before its end, in units of its largest."""
    assert leg.transition is not None
    sign = -1.0 if leg.transition.direction == "rising" else 1.0
    times = np.linspace(0.0, 1.0, SAMPLES)
    values = np.array(
        [
            sign * leg.transition.guard(leg.start + t * leg.duration, x, p)
            for t, x in zip(times, leg.at(times), strict=True)
        ]
    )
    return float(values[5:-5].min() / np.abs(values).max())
