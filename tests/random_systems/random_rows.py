"""Stored orbits carried once round by the independent machine: gaps, multipliers, what they look like."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
from random_independent import Machine, TooLong

from contwalk.branch import Branch

# Pieces are cut into so many parts, for deviations that grow on the way and shrink again.
PARTS = 8
# Multipliers are computed of special rows, of every so many others, and of those that do not close so well.
EVERY, DOUBTFUL = 4, 1e-5
# Local errors of 1e-6 that a run asks for, a hundred of them, grown by this, are as large as the orbit.
HOPELESS = 1e4
# So many rows of a branch may take too long alone before others are left out in parts.
MOST_LOST = 8
# An orbit smaller than this part of its place is a Hopf point still.
POINT = 1e-9


@dataclass(frozen=True)
class Round:
    """One stored orbit, integrated anew.

    `gap` is what the pieces miss each other by, and the guards zero, in units of the states' half ranges;
    `growth` the largest growth of deviations between two instants; `multipliers` all of the product's
    eigenvalues, where they were computed, and `norm` its norm; `least`, `most` and `period` what the whole
    orbit looks like; `rounding` the states' own in units of their half ranges.
    """

    row: int
    gap: float
    growth: float
    multipliers: np.ndarray | None
    norm: float
    least: np.ndarray
    most: np.ndarray
    period: float
    rounding: float


@dataclass(frozen=True)
class Piece:
    """A piece of an orbit for many rows: where, when and how long, in which mode, and how it ends."""

    x: np.ndarray
    begin: np.ndarray
    duration: np.ndarray
    mode: str | None
    guard: str | None = None
    reset: str | None = None
    target: str | None = None


def parameters_of(branch: Branch, rows: np.ndarray) -> dict[str, Any]:
    """All parameters at some rows, the free one as an array."""
    return {**branch.info.parameters, branch.info.free[0]: rows["free"][:, 0].copy()}


def rounds(machine: Machine, branch: Branch) -> list[Round]:
    """The rows of a branch of orbits, carried round together where they have the same form.

    Left out are rows whose deviations grow so much that what a run asks of its steps becomes as large as the
    orbit: from a stored start alone no integration comes back. So are those that take too long, and those
    whose deviations overflow on the way.

    Raises
    ------
    Unchecked
        If nothing of the branch can be integrated, or an integration fails.
    """
    spectrum = np.abs(branch.points["spectrum"])
    largest = np.where(np.isfinite(spectrum), spectrum, 0.0).max(axis=1, initial=0.0)
    sizes = np.isfinite(branch.points["unknowns"]).sum(axis=1)
    found: list[Round] = []
    lost: list[int] = []
    hopeful = largest <= HOPELESS
    for size in np.unique(sizes):
        chosen = np.flatnonzero((sizes == size) & hopeful)
        for part in np.array_split(chosen, -(-len(chosen) // 64)) if len(chosen) else ():
            found += _carried_in_parts(machine, branch, part, lost)
    if np.any(hopeful) and not found:
        raise TooLong
    return sorted(found, key=lambda r: r.row)


def _carried_in_parts(machine: Machine, branch: Branch, which: np.ndarray, lost: list[int]) -> list[Round]:
    """Rows carried round in halves where all together take too long; without one that does so alone.

    Those are added to `lost`; where there are many, parts are not halved any more.
    """
    try:
        return _carried(machine, branch, which)
    except TooLong:
        if len(which) == 1 or len(lost) >= MOST_LOST:
            lost += which.tolist()
            return []
    halves = np.array_split(which, 2)
    return [turn for half in halves for turn in _carried_in_parts(machine, branch, half, lost)]


def _carried(machine: Machine, branch: Branch, which: np.ndarray) -> list[Round]:
    rows = branch.points[which]
    p, pieces = parameters_of(branch, rows), _pieces(machine, branch, rows)
    starts = np.array([piece.x for piece in pieces])
    weights = rows["weights"][:, : starts.shape[1]].T / np.sqrt(len(pieces))
    spread = np.ptp(starts, axis=0) / 2
    rough = np.where(spread > 0.0, spread, weights)
    motions = [
        machine.carried(q.x, q.begin, q.duration, p, rough, q.mode, derivative=False)[0] for q in pieces
    ]
    states = np.concatenate(motions)
    least, most = states.min(axis=0), states.max(axis=0)
    size, half = np.maximum(np.abs(least), np.abs(most)), (most - least) / 2
    # What stands still has the weight of its row for a unit.
    scale = np.where(half > POINT * np.maximum(size, weights), half, np.maximum(weights, POINT * size))
    gaps = np.zeros(len(which))
    for i in range(len(pieces)):
        gaps = np.maximum(gaps, _gap(machine, branch, pieces, i, motions[i][-1], p, scale))
    wanted = (np.arange(len(which)) % EVERY == 0) | rows["special"] | ~(gaps <= DOUBTFUL)
    chosen = np.flatnonzero(wanted)
    products, growth = _product(
        machine, branch, [_part(q, chosen) for q in pieces], [m[:, :, chosen] for m in motions],
        _rows_of(p, chosen), scale[:, chosen],
    )  # fmt: skip
    place = {int(k): i for i, k in enumerate(chosen)}
    whole = int(branch.info.settings.get("fold", 1))
    norms, known = _norms(products), np.isfinite(growth)
    # A motion that ends is a fault; one whose deviations alone are beyond numbers cannot be judged.
    given_up = {int(k) for k in chosen[~known] if np.isfinite(gaps[k])}
    multipliers = {int(k): np.linalg.eigvals(products[place[int(k)]]) for k in chosen[known]}
    return [
        Round(
            int(row),
            float(gaps[k]),
            float(growth[place[k]]) if k in place else 1.0,
            multipliers.get(k),
            float(norms[place[k]]) if k in place else 1.0,
            least[:, k],
            most[:, k],
            float(rows["period"][k]) * whole,
            float(np.max(2.3e-16 * size[:, k] / scale[:, k])),
        )
        for k, row in enumerate(which)
        if k not in given_up
    ]


# -- what a row stores ---------------------------------------------------------------------------------------


def _pieces(machine: Machine, branch: Branch, rows: np.ndarray) -> list[Piece]:
    n, info, u = len(branch.info.states), branch.info, rows["unknowns"]
    if info.problem != "hybrid_orbit":
        m = int(np.isfinite(u[0]).sum()) // n
        duration = rows["period"] / m
        return [Piece(u[:, i * n : (i + 1) * n].T, i * duration, duration, None) for i in range(m)]
    legs, known = info.settings["legs"], _transitions(machine)
    m = len(legs)
    durations = u[:, m * n : m * n + m]
    begins = np.cumsum(durations, axis=1) - durations
    if "period=period" in machine.recipe.declared:
        begins = begins + u[:, m * n + m : m * n + m + 1]
    return [
        Piece(u[:, i * n : (i + 1) * n].T, begins[:, i], durations[:, i], mode, *known.get(name, ()))
        for i, (mode, name, _) in enumerate(legs)
    ]


def _transitions(machine: Machine) -> dict[str, tuple[str | None, ...]]:
    """Guard, reset and target of each transition by name, read from the plugin's own line."""
    scope: dict[str, Any] = {**machine.now, "Transition": _named}
    for line in machine.recipe.declared:
        if line.startswith("transitions="):
            return dict(eval(line.removeprefix("transitions="), scope))
    return {}


