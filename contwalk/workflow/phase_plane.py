"""What a phase plane shows at given parameters: rates on a grid, equilibria, and their manifolds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from contourpy import contour_generator
from scipy.integrate import solve_ivp

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.flow.compiled.traced import field_of
from contwalk.plotting.phase_plane import Plane, Rest
from contwalk.system import System

Rates = Callable[[np.ndarray], np.ndarray]


def plane_of(
    system: System,
    parameters: Mapping[str, float],
    names: Sequence[str],
    state: np.ndarray,
    window: np.ndarray,
    *,
    points: int = 161,
    accuracy: float = 1e-7,
) -> Plane:
    """The phase plane of two states, the others held.

    Parameters
    ----------
    system : System
    parameters : mapping
        Values of all parameters.
    names : pair of str
        The states.
    state : ndarray, shape (n,)
        Values of the others.
    window : ndarray, shape (2, 2)
        For each of the two states its least and largest value.
    points : int
        Of the grid, along each axis.
    accuracy : float
        Of manifolds, in sizes of the window. They begin its root off the equilibrium, where a straight line
        is off by as much as its square.

    Raises
    ------
    ContwalkError
        If the field depends on the time, or the system has events, is a map, or lacks a state.
    """
    _check(system, names)
    field = field_of(system)
    c = field.constants([parameters[name] for name in system.parameter_names])
    chosen = [system.state_names.index(name) for name in names]

    def rates(places: np.ndarray) -> np.ndarray:
        states = np.tile(np.asarray(state, dtype=float), (len(places), 1))
        states[:, chosen] = places
        return np.asarray(field.along(np.zeros(len(places)), states, c)[:, chosen])

    x, y = (np.linspace(low, high, points) for low, high in window)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    with np.errstate(all="ignore"):
        found = rates(grid.reshape(-1, 2)).reshape(grid.shape)
    whole = len(system.states) == 2
    with np.errstate(all="ignore"):
        zeros, passed = zip(*(_nullclines(rates, grid, found, number) for number in range(2)), strict=True)
    rests = _rests(rates, grid, passed[0] & passed[1], window) if whole else []
    ways = [way for rest in rests if rest.saddle for way in _manifolds(rates, rest, window, points, accuracy)]
    return Plane(tuple(names), x, y, found, zeros, tuple(rests), tuple(ways))


def _check(system: System, names: Sequence[str]) -> None:
    unknown = [name for name in names if name not in system.state_names]
    if unknown or len(set(names)) < 2:
        raise ContwalkError(
            f"A phase plane has two states, not {' and '.join(names)}.",
            f"Name two of {', '.join(system.state_names)} with -x and -y.",
        )
    if not _one_field(system):
        raise ContwalkError(
            f"The system '{system.name}' has no one field that holds at all times: it is forced, has events "
            "or is a map.",
            "Draw a phase_portrait.",
        )


def _one_field(system: System) -> bool:
    """Whether one field holds at all times."""
    changes = len(system.modes) > 1 or bool(system.transitions)
    return not changes and system.period is None and system.modes[0].kind != "map"


def _nullclines(
    rates: Rates, grid: np.ndarray, found: np.ndarray, number: int, halvings: int = 24
) -> tuple[list[np.ndarray], np.ndarray]:
    """Curves, each of shape (k, 2), on which a rate is zero; which cells of the grid they pass.

    Between two points of the grid a rate changes its sign where it is zero, at a pole, and where it jumps.
    The interval between them is halved again and again: towards a zero the rate falls with it, as a power of
    it. Elsewhere the curve is broken.
    """
    step, last, curves = grid[1, 1] - grid[0, 0], np.array(grid.shape[1::-1]) - 1, []
    passed = np.zeros(tuple(last[::-1]), dtype=bool)
    sizes = np.pad(np.nan_to_num(np.abs(found[..., number]), posinf=0.0), 1)
    around = np.lib.stride_tricks.sliding_window_view(sizes, (3, 3)).max(axis=(2, 3))
    for line in contour_generator(grid[0, :, 0], grid[:, 0, 1], found[..., number]).lines(0.0):
        at = (np.asarray(line) - grid[0, 0]) / step
        # A place of the curve lies on an edge of the grid: along it one coordinate is no whole number.
        along = np.eye(2)[np.argmax(np.abs(at - np.round(at)), axis=1)]
        low = np.where(along > 0, np.floor(at), np.round(at))
        corner = low.astype(int)
        low, high = (grid[0, 0] + step * np.minimum(end, last) for end in (low, low + along))
        above = rates(high)[:, number]
        for _ in range(halvings):
            middle = (low + high) / 2
            value = rates(middle)[:, number]
            upper = (np.sign(value) == np.sign(above))[:, None]
            low, high = np.where(upper, low, middle), np.where(upper, middle, high)
        nearest = around[tuple(np.round(at).astype(int).T[::-1])]
        zero = np.abs(rates((low + high) / 2)[:, number]) <= nearest * 2.0 ** (-halvings / 4)
        for part in np.split(np.arange(len(at)), np.flatnonzero(np.diff(zero)) + 1):
            if zero[part[0]] and len(part) > 1:
                curves.append((low + high)[part] / 2)
        for beside in (corner, corner + along.astype(int) - 1):  # the cells on both sides of an edge
            column, row = np.clip(beside[zero], 0, last - 1).T
            passed[row, column] = True
    return curves, passed


def _rests(rates: Rates, grid: np.ndarray, passed: np.ndarray, window: np.ndarray) -> list[Rest]:
    """Equilibria in the window: Newton's method from each cell that nullclines of both rates pass."""
    size = window[:, 1] - window[:, 0]
    rests: list[Rest] = []
    for row, column in np.argwhere(passed):
        rest = _rest_near(rates, (grid[row, column] + grid[row + 1, column + 1]) / 2, size)
        if rest is None or np.any((rest.place < window[:, 0]) | (rest.place > window[:, 1])):
            continue
        if not any(np.all(np.abs(rest.place - known.place) < 1e-6 * size) for known in rests):
            rests.append(rest)
    return rests


