"""What is true of any branch of periodic orbits, checked by integrations that are not the engine's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import gcd
from types import SimpleNamespace

import numpy as np
from independent_flow import RELATIVE, Passage, derived, passed, reached
from special_point_invariants import check_special_points

from contwalk.branch import Branch
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.layout import times_chosen
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.system import Symmetry, System

# How much of the local errors that a run asks for may reach the end of a segment, where nothing grows: local
# errors of a hundred steps add up, and the controller keeps their estimates, not the errors themselves.
GLOBAL = 100.0
# The independent integrations end with some 1e-12 of the states' sizes at the least; they are asked for so
# much of what an orbit may miss, so that what they miss themselves is a hundredth of it at the most.
INDEPENDENT, ASKED = 1e-11, 1e-4
# An orbit smaller than this part of its place is a Hopf point still.
POINT = 1e-9


@dataclass(frozen=True)
class Row:
    """A stored orbit with all that an integration of it needs."""

    row: np.void
    starts: np.ndarray
    cuts: np.ndarray
    duration: float
    parameters: Mapping[str, float]
    symmetry: Symmetry | None
    fold: int


def check_orbit_branch(
    branch: Branch, problem: PeriodicOrbit | Equilibrium, every: int = 5, method: str = "DOP853"
) -> None:
    """Assert the invariants of a branch of `problem`'s orbits, or of those born on its equilibria.

    Every special row and each `every`-th of the others is integrated anew by scipy's `method`.
    """
    assert branch.complete
    assert branch.info.problem == "periodic_orbit"
    assert branch.info.states == problem.system.state_names
    assert branch.outcome.status in ("complete", "stopped", "failed")
    assert branch.outcome.message.endswith((".", ".)"))
    _check_order(branch)
    _check_counts_between(branch)
    check_special_points(branch)
    for i, row in enumerate(branch.points):
        _check_count(row)
        if i % every == 0 or row["special"]:
            _check_orbit(branch, problem, row, method)


def _check_order(branch: Branch) -> None:
    s = branch["s"]
    assert np.all(np.isfinite(s))
    assert np.all(np.diff(s) >= 0.0), "points are not ordered by arclength"
    assert np.any(s == 0.0), "the start is missing"
    assert np.all(np.diff(s[~branch["special"]]) > 0.0), "two regular points at the same place"


def _check_counts_between(branch: Branch) -> None:
    """The unstable count changes at special points only, and where the branch was born."""
    rows = branch.points
    for a, b in pairwise(rows):
        birth = branch.info.parent is not None and 0.0 in (a["s"], b["s"])
        if not birth and not a["special"] and not b["special"]:
            assert a["unstable"] == b["unstable"], f"a crossing was missed between s = {a['s']} and {b['s']}"


def _check_count(row: np.void) -> None:
    moduli = np.abs(row["spectrum"][np.isfinite(row["spectrum"])])
    assert np.all(np.diff(moduli) <= 1e-12 * moduli[:-1]), "multipliers are not in descending order"
    doubt = float(row["spectrum_error"]) + 1e-12
    assert np.sum(moduli > 1.0 + doubt) <= row["unstable"] <= np.sum(moduli >= 1.0 - doubt)
    assert bool(row["stable"]) == (row["unstable"] == 0)
    values = row["spectrum"][np.isfinite(row["spectrum"])]
    assert abs(values.imag.sum()) <= 1e-9 * moduli.max(), "complex multipliers are not in pairs"


def orbit_of(branch: Branch, problem: PeriodicOrbit | Equilibrium, row: np.void) -> Row:
    """A stored row taken apart: starts of the segments, duration of the closure, parameters."""
    system, n = problem.system, len(branch.info.states)
    # Rows of a branch may have different numbers of segments; what a row does not need is NaN.
    length, fold = int(np.isfinite(row["unknowns"]).sum()), int(branch.info.settings["fold"])
    m = length // n
    cuts = np.arange(m) / m
    settings = branch.info.settings
    chosen = "scheme" in settings
    if settings.get("evenly_first"):
        given = (system.period is None) + len(settings.get("pins", ())) + 1
        chosen = times_chosen(np.append(row["unknowns"][:length], row["free"][0]), n, given) is not None
    if chosen:  # the times of the cuts stand last
        others = (system.period is None) + len(branch.info.settings.get("pins", ()))
        m = (length + 1 - others) // (n + 1)
        cuts = np.concatenate([[0.0], row["unknowns"][length - m + 1 : length]])
    value = float(row["free"][0])
    parameters = {**branch.info.parameters, branch.info.free[0]: value}
    if problem.line.ends is not None:
        begin, end = problem.line.ends
        parameters = {name: begin[name] + value * (end[name] - begin[name]) for name in begin}
    duration = float(row["period"])
    if system.period is not None:
        whole = branch.info.subharmonic * float(system.period(SimpleNamespace(**parameters)))
        assert abs(duration - whole / fold) <= 1e-14 * duration
    else:
        assert row["unknowns"][m * n] == duration
    symmetry = next((s for s in system.symmetries if s.name == branch.info.closure), None)
    assert (symmetry is None) == (branch.info.closure == "full") == (fold == 1)
    starts = np.array(row["unknowns"][: m * n]).reshape(m, n)
    assert np.array_equal(starts[0], row["state"])
    return Row(row, starts, cuts, duration, parameters, symmetry, fold)


def sizes_of(system: System, orbit: Row, weights: np.ndarray, method: str = "DOP853") -> np.ndarray:
    """Half the range of each state along the orbit, or its weight where it stands still."""
    n, m = orbit.starts.shape[1], len(orbit.starts)
    rough = np.maximum(weights[:n] / np.sqrt(m), 1e-300)
    states = np.concatenate(
        [reached(system, orbit.parameters, x, *span, rough, method) for x, span in _spans(orbit)]
    )
    half = 0.5 * np.ptp(states, axis=0)
    return np.where(half > POINT * np.maximum(np.abs(states).max(axis=0), rough), half, rough)


def _spans(orbit: Row) -> list[tuple[np.ndarray, tuple[float, float]]]:
    """The orbit's segments: the start of each, and when it begins and ends."""
    times = np.append(orbit.cuts, 1.0) * orbit.duration
    return list(zip(orbit.starts, pairwise(times.tolist()), strict=True))


