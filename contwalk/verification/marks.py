"""What is marked: a parameter, a state, or another number of a solution has a value."""

from __future__ import annotations

import numpy as np

from contwalk import quantities
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import Observable
from contwalk.system.declarations import ParameterValues
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.finding import CannotTell
from contwalk.verification.passage import EPSILON, TIGHT, passed, zero_between
from contwalk.verification.solving import ROUGH, Condition, Sheet


def mark(branch: Branch, point: SpecialPoint, equations: Equations, sheet: Sheet) -> Condition:
    """The condition of a marked value; of one that is only touched, that the number does not change there."""
    if not point.mark:
        raise CannotTell("The record does not tell what is marked there.")
    name, level = str(point.mark["name"]), point.mark["value"]
    if level is None:
        return _slope(equations, number(branch, equations, name))
    names = branch.info.free
    if name in names:
        place, size = (
            equations.size + names.index(name),
            max(abs(float(level)), equations.sizes[equations.size]),
        )
        return lambda at: (float(at.z[place]) - float(level)) / size
    function = number(branch, equations, name)
    if len(names) == 1 and _touched(equations, sheet, function, float(level), float(point.error or 0.0)):
        return _slope(equations, function)
    size = max(abs(float(level)), 1e-300)
    return lambda at: (function(at) - float(level)) / size


def _touched(equations: Equations, sheet: Sheet, function: Condition, level: float, error: float) -> bool:
    """Whether a number comes back from its value within errors: half of what its slope says is too much."""
    along = sheet.along[:, 0]
    away = 10.0 * max(error / max(abs(float(along[-1])), 1e-300), ROUGH)
    ahead, behind = (function(equations.at(equations.z + s * away * along, TIGHT)) for s in (1.0, -1.0))
    return abs(ahead - behind) < abs(ahead + behind - 2.0 * level)


def _slope(equations: Equations, function: Condition) -> Condition:
    """How fast a number changes along a branch, by central differences of fourth order.

    They are taken along the tangent, off the branch by the same on both sides.
    """
    if len(equations.free) != 1:
        raise CannotTell("Extrema along curves in two parameters are not recomputed.")
    ahead = np.zeros(0)

    def slope(at: Evaluation) -> float:
        nonlocal ahead
        _, _, right = np.linalg.svd(at.jacobian * equations.sizes)
        ahead = right[-1] if not len(ahead) or right[-1] @ ahead >= 0.0 else -right[-1]
        # Rounding and order of the differences cost the same here; another step shows what it makes of them.
        step = EPSILON**0.2 * (1.0 if at.relative <= TIGHT else 2.0)
        away = step * equations.sizes * ahead
        four = [function(equations.at(at.z + k * away, TIGHT)) for k in (-2.0, -1.0, 1.0, 2.0)]
        return (four[0] - 8.0 * four[1] + 8.0 * four[2] - four[3]) / (12.0 * step)

    return slope


def number(branch: Branch, equations: Equations, name: str) -> Condition:
    """A number of a solution by the name it is stored under.

    Raises
    ------
    CannotTell
        If it is computed from a whole motion, of which it is an observable.
    """
    system, states = equations.functions.system, branch.info.states
    if name == "max_re":
        return lambda at: float(at.spectrum.real.max())
    if name == "max_abs":
        return lambda at: float(np.abs(at.spectrum).max())
    if equations.unit:
        if name == quantities.PERIOD:
            return lambda at: float(sum(leg.duration for leg in at.legs))
        kind, _, state = name.partition(":")
        if state in states and kind + ":" in (quantities.MAX, quantities.MIN):
            sign, place = (1.0 if kind + ":" == quantities.MAX else -1.0), states.index(state)
            return lambda at: _extreme(equations, at, place, sign)
        raise CannotTell(f"'{name}' is an observable of the plugin, computed from a whole motion.")
    own = list(system.states_of(equations.mode))  # type: ignore[attr-defined]
    if name in states and states.index(name) in own:
        place = own.index(states.index(name))
        return lambda at: float(at.z[place])
    measured = next((each for each in system.observables if each.name == name and each.at is None), None)
    if measured is not None:
        return lambda at: _measured(equations, at, measured, own, len(states))
    raise CannotTell(f"'{name}' is not recomputed.")


def _measured(
    equations: Equations, at: Evaluation, observable: Observable, own: list[int], states: int
) -> float:
    """An observable of an equilibrium: a motion of one instant."""
    x = np.zeros((1, states))
    x[0, own] = at.z[: len(own)]
    p = equations.functions.parameters.by_name(at.z[equations.size :])
    return float(observable.function(np.zeros(1), x, ParameterValues(**p)))


def _extreme(equations: Equations, at: Evaluation, place: int, sign: float) -> float:
    """The largest value of a state over an orbit, or the least: at a step, or where its rate turns."""
    functions, best = equations.functions, -np.inf
    p = functions.parameters.at(at.z[equations.size :])
    for leg in at.legs:
        own = functions.system.states_of(leg.mode)
        if place not in own:
            continue
        i, field = own.index(place), functions.field(leg.mode)
        scale = equations._scale(leg.mode)  # type: ignore[attr-defined]
        for piece in leg.pieces:
            values = sign * piece.states[:, i]
            rates = [sign * field(t, x, p)[0][i] for t, x in zip(piece.times, piece.states, strict=True)]
            best = max(best, float(values.max()))
            for k in range(len(rates) - 1):
                if not (rates[k] > 0.0 > rates[k + 1]) or max(values[k], values[k + 1]) < best - 0.1 * np.ptp(
                    values
                ):
                    continue
                t, x, end = float(piece.times[k]), piece.states[k], float(piece.times[k + 1])

                def after(tau: float, t: float = t, x: np.ndarray = x) -> np.ndarray:
                    return x if tau == t else passed(functions, leg.mode, t, x, tau - t, p, scale, TIGHT).end  # noqa: B023

                tau = zero_between(lambda tau: field(tau, after(tau), p)[0][i], t, end)  # noqa: B023
                best = max(best, sign * float(after(tau)[i]))
    return sign * best
