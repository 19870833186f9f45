"""The running error bounds hold: float evaluation against 50 digits, at seeded random points."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from function_samples import SAMPLES
from traced_kernels import bounds_of, kernel_of

from contwalk.fields.graph import Graph
from contwalk.fields.kernel import Kernel
from contwalk.fields.rounding import size_of
from contwalk.fields.trace import Outputs, Program
from contwalk.problems.equilibrium.equations import Equations
from contwalk.system import load_system

EPSILON = float(np.finfo(float).eps)
# The bounds are of first order in the machine epsilon; what they leave out is a share of 1e-15 of them.
SECOND_ORDER = 1.0 + 1e-12

FORMULAS = {
    "cancellation": (lambda x: (x[0] + x[1]) - x[0], 2),
    "difference of squares": (lambda x: x[0] * x[0] - x[1] * x[1], 2),
    "cosine law": (lambda x: math.sqrt(x[0] ** 2 + x[1] ** 2 - 1.9 * x[0] * x[1] * math.cos(x[2])), 3),
    "polynomial": (lambda x: ((x[0] - 3.0) * x[0] + 3.0) * x[0] - 1.0, 1),
    "near a pole": (lambda x: 1.0 / (x[0] - x[1] * (1.0 + 1e-7)) + math.exp(x[2]), 3),
    "piecewise": (lambda x: max(x[0] * x[1], x[2]) - abs(x[0] - x[2]), 3),
    "large argument": (lambda x: math.sin(1000.0 * x[0] + x[1]), 2),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_bound_holds(name):
    function, size = FORMULAS[name]
    kernel, bounds = kernel_of(function, size), bounds_of(function, size)
    for x in np.random.default_rng(1).uniform(0.5, 2.0, (200, size)).tolist():
        with mpmath.workdps(50):
            exact = kernel.exactly([mpmath.mpf(v) for v in x])[0]
            error = abs(mpmath.mpf(float(kernel(x)[0])) - exact)
        assert error <= SECOND_ORDER * EPSILON * bounds(x)[0]


@pytest.mark.parametrize("name", [n for n in SAMPLES if n not in ("floor", "trunc", "sign", "fmod")])
def test_bound_holds_for_a_function_of_a_rounded_number(name):
    sample = SAMPLES[name]
    plugin, size = sample.plugin, len(sample.points[0])

    def function(x):
        return plugin(*[v * (1.0 / 3.0) * 3.0 for v in x])

    kernel, bounds = kernel_of(function, size), bounds_of(function, size)
    for point in sample.points:
        with mpmath.workdps(50):
            exact = kernel.exactly([mpmath.mpf(v) for v in point])[0]
            error = abs(mpmath.mpf(float(kernel(list(point))[0])) - exact)
        assert error <= SECOND_ORDER * EPSILON * bounds(list(point))[0]


def test_bound_is_not_far_above_the_error():
    """A bound that is always large would hold as well. The worst of 200 points is within a factor of ten."""
    function, size = FORMULAS["difference of squares"]
    kernel, bounds = kernel_of(function, size), bounds_of(function, size)
    ratios = []
    for x in np.random.default_rng(2).uniform(0.5, 2.0, (200, size)).tolist():
        with mpmath.workdps(50):
            exact = kernel.exactly([mpmath.mpf(v) for v in x])[0]
            error = float(abs(mpmath.mpf(float(kernel(x)[0])) - exact))
        ratios.append(error / (EPSILON * bounds(x)[0]))
    assert max(ratios) > 0.1


def test_inputs_are_exact():
    assert bounds_of(lambda x: [x[0], -x[0], abs(x[0]), 3.0], 1)([0.7]).tolist() == [0.0, 0.0, 0.0, 0.0]


def machine_inputs(equations, arithmetic, x):
    """Arguments of the kernels of a machine at a state."""
    system = equations.system
    values = [system.defaults()[name] for name in system.parameter_names]
    groups = [x, [0.01], values, [0.0] * len(values), []]
    return [[arithmetic(v) for v in group] for group in groups]


@pytest.mark.parametrize("masses", [1, 3])
def test_bound_holds_for_the_equations_of_a_machine(masses):
    system = load_system("autobalancer", {"masses": masses})
    equations = Equations(system, "m")
    for x in np.random.default_rng(3).normal(0.0, 0.5, (30, len(system.states))).tolist():
        found = equations.residual(*machine_inputs(equations, float, x))
        bounds = equations.rounding(*machine_inputs(equations, float, x))
        with mpmath.workdps(50):
            exact = equations.residual.exactly(*machine_inputs(equations, mpmath.mpf, x))
            errors = [abs(mpmath.mpf(float(a)) - b) for a, b in zip(found, exact, strict=True)]
        for error, bound in zip(errors, bounds, strict=True):
            assert error <= SECOND_ORDER * EPSILON * bound


def test_sizes_are_those_of_abs_to_the_bit_and_cost_no_more():
    rng = np.random.default_rng(3)
    graph = Graph()
    a, b = graph.input("u", 0), graph.input("u", 1)
    nodes = [graph.mul(a, a), graph.neg(graph.div(a, b)), graph.mul(a, b), graph.div(graph.one, b)]
    for known in ((), (a, b)):  # those whose sizes have been written down
        for node in known:
            graph.call("abs", node)
        sizes = [size_of(graph, node) for node in nodes]
        plain = [graph.call("abs", node) for node in nodes]
        kernel = Kernel(Program(graph, Outputs((*sizes, *plain))), ("u",))
        for x in (*rng.normal(size=(50, 2)).tolist(), [-0.0, 3.0], [1e-320, -2.0], [1e200, -1e200]):
            found = kernel(x)
            assert found[:4].tobytes() == found[4:].tobytes()
        assert graph.nodes[sizes[0]][0] == "mul"  # a square needs none
    assert graph.nodes[sizes[2]][0] == "mul"
