"""Kernels: shapes, sparsity, complex directions, and digits."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from small_systems import small_system
from traced_kernels import kernel_of, program_of

from contwalk.fields import kernel as kernel_module
from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.kernel import Kernel
from contwalk.problems.equilibrium.equations import Equations
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.system import Mode, Parameter, State, System, load_system


def rotation(x):
    return [math.cos(x[0]) * x[1], math.sin(x[0]) * x[1], 4.0]


def test_text_is_straight_line_python():
    text = kernel_of(rotation, 2).text
    assert text.startswith("def evaluate(u):\n")
    assert text.count("cos_(") == text.count("sin_(") == 1


def test_digits_follow_the_working_precision():
    kernel = kernel_of(lambda x: math.exp(x[0]), 1)
    for digits in (20, 60):
        with mpmath.workdps(digits):
            found = kernel.exactly([mpmath.mpf(1)])[0]
            assert abs(found - mpmath.e) < mpmath.mpf(10) ** (1 - digits)


def test_sparse_result_is_put_in_its_places():
    program = program_of(rotation, 2)
    kernel = Kernel(program, ("u",), (2, 4), where=(1, 6, 7))
    found = kernel([0.3, 2.0])
    expected = np.zeros((2, 4))
    expected[0, 1], expected[1, 2], expected[1, 3] = 2 * math.cos(0.3), 2 * math.sin(0.3), 4.0
    assert np.array_equal(found, expected)


def test_jacobian_has_only_entries_that_can_differ_from_zero():
    program = program_of(rotation, 2)
    graph = program.graph
    rows = jacobian(graph, program.tree.nodes, [graph.input("u", 0), graph.input("u", 1)])
    assert [sorted(row) for row in rows] == [[0, 1], [0, 1], []]


def test_complex_direction():
    """A directional derivative is linear in its direction, complex ones included."""
    program = program_of(rotation, 2)
    graph = program.graph
    along = {graph.input("u", i): graph.input("v", i) for i in range(2)}
    kernel = Kernel(program.transformed(lambda o: directional(graph, o, along)), ("u", "v"))
    x, v, w = [0.3, 2.0], np.array([0.7, -0.2]), np.array([0.1, 1.5])
    # linear up to the rounding of a handful of products
    np.testing.assert_allclose(kernel(x, v + 1j * w), kernel(x, v) + 1j * kernel(x, w), rtol=1e-14)


def _stepped(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] if x[0] < p.gap else -x[0] - p.k * (x[0] - p.gap) ** 2


STEPPED = System(
    name="stepped",
    states=(State("x"), State("v")),
    parameters=(Parameter("gap", 0.5), Parameter("k", 10.0)),
    modes=(Mode("smooth", _stepped),),
)


def test_linearization_of_a_field_with_paths():
    equations = Equations(STEPPED, "k")
    for x, slope, by_k in ((0.2, 0.0, 0.0), (0.9, 2 * 10 * 0.4, 0.4**2)):
        table = equations.linearization([x, 0.3], [10.0], [0.5, 10.0], [0.0, 0.0], [])
        expected = [[0.3, 0.0, 1.0, 0.0], [-x - 10 * by_k, -1.0 - slope, 0.0, -by_k]]
        # a square and a product: three roundings
        np.testing.assert_allclose(table, expected, rtol=1e-15, atol=1e-16)


@pytest.fixture(scope="module")
def machine():
    system = load_system("autobalancer", {"masses": 2})
    equations = Equations(system, "m")
    rng = np.random.default_rng(4)
    values = [system.defaults()[name] for name in system.parameter_names]
    inputs = [rng.normal(0.0, 0.3, 8).tolist(), [0.01], values, [0.0] * len(values), []]
    directions = [rng.normal(0.0, 1.0, 9).tolist() for _ in range(3)]
    return equations, inputs, directions


def test_derivatives_of_a_machine_agree_with_differences_in_extended_precision(machine):
    """First, second and third along random directions; 60 digits, steps of 1e-15: more than 25 digits."""
    equations, inputs, (v, w, y) = machine
    with mpmath.workdps(60):
        h = mpmath.mpf("1e-15")
        groups = [[mpmath.mpf(a) for a in group] for group in inputs]

        def moved(direction, step):
            u = [a + step * b for a, b in zip(groups[0], direction[:8], strict=True)]
            return [u, [groups[1][0] + step * direction[8]], *groups[2:]]

        for kernel, below, direction, given in (
            (equations.first, equations.residual, v, []),
            (equations.second, equations.first, w, [v]),
            (equations.third, equations.second, y, [v, w]),
        ):
            plus, minus = (below.exactly(*moved(direction, s), *given) for s in (h, -h))
            expected = [float((a - b) / (2 * h)) for a, b in zip(plus, minus, strict=True)]
            found = kernel(*inputs, *given, direction)
            # the equations cancel by a factor of about a hundred; each derivative has more terms
            np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11 * np.abs(expected).max())


def test_adjoint_is_the_transposed_jacobian(machine):
    equations, inputs, (v, _, _) = machine
    table = equations.linearization(*inputs)[:, 1:]
    psi = v[:8]
    found = equations.adjoint(*inputs, psi)
    np.testing.assert_allclose(found, np.array(psi) @ table, rtol=1e-12, atol=1e-12 * np.abs(found).max())


def test_one_pass_gives_the_equations_their_slopes_and_their_rounding_to_the_same_bits(machine):
    equations, inputs, _ = machine
    table = equations.linearization_and_rounding(*inputs)
    np.testing.assert_array_equal(table[:, :-1], equations.linearization(*inputs))
    np.testing.assert_array_equal(table[:, -1], equations.rounding(*inputs))


def test_equations_have_a_value_where_the_bound_of_their_rounding_has_none():
    """x' = sqrt(a b) - x at a = 0: the root's slope is infinite, by what no unknown is."""

    def field(t, x, p, dx):
        dx[0] = math.sqrt(p.a * p.b) - p.c * x[0]

    at = {"a": 0.0, "b": 2.0, "c": 3.0}
    problem = Equilibrium(small_system(field, ("x",), at), at, "c")
    found = problem.linearize(np.array([0.5, 3.0]))
    assert found.residual.tolist() == [-1.5]
    assert found.jacobian.tolist() == [[-3.0, -0.5]]
    assert found.finite
    assert found.excess == math.inf


def long_sum(x):
    total = x[0]
    for k in range(1, 400):
        total = total + math.sin(k * x[0]) / k
    return total


def test_code_of_long_texts_is_kept_and_a_damaged_file_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    first = kernel_of(long_sum, 1)([0.3])
    (kept,) = (tmp_path / "objects").iterdir()
    counted = []

    def counting(*arguments):
        counted.append(arguments)
        return compile(*arguments)

    monkeypatch.setattr(kernel_module, "compile", counting, raising=False)
    assert kernel_of(long_sum, 1)([0.3]).tobytes() == first.tobytes()
    assert not counted
    content = bytearray(kept.read_bytes())
    content[-7] ^= 1
    kept.write_bytes(bytes(content))
    assert kernel_of(long_sum, 1)([0.3]).tobytes() == first.tobytes()
    assert len(counted) == 1


def test_another_text_has_its_own_code(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    one, other = kernel_of(long_sum, 1), kernel_of(lambda x: 2.0 * long_sum(x), 1)
    assert other([0.3])[0] == 2.0 * one([0.3])[0]
    assert len(list((tmp_path / "objects").iterdir())) == 2