def _named(name: str, source: str, target: str, guard: Any, reset: Any = None) -> tuple[str, tuple]:
    return name, (guard.__name__, None if reset is None else reset.__name__, target)


def _rows_of(p: dict[str, Any], chosen: np.ndarray) -> dict[str, Any]:
    return {name: v[chosen] if isinstance(v, np.ndarray) else v for name, v in p.items()}


def _part(piece: Piece, chosen: np.ndarray) -> Piece:
    return Piece(
        piece.x[:, chosen],
        piece.begin[chosen],
        piece.duration[chosen],
        piece.mode,
        piece.guard,
        piece.reset,
        piece.target,
    )


# -- events and closures -------------------------------------------------------------------------------------


def _guard(machine: Machine, piece: Piece, own: dict[str, Any], time: Any, state: np.ndarray) -> Any:
    return machine.now[str(piece.guard)](time, state, SimpleNamespace(**own))


def _reset(machine: Machine, piece: Piece, own: dict[str, Any], time: Any, state: np.ndarray) -> np.ndarray:
    return state if piece.reset is None else machine.written(piece.reset, time, state, own)


def _gap(
    machine: Machine,
    branch: Branch,
    pieces: list[Piece],
    i: int,
    end: np.ndarray,
    p: dict[str, Any],
    scale: np.ndarray,
) -> np.ndarray:
    """How far the end of a piece is from the start of the next one, and its guard from zero, for each row."""
    piece, following, missed = pieces[i], pieces[(i + 1) % len(pieces)], np.zeros(end.shape[1])
    if piece.guard is not None:
        t = piece.begin + piece.duration
        # Guards of these machines are distances of states.
        missed = np.abs(_guard(machine, piece, p, t, end)) / scale.max(axis=0)
        end = _reset(machine, piece, p, t, end)
    if i == len(pieces) - 1:
        end = _image(machine, branch) @ end
    return np.maximum(missed, np.linalg.norm((end - following.x) / scale, axis=0))