def _rest_near(rates: Rates, place: np.ndarray, size: np.ndarray) -> Rest | None:
    """The equilibrium that Newton's method finds from a place, shape (2,); sizes are those of the window."""
    for _ in range(30):
        slopes = _slopes(rates, place, size)
        if not np.isfinite(slopes).all() or np.linalg.matrix_rank(slopes) < 2:
            return None
        step = np.linalg.solve(slopes, rates(place[None])[0])
        place = place - step
        if np.all(np.abs(step) <= 1e-10 * size):
            return Rest(place, np.linalg.eigvals(slopes), slopes)
    return None


def _slopes(rates: Rates, place: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The Jacobian of the rates by central differences, to a picture's accuracy; (2, 2)."""
    steps = np.diag(np.cbrt(np.finfo(float).eps) * size)
    ahead, back = rates(place + steps), rates(place - steps)
    return np.asarray(((ahead - back) / (2 * np.diag(steps))[:, None]).T)


def _manifolds(
    rates: Rates, rest: Rest, window: np.ndarray, points: int, accuracy: float
) -> list[tuple[np.ndarray, bool]]:
    """Both ways of the unstable and of the stable manifold of a saddle: points (k, 2), and whether unstable.

    Each is followed until it leaves the window by half its size, or as long as a deviation takes to grow by
    what a double can tell.
    """
    size = window[:, 1] - window[:, 0]
    outer = window + np.array([-0.5, 0.5]) * size[:, None]
    values, vectors = np.linalg.eig(rest.slopes)
    ways = []
    for value, vector in zip(values.real, vectors.real.T, strict=True):
        forward = 1.0 if value > 0 else -1.0
        direction = vector / np.linalg.norm(vector / size)

        def rate(t: float, place: np.ndarray, forward: float = forward) -> np.ndarray:
            return forward * rates(place[None])[0]

        def inside(t: float, place: np.ndarray, *rest: float) -> float:
            return float(np.minimum(place - outer[:, 0], outer[:, 1] - place).min())

        inside.terminal = True  # type: ignore[attr-defined]
        long = -np.log(np.finfo(float).eps) / abs(value)
        for side in (accuracy**0.5, -(accuracy**0.5)):
            found = solve_ivp(
                rate,
                (0.0, long),
                rest.place + side * direction,
                method="DOP853",
                rtol=accuracy,
                atol=accuracy * float(size.min()),
                events=inside,
                t_eval=np.linspace(0.0, long, 10 * points),
            )
            ways.append((np.vstack([rest.place, found.y.T]), bool(value > 0)))
    return ways


def drawn_plane(
    system: System,
    points: Sequence[tuple[Branch, SpecialPoint | int]],
    names: Sequence[str],
    motions: Sequence[np.ndarray],
) -> Plane:
    """The phase plane about stored points, at the parameters of the first.

    Parameters
    ----------
    system : System
    points : sequence of (Branch, special point or number of a row)
    names : pair of str
    motions : sequence of arrays of shape (k, n)
        Orbits that are shown; the window holds them, and the states of the branches there.

    Raises
    ------
    ContwalkError
        As `plane_of`; if the points are at different parameters.
    """
    _check(system, names)
    places = [_parameters(*point) for point in points]
    for place, (branch, _) in zip(places, points, strict=True):
        if any(place[name] != places[0][name] for name in system.parameter_names):
            raise ContwalkError(
                f"The points are at different parameters: {branch.info.free[0]} differs.",
                "A phase plane is drawn at one value; give points of one.",
            )
    chosen = [system.state_names.index(name) for name in names]
    states = [branch.points["state"][:, : len(system.states)] for branch, _ in points]
    held = _state(system, *points[0])
    window = window_about(np.vstack([*states, *motions, held])[:, chosen])
    return plane_of(system, places[0], names, held, window)


def has_plane(system: System) -> bool:
    """Whether the phase plane of a system is all there is to see of it."""
    return len(system.states) == 2 and _one_field(system)


def window_about(shown: np.ndarray) -> np.ndarray:
    """For each of two states its least and largest value, shape (2, 2), of a window about what is shown,
    shape (k, 2), with half its size beside it.
    """
    shown = shown[np.isfinite(shown).all(axis=1)]
    low, high = shown.min(axis=0), shown.max(axis=0)
    # A branch of one state that stays where it is has no size of its own.
    largest = np.maximum(abs(low), abs(high))
    moves = high - low > np.sqrt(np.finfo(float).eps) * largest
    size = np.where(moves, high - low, np.where(largest > 0, largest, 1.0))
    return np.stack([low - size / 2, high + size / 2], axis=1)


def _parameters(branch: Branch, point: SpecialPoint | int) -> dict[str, float]:
    return dict(point.parameters) if isinstance(point, SpecialPoint) else dict(branch.parameters_at(point))


def _state(system: System, branch: Branch, point: SpecialPoint | int) -> np.ndarray:
    state = point.state if isinstance(point, SpecialPoint) else None
    if state:
        return np.array([state[name] for name in system.state_names])
    row = point.index if isinstance(point, SpecialPoint) else point
    return np.asarray(branch.points["state"][row])
