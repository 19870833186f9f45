"""Multipliers of a constant solution of a forced system, by collocation: no integrator of the program."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
from numpy.polynomial import legendre

from contwalk.plugin_check.traced import Traced, vector_form

STAGES = 20
PANELS = 3


@cache
def gauss() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes and weights on [0, 1], and the integrals of the nodes' polynomials from 0 to each node."""
    nodes, weights = legendre.leggauss(STAGES)
    values = legendre.legvander(nodes, STAGES)
    orders = np.arange(1, STAGES)
    integrals = np.empty((STAGES, STAGES))
    integrals[:, 0] = nodes + 1.0
    integrals[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * orders + 1)
    return 0.5 * (nodes + 1.0), 0.5 * weights, 0.5 * integrals @ np.linalg.inv(values[:, :-1])


def traced_field(system) -> Traced:
    return Traced(system.modes[0].field, system, vector_form(system, "field", "dx"))


def jacobians(system, parameters, times, x):
    """df/dx, exact, of the traced field, shape (k, n, n)."""
    field, values = traced_field(system), [parameters[name] for name in system.parameter_names]
    return np.array([field.slopes(t, np.asarray(x), values)[:, 1:] for t in times])


def flow_derivative(system, parameters, x, duration):
    """Derivative of the flow from t = 0 at a constant solution, shape (n, n).

    Gauss's method of order 40 on three panels: over one turn its error is far below rounding.
    """
    nodes, weights, integrals = gauss()
    n, h = len(x), duration / PANELS
    result = np.eye(n)
    times = h * (np.arange(PANELS)[:, None] + nodes)
    slopes = jacobians(system, parameters, times.ravel(), x).reshape(PANELS, STAGES, n, n)
    for along in slopes:
        matrix = np.eye(STAGES * n) - h * np.einsum("ij,ikl->ikjl", integrals, along).reshape(STAGES * n, -1)
        rates = np.linalg.solve(matrix, (along @ result).reshape(-1, n)).reshape(STAGES, n, n)
        result = result + h * np.einsum("i,ikl->kl", weights, rates)
    return result


def image_derivative(system, name, parameters):
    """The matrix of a linear symmetry."""
    (symmetry,) = [s for s in system.symmetries if s.name == name]
    columns = []
    for x in np.eye(len(system.states)):
        image = np.full(len(x), np.nan)
        symmetry.map(0.0, x, SimpleNamespace(**parameters), image)
        columns.append(image)
    return np.column_stack(columns)


def half_turn_map(system, parameters, x):
    """S times the derivative of the flow over half a turn, whose square is that over a whole turn."""
    half = 0.5 * system.period(SimpleNamespace(**parameters))
    return image_derivative(system, "half_turn", parameters) @ flow_derivative(system, parameters, x, half)
