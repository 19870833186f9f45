"""What motions conserve, such as an energy: orbits at a given value of it, each alone.

A periodic orbit of a machine that conserves H(x) has neighbours at the same parameters, one for each value of
H: the multiplier 1 is double, and no correction knows which orbit is meant. So the field of an orbit's
equations is

    f(x) - r (H(x) - h) g / |g|^2,    g = grad H,

with the value h as one more parameter. On H = h nothing is changed, neither the motion nor the deviations
within that surface. Off it H - h decays as exp(-r t), and so a closed orbit lies on it: the orbit is alone,
the second multiplier is exp(-r T) and has the left vector g. Other ways to the same end add a multiple of g
to the field, which must turn out to be zero (Munoz-Almaraz, Freire, Galan, Doedel & Vanderbauwhede, Physica D
181, 1, 2003). This one needs no further unknown, and what it changes vanishes on every solution.

Several quantities are held each by its own term.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from contwalk.fields.derivative import jacobian
from contwalk.fields.expression import Expression
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer
from contwalk.flow.compiled.traced import conserved_map
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

# r times the duration of a closure, or of a leg: e-fold decay of what is off the surface.
RATE = 1.0
# Where the gradient vanishes nothing is held: 0 / LEAST is 0.
LEAST = 1e-300
# What a quantity may be off its value, in units of what the errors of an orbit make of it.
HELD = 30.0

ONE_OF_EACH_VALUE = (
    "Declare what is conserved in the plugin, as conserved=(Conserved('energy', energy, unit='J'),) with a "
    "function energy(t, x, p), and continue orbits at a given value of it, or along it: "
    "continue: {parameter: energy}."
)


def returning(
    tracer: Tracer, system: System, mode: str, t: Any, x: np.ndarray, p: ParameterValues
) -> list[Any]:
    """What is taken off the field for the quantities to stay at their values, an entry for each of x.

    Entries of x that are no symbols belong to states that do not exist.
    """
    result: list[Any] = [0.0] * len(x)
    places = [i for i, entry in enumerate(x) if isinstance(entry, Expression)]
    graph = tracer.graph
    for quantity in system.conserved:
        value = rebound(quantity.of(mode))(t, x, p)
        if not isinstance(value, Expression):
            continue
        slopes = jacobian(graph, [value.node], [x[i].node for i in places])[0]
        gradient = {places[k]: value.wrap(node) for k, node in slopes.items()}
        if not gradient:
            continue
        share = (value - getattr(p, quantity.name)) / (sum(g * g for g in gradient.values()) + LEAST)
        for i, g in gradient.items():
            result[i] = result[i] + RATE * share * g
    return result


def values_of(system: System, mode: str, x: np.ndarray, parameters: Mapping[str, float]) -> np.ndarray:
    """The conserved quantities at a state of full length, shape (k,)."""
    return _evaluated(system, mode, x, parameters)[0]


def gradients_of(system: System, mode: str, x: np.ndarray, parameters: Mapping[str, float]) -> np.ndarray:
    """Their gradients, shape (k, n), zero in states that do not exist in the mode."""
    return _evaluated(system, mode, x, parameters)[1]


def _evaluated(
    system: System, mode: str, x: np.ndarray, parameters: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    map_, own = conserved_map(system, mode), list(system.states_of(mode))
    c = map_.constants(np.array([parameters[name] for name in system.parameter_names], dtype=float))
    slopes = np.zeros((len(system.conserved), len(x)))
    slopes[:, own] = map_.jacobian(0.0, x[own], c)
    return map_(0.0, x[own], c), slopes


def with_own_values(
    system: System, parameters: Mapping[str, float], x: np.ndarray, mode: str
) -> dict[str, float]:
    """The parameters with what a start has of the quantities whose values nobody gives."""
    result = dict(parameters)
    missing = [name for name in system.conserved_names if np.isnan(result.get(name, np.nan))]
    if missing:
        known = {**result, **dict.fromkeys(missing, 0.0)}
        found = dict(zip(system.conserved_names, values_of(system, mode, x, known).tolist(), strict=True))
        result |= {name: found[name] for name in missing}
    return result


def raised(gradients: np.ndarray, magnitudes: np.ndarray) -> np.ndarray:
    """Gradients (k, n) as directions in the metric of the magnitudes, (n, k).

    Deviations at a right angle to them keep the quantities to first order. They and the flow's own direction,
    which does too, span what is left out of the multipliers.
    """
    return (gradients * magnitudes**2).T


def off(system: System, mode: str, x: np.ndarray, parameters: Mapping[str, float], errors: np.ndarray) -> str:
    """Name of the quantity that is not at its value at a state, beyond what errors of the states, (n,), make
    of it; empty where all are.
    """
    values, gradients = _evaluated(system, mode, x, parameters)
    for quantity, value, gradient in zip(system.conserved, values, gradients, strict=True):
        allowed = HELD * (float(np.abs(gradient) @ errors) + np.finfo(float).eps * abs(float(value)))
        if abs(float(value) - parameters[quantity.name]) > allowed:
            return quantity.name
    return ""
