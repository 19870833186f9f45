"""Machine code gives what the generated Python gives, to the last bit, and NaN where that gives none."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
from function_samples import SAMPLES
from traced_kernels import program_of

from contwalk.errors import PluginError
from contwalk.fields import llvm
from contwalk.fields.derivative import jacobian
from contwalk.fields.functions import FUNCTIONS
from contwalk.fields.kernel import Kernel
from contwalk.flow import Field
from contwalk.problems.equilibrium.equations import Equations
from contwalk.system import load_system

# Zeros of both signs, poles, ends of domains, overflow.
_EDGES = ((0.0, 0.0), (-0.0, -0.0), (1.0, 0.0), (-1.0, 0.5), (0.0, -1.0), (1000.0, 1000.0), (-1000.5, -0.5))


def compiled(plugin, inputs):
    """A field and a kernel of `plugin(x)`: its results, with zeros up to as many as there are inputs."""

    def filled(x):
        found = plugin(x)
        found = list(found) if hasattr(found, "__len__") else [found]
        return [*found, *[0.0] * (inputs - len(found))]

    program = program_of(filled, inputs)
    field = Field(program, [("u", i) for i in range(inputs)], {})
    return field, Kernel(program, ("u",), (inputs,)), field.constants([])


def bits(array):
    """NaNs are equal whatever their bits, zeros only with their signs."""
    return [None if math.isnan(v) else (v, math.copysign(1.0, v)) for v in array]


def test_there_is_a_sample_for_every_function():
    assert set(SAMPLES) == set(FUNCTIONS)


@pytest.mark.parametrize("name", SAMPLES)
def test_functions_agree_bitwise(name):
    sample = SAMPLES[name]
    width = len(sample.points[0])
    field, kernel, c = compiled(sample.of_array(), width)
    for point in (*sample.points, *(edge[:width] for edge in _EDGES)):
        assert bits(field(0.0, point, c)) == bits(kernel(list(point))), point


@pytest.mark.parametrize("name", sorted(set(SAMPLES) - {"sign", "floor", "trunc", "min", "max"}))
def test_derivatives_agree_bitwise(name):
    sample = SAMPLES[name]
    width = len(sample.points[0])
    field, _, c = compiled(sample.of_array(), width)
    program = program_of(sample.of_array(), width)
    graph = program.graph
    row = jacobian(graph, program.tree.nodes, [graph.input("u", i) for i in range(width)])[0]
    kernel = Kernel(program.transformed(lambda o: [row.get(k, graph.zero) for k in range(width)]), ("u",))
    for point in sample.points:
        assert np.array_equal(field.jacobian(0.0, point, c)[0], kernel(list(point))), point


@pytest.mark.parametrize("plugin", [lambda x: min(x[0], x[1]), lambda x: max(x[0], x[1])])
def test_extremes_agree_bitwise(plugin):
    """Called by name, `min` and `max` are functions and not comparisons; ties go to the first argument."""
    field, kernel, c = compiled(plugin, 2)
    for point in (*_EDGES, (0.0, -0.0), (-0.0, 0.0), (2.0, 3.0), (3.0, 2.0)):
        assert bits(field(0.0, point, c)) == bits(kernel(list(point))), point
    slopes = field.jacobian(0.0, [2.0, 3.0], c)[0], field.jacobian(0.0, [3.0, 2.0], c)[0]
    assert sorted(slope.tolist() for slope in slopes) == [[0.0, 1.0], [1.0, 0.0]]


@pytest.mark.parametrize("masses", [1, 2, 3])
def test_a_machine_agrees_bitwise(masses):
    system = load_system("autobalancer", {"masses": masses})
    equations = Equations(system, "m")
    rng = np.random.default_rng(masses)
    n = len(system.states)
    b = [system.defaults()[name] for name in system.parameter_names]
    states = [("u", i) for i in range(n)]
    field = Field(equations.program, states, {"l": 1, "b": len(b)}, columns=[("l", 0)])
    for _ in range(5):
        x, m = rng.normal(0.0, 1.0, n), rng.uniform(0.001, 0.1)
        c = field.constants([m, *b])
        table = equations.linearization(x, [m], b, [], [])
        assert np.array_equal(field(0.0, x, c), table[:, 0])
        assert np.array_equal(field.jacobian(0.0, x, c), table[:, 1:])


# -- branches ------------------------------------------------------------------------------------------------


def forked(x):
    shared = math.exp(x[0]) * x[1]
    if x[0] < x[1]:
        if x[1] < 2.0:
            return [shared, shared + x[0]]
        return [shared * 2.0, math.sqrt(x[1])]
    return [x[0], shared - 1.0]


def chosen(x):
    first = np.where((x[0] > 0.0) & (x[1] > 0.0), np.log(np.where(x[0] > 0.0, x[0], 1.0)) * x[1], -x[0])
    return [first, np.where((x[0] < 0.0) | ~(x[1] < 1.0), x[1], 3.0)]


@pytest.mark.parametrize("plugin", [forked, chosen])
def test_branches_agree_bitwise(plugin):
    field, kernel, c = compiled(plugin, 2)
    grid = (-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0)
    for x in ((a, b) for a in grid for b in grid):
        assert bits(field(0.0, x, c)) == bits(kernel(list(x))), x


def test_the_side_of_a_choice_that_is_not_taken_may_be_undefined():
    field, _, c = compiled(lambda x: np.where(x[0] > 0.0, 1.0 / x[0], 7.0), 1)
    assert field(0.0, [0.0], c) == [7.0]
    assert field(0.0, [4.0], c) == [0.25]


def test_the_path_on_which_the_plugin_raises_is_nan():
    def picky(x):
        if x[0] > 1.0:
            raise RuntimeError("too far")
        return [x[0], 2.0 * x[1]]

    field, kernel, c = compiled(picky, 2)
    assert field(0.0, [0.5, 1.0], c).tolist() == [0.5, 2.0]
    assert np.isnan(field(0.0, [2.0, 1.0], c)).all()
    with pytest.raises(PluginError):
        kernel([2.0, 1.0])


def test_a_condition_on_nan_has_no_outcome():
    """The square root of -1 is neither below nor above 1: both sides of `if` or `where` would be wrong."""

    def fork(x):
        return [1.0] if math.sqrt(x[0]) < 1.0 else [2.0]

    for plugin in (
        fork,
        lambda x: np.where(np.sqrt(x[0]) < 1.0, 1.0, 2.0),
        lambda x: max(math.sqrt(x[0]), 0.0),
    ):
        field, _, c = compiled(plugin, 1)
        assert np.isnan(field(0.0, [-1.0], c)).all()
        assert np.isfinite(field(0.0, [4.0], c)).all()


def test_infinity_is_not_swallowed():
    """1 / (1 / x) is not 0 at 0, and tanh(exp(1000)) is refused as Python refuses it."""
    for plugin, x in ((lambda x: 1.0 / (1.0 / x[0]), 0.0), (lambda x: math.tanh(math.exp(x[0])), 1000.0)):
        field, kernel, c = compiled(plugin, 1)
        assert np.isnan(field(0.0, [x], c)).all()
        assert np.isnan(kernel([x])).all()


def test_many_paths_share_what_they_have_in_common():
    """Sixty-four paths, each with the same long expression: the code must not hold it sixty-four times."""

    def signs(x):
        total = sum((math.sin(x[k % 6] * (k + 1.0)) for k in range(200)), 0.0 * x[0])
        for k in range(6):
            total = total + 1.0 if x[k] > 0.0 else total - 1.0
        return total

    field, kernel, c = compiled(signs, 6)
    rng = np.random.default_rng(8)
    for _ in range(20):
        x = rng.normal(size=6)
        assert field(0.0, x, c)[0] == kernel(x.tolist())[0]
    from contwalk.fields.machine_code import function

    inputs = {field._program.graph.input("u", i): ("x", i) for i in range(6)}
    text, _ = function("rhs", field._program, ("x", "c"), inputs, time=True)
    assert text.count("call double @sin") == 200


def _differences(count):
    """IR of `differences(x, out)`: count steps, each of which pairs of operations can be made of."""
    lines = ["define void @differences(ptr noalias %x, ptr noalias %out) {"]
    for i in range(count):
        lines += [
            f"  %a{i} = getelementptr double, ptr %x, i64 {i}",
            f"  %b{i} = load double, ptr %a{i}",
            f"  %c{i} = fsub double %b{i}, 0.1",
            f"  %d{i} = fmul double %c{i}, %c{i}",
            f"  %e{i} = getelementptr double, ptr %out, i64 {i}",
            f"  store double %d{i}, ptr %e{i}",
        ]
    return "\n".join([*lines, "  ret void", "}", ""])


@pytest.mark.parametrize(("count", "paired"), [(800, True), (900, False)])
def test_very_long_lines_of_operations_are_compiled_without_looking_for_vectors(count, paired):
    """4800 and 5400 operations: both ways give the same bits."""
    text = _differences(count)
    assert ("x double>" in llvm.optimized(text)) == paired
    code = llvm.Code(llvm.compiled(text), ("differences",))
    x, out = np.linspace(0.0, 1.0, count), np.zeros(count)
    code.function("differences", None, ctypes.c_void_p, ctypes.c_void_p)(x.ctypes.data, out.ctypes.data)
    assert np.array_equal(out, (x - 0.1) * (x - 0.1))