def passages(
    system: System, orbit: Row, scale: np.ndarray, method: str = "DOP853", relative: float = RELATIVE
) -> list[Passage]:
    """The orbit's segments, each integrated from its own start."""
    return [passed(system, orbit.parameters, x, *span, scale, method, relative) for x, span in _spans(orbit)]


def _closed(system: System, orbit: Row, end: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The image of the last end that is nearest to the start, and the derivative of the map to it."""
    n = len(end)
    images = [(end, np.eye(n))]
    if orbit.symmetry is not None:
        images, x, whole = [], end, np.eye(n)
        for power in range(1, orbit.fold):
            x, moved = derived(orbit.symmetry.map, 0.0, x, SimpleNamespace(**orbit.parameters), np.eye(n))
            whole = moved @ whole
            if gcd(power, orbit.fold) == 1:
                images.append((x, whole))
    angles = np.array([s.period or 0.0 for s in system.states])
    apart = [_turned(x - orbit.starts[0], angles) for x, _ in images]
    best = int(np.argmin([np.linalg.norm(a / scale) for a in apart]))
    return orbit.starts[0] + apart[best], images[best][1]


def _turned(apart: np.ndarray, angles: np.ndarray) -> np.ndarray:
    turns = np.divide(apart, angles, out=np.zeros_like(apart), where=angles > 0.0)
    return apart - np.round(turns) * angles


def _check_orbit(
    branch: Branch, problem: PeriodicOrbit | Equilibrium, row: np.void, method: str = "DOP853"
) -> None:
    """The orbit closes, segment by segment, and its multipliers are those of the variational equations."""
    system, orbit = problem.system, orbit_of(branch, problem, row)
    scale = sizes_of(system, orbit, np.array(row["weights"]), method)
    local = GLOBAL * (problem.discretization or Discretization()).walking + INDEPENDENT
    pieces = passages(system, orbit, scale, method, max(ASKED * local, RELATIVE))
    factors = [piece.derivative for piece in pieces]
    where = f"{branch.info.free[0]} = {row['free'][0]}"
    for i, piece in enumerate(pieces):
        end, target = piece.states[-1], orbit.starts[(i + 1) % len(pieces)]
        if i == len(pieces) - 1:
            end, moved = _closed(system, orbit, end, scale)
            factors[i] = moved @ factors[i]
        gap = float(np.linalg.norm((end - target) / scale))
        assert gap <= local * max(piece.growth, 1.0), f"segment {i} at {where} misses by {gap}"
    scaled = [factor / scale[:, None] * scale for factor in factors]
    noise = local * max(piece.growth for piece in pieces)
    _check_spectrum(branch, row, scaled, noise, where)
    if system.period is None and np.isfinite(row["trivial_error"]) and len(pieces) == 1:
        assert 0.0 <= row["trivial_error"] <= noise, f"the flow's own multiplier is off at {where}"


def _check_spectrum(
    branch: Branch, row: np.void, factors: list[np.ndarray], noise: float, where: str
) -> None:
    """Each stored multiplier is one of the product, whose m-th roots are eigenvalues of the cyclic matrix."""
    m, n = len(factors), len(factors[0])
    cyclic = np.zeros((m * n, m * n), dtype=complex)
    for i, factor in enumerate(factors):
        j = (i + 1) % m
        cyclic[j * n : (j + 1) * n, i * n : (i + 1) * n] = factor
    values = np.array(row["spectrum"])
    values = values[np.isfinite(values)]
    for value in values:
        root = complex(value) ** (1.0 / m)
        distance = np.linalg.svd(cyclic - root * np.eye(m * n), compute_uv=False)[-1]
        assert distance <= noise, f"{value} is no multiplier at {where}: {distance} of {noise}"
    if m == 1:
        total = values.sum() + (n - len(values))
        # Where the end is off by the noise, so is the place that the derivative is taken at, as often as it
        # grows.
        size = max(1.0, float(np.linalg.norm(factors[0], 2)))
        apart = abs(total - np.trace(factors[0]))
        assert apart <= n * noise * size, f"multipliers do not add up at {where}: {apart}"
    if "max_abs" in branch.info.observables:
        rounds = {1.0, float(branch.info.settings["fold"])}
        own = row["observables"][branch.info.observables.index("max_abs")]
        assert any(np.isclose(own, abs(values[0]) ** k, rtol=1e-12) for k in rounds)