def _image(machine: Machine, branch: Branch) -> np.ndarray:
    """Matrix of the map that closes an orbit up: the declared symmetry's where the branch says so."""
    n, info = len(branch.info.states), branch.info
    closed_up = info.settings.get("image") or info.closure not in (None, "full", "legs")
    return machine.written("image", 0.0, np.eye(n), {}) if closed_up else np.eye(n)


# -- derivatives ---------------------------------------------------------------------------------------------


def _product(
    machine: Machine,
    branch: Branch,
    pieces: list[Piece],
    motions: list[np.ndarray],
    p: dict[str, Any],
    scale: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Derivative of the map once round, (k, n, n) in units of `scale`, and the largest growth on the way."""
    n, k = scale.shape
    product, growth = np.repeat(np.eye(n)[None], k, axis=0), np.ones(k)
    for i, piece in enumerate(pieces):
        factor, transient = _derivative(machine, piece, motions[i], p, scale)
        with np.errstate(all="ignore"):  # what overflows has grown without bound
            if piece.guard is not None:
                jumps = [_saltation(machine, piece, motions[i][-1], _one(p, j), j) for j in range(k)]
                factor = np.array(jumps) @ factor
            if i == len(pieces) - 1:
                factor = _image(machine, branch) @ factor
            scaled = factor / scale.T[:, :, None] * scale.T[:, None, :]
            product = scaled @ product
        growth = np.maximum(growth, np.maximum(transient, _norms(scaled)))
    return product, np.where(np.isfinite(_norms(product)), growth, np.inf)


def _norms(matrices: np.ndarray) -> np.ndarray:
    """2-norms of matrices (k, n, n); infinity of one that is not finite."""
    norms = np.full(len(matrices), np.inf)
    finite = np.isfinite(matrices).all(axis=(1, 2))
    if np.any(finite):
        norms[finite] = np.linalg.norm(matrices[finite], 2, axis=(1, 2))
    return norms


def _one(p: dict[str, Any], j: int) -> dict[str, Any]:
    return {name: float(v[j]) if isinstance(v, np.ndarray) else v for name, v in p.items()}


def _derivative(
    machine: Machine, piece: Piece, motion: np.ndarray, p: dict[str, Any], scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Derivative of a piece's end by its start, (k, n, n), and the largest growth between two instants."""
    n, k = scale.shape
    inner = motion[: -1 : (len(motion) - 1) // PARTS]
    begin = piece.begin + np.arange(PARTS)[:, None] / PARTS * piece.duration
    _, _, factors = machine.carried(
        inner.transpose(1, 0, 2).reshape(n, PARTS * k),
        begin.ravel(),
        np.tile(piece.duration / PARTS, PARTS),
        {name: np.tile(v, PARTS) if isinstance(v, np.ndarray) else v for name, v in p.items()},
        np.tile(scale, PARTS),
        piece.mode,
    )
    units = scale.T[:, None, :] / scale.T[:, :, None]
    scaled = factors.reshape(PARTS, k, n, n) * units
    growth = np.ones(k)
    for first in reversed(range(PARTS)):
        product = np.repeat(np.eye(n)[None], k, axis=0)
        for factor in scaled[first:]:
            with np.errstate(all="ignore"):
                product = factor @ product
            growth = np.maximum(growth, _norms(product))
    return product / units, growth


def _saltation(machine: Machine, piece: Piece, ends: np.ndarray, own: dict[str, Any], j: int) -> np.ndarray:
    """Derivative of the state at a fixed time after an event by that before it."""
    t, x = float(piece.begin[j] + piece.duration[j]), ends[:, j]
    h_x, h_t = machine.differential(partial(_guard, machine, piece, own), t, x)
    g_x, g_t = machine.differential(partial(_reset, machine, piece, own), t, x)
    before = machine.field(t, x, own, piece.mode)
    later = _reset(machine, piece, own, t, x)
    beyond = machine.field(t, later, own, piece.target)
    with np.errstate(all="ignore"):
        return g_x + np.outer(beyond - g_x @ before - g_t, h_x[0]) / (h_x[0] @ before + h_t[0])
