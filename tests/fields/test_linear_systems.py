"""`numpy.linalg` of two to thirty rows: solutions, exact derivatives, singular matrices, counted work."""

from __future__ import annotations

import inspect
import math
import sys

import mpmath
import numpy as np
import pytest
from traced_kernels import bounds_of, derivative_of, kernel_of, program_of

from contwalk.fields.blame import first_not_finite
from contwalk.fields.derivative import ancestors, jacobian
from contwalk.fields.elimination import eliminated, eliminated_symmetric, solved
from contwalk.fields.kernel import Kernel
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import trace
from contwalk.flow.compiled.field import Field

SIZES = (2, 3, 4, 5, 8, 13, 30)
EPS = sys.float_info.epsilon


def entry(i, j, s):
    """Of a matrix without zeros."""
    return np.cos((1.0 + 0.37 * i) * (j + 2.0) + s[(i + j) % 3]) * (1.0 + s[i % 3] * s[j % 3])


def definite(n, s):
    """Symmetric and positive definite: the diagonal outweighs the rest."""
    a = np.empty((n, n), dtype=object)
    for i in range(n):
        for j in range(n):
            a[i, j] = entry(min(i, j), max(i, j), s) / n + (3.0 if i == j else 0.0)
    return a


def general(n, s):
    """The largest entries stand beside the diagonal, whose first is zero: exchanges are needed."""
    a = np.empty((n, n), dtype=object)
    for i in range(n):
        for j in range(n):
            a[i, j] = entry(i, j, s) / n + (3.0 if (i + 1) % n == j else 0.0)
    a[0, 0] = 0.0
    return a


def constrained(n, s):
    """Masses and forces of constraint, (M, J^T; J, 0): symmetric and indefinite."""
    a, rows = definite(n, s), max(1, n // 3)
    for i in range(rows):
        for j in range(n):
            if j >= n - rows:
                a[n - 1 - i, j] = a[j, n - 1 - i] = 0.0
            elif i == j:
                a[n - 1 - i, j] = a[j, n - 1 - i] = 1.0 + s[0]
    return a


MATRICES = {"definite": definite, "general": general, "constrained": constrained}


def right(n, s):
    return [np.sin(1.0 + i * s[i % 3]) for i in range(n)]


def equations(kind, n):
    return lambda s: np.linalg.solve(MATRICES[kind](n, s), np.array(right(n, s), dtype=object))


POINT = (0.3, 0.7, -0.2)


def in_digits(kind, n, s):
    """Matrix and right-hand side in mpmath's numbers."""
    cos, sin = np.cos, np.sin
    try:
        np.cos, np.sin = mpmath.cos, mpmath.sin
        return MATRICES[kind](n, s), np.array(right(n, s), dtype=object)
    finally:
        np.cos, np.sin = cos, sin


def in_floats(function, x):
    """NumPy's own value: of arrays of floats, whatever type the arrays here have."""
    own = {name: getattr(np.linalg, name) for name in ("solve", "inv")}
    try:
        for name, each in own.items():
            setattr(np.linalg, name, lambda *a, each=each: each(*(np.asarray(v, dtype=float) for v in a)))
        return np.ravel(function(np.array(x))).astype(float)
    finally:
        for name, each in own.items():
            setattr(np.linalg, name, each)


def point_in_digits(moved=None, step=0):
    return [mpmath.mpf(v) + step * (i == moved) for i, v in enumerate(POINT)]


@pytest.mark.drawn(8)
@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("kind", MATRICES)
def test_solutions_solve_the_equations(kind, n):
    """In forty digits what is missed is rounding. In floats conditions are below 100, and 1e-13 leaves room.

    Machine code agrees with the generated Python to the last bit.
    """
    program = program_of(equations(kind, n), 3)
    kernel = Kernel(program, ("u",))
    field = Field(program, [("u", i) for i in range(3)], {}, outputs=n, differentiable=False)
    with mpmath.workdps(40):
        a, b = in_digits(kind, n, point_in_digits())
        exact = kernel.exactly(point_in_digits())
        assert max(abs(a @ exact - b)) < mpmath.mpf(10) ** -36
    found = kernel(list(POINT))
    np.testing.assert_allclose(found, [float(v) for v in exact], rtol=1e-13, atol=1e-13)
    assert np.array_equal(field(0.0, POINT, field.constants([])), found)


@pytest.mark.drawn(5)
@pytest.mark.parametrize("n", [2, 4, 5, 30])
@pytest.mark.parametrize("kind", MATRICES)
def test_jacobians_are_exact(kind, n):
    """A x' = b' - A' x, with A' and b' by central differences in 45 digits: a step of 1e-15 leaves 1e-28."""
    program = program_of(equations(kind, n), 3)
    graph = program.graph
    rows = jacobian(graph, program.tree.nodes, [graph.input("u", i) for i in range(3)])
    entries = [row.get(k, graph.zero) for row in rows for k in range(3)]
    kernel = Kernel(program.transformed(lambda o: entries), ("u",))
    with mpmath.workdps(45):
        step = mpmath.mpf(10) ** -15
        a, _ = in_digits(kind, n, point_in_digits())
        x = Kernel(program, ("u",)).exactly(point_in_digits())
        slopes = np.reshape(kernel.exactly(point_in_digits()), (n, 3))
        for k in range(3):
            (above, b), (below, c) = (in_digits(kind, n, point_in_digits(k, way * step)) for way in (1, -1))
            rates = (b - c) / (2 * step) - (above - below) / (2 * step) @ x
            assert max(abs(a @ slopes[:, k] - rates)) < mpmath.mpf(10) ** -25
    field = Field(program, [("u", i) for i in range(3)], {}, outputs=n)
    whole = field.jacobian(0.0, POINT, field.constants([]))
    assert np.array_equal(whole, kernel(list(POINT)).reshape(n, 3))


def test_second_derivatives_are_exact():
    """Against 60-digit differences of the program itself, for the loops of six rows."""
    kernel = kernel_of(equations("general", 6), 3)
    for orders in ((0, 0), (0, 2), (1, 2)):
        second = derivative_of(equations("general", 6), 3, orders)
        with mpmath.workdps(60):
            at = tuple(mpmath.mpf(v) for v in POINT)
            counts = tuple(orders.count(i) for i in range(3))
            truth = mpmath.diff(lambda *x: kernel.exactly(list(x))[4], at, counts)
            assert abs(second.exactly(at)[4] - truth) < 1e-15 * max(1, abs(truth))


@pytest.mark.parametrize("n", [2, 5, 13])
@pytest.mark.parametrize("kind", MATRICES)
def test_rounding_bounds_hold(kind, n):
    """What floats miss by is within the bound, and the bound is no more than 1e4 units."""
    kernel = kernel_of(equations(kind, n), 3)
    with mpmath.workdps(40):
        missed = [
            abs(float(v - mpmath.mpf(w)))
            for v, w in zip(kernel.exactly(point_in_digits()), kernel(list(POINT)), strict=True)
        ]
    bounds = bounds_of(equations(kind, n), 3)(list(POINT))
    assert (np.array(missed) <= bounds * EPS).all()
    assert max(bounds) < 1e4


# -- singular matrices ---------------------------------------------------------------------------------------


def nearly(size):
    """[[1, 2], [2, 4 + d]] bordered by ones, up to `size` rows: singular at d = 0."""

    def function(x):
        a = np.array(np.eye(size), dtype=object)
        a[:2, :2] = [[1.0, 2.0], [2.0, 4.0 + x[0]]]
        for i in range(2, size):
            a[0, i] = a[i, 0] = 0.1 * x[1] * 0.1 * i
        return np.linalg.solve(a, np.ones(size))

    return function


@pytest.mark.parametrize("size", [2, 5, 9])
def test_a_singular_matrix_has_no_solution(size):
    """Neither has one that is singular to rounding, where NumPy gives 4.5e15; a condition of 1e12 has one."""
    kernel = kernel_of(nearly(size), 2)
    field = Field(program_of(nearly(size), 2), [("u", 0), ("u", 1)], {}, outputs=size)
    for difference in (0.0, 4.0 * EPS):
        assert np.isnan(kernel([difference, 0.0])).all()
        assert np.isnan(field(0.0, [difference, 0.0], field.constants([]))[:2]).all()
    assert np.isfinite(kernel([1e-12, 0.0])).all()
    assert np.isfinite(field(0.0, [1e-12, 0.0], field.constants([]))).all()


def test_units_do_not_make_a_matrix_singular():
    """Rows in micrometres and columns in meganewtons: diag(r) A diag(c) is as regular as A."""

    def scaled(x):
        a = definite(6, [0.1, 0.2, 0.3])
        r, c = 10.0 ** np.array([0, -12, 6, 12, -6, 3]), 10.0 ** np.array([9, 0, -9, 3, -3, 0])
        return np.linalg.solve(x[0] * r[:, None] * a * c, np.ones(6))

    assert np.isfinite(kernel_of(scaled, 1)([1.0])).all()


def test_a_singular_matrix_is_named_with_its_line():
    def field(t, x, p, dx):
        mass = np.array([[1.0, x[0]], [x[0], 1.0]])
        dx[:] = np.linalg.solve(mass, np.ones(2))

    lines, first = inspect.getsourcelines(field)
    message = first_not_finite(field, 0.0, [1.0, 0.0], {})
    assert f"{__file__}, line {first + len(lines) - 1}: " in message
    assert "the matrix of 2 rows is singular" in message
    assert first_not_finite(field, 0.0, [0.5, 0.0], {}) is None


# -- the work ------------------------------------------------------------------------------------------------


class Counted(float):
    """A float that counts its products and quotients."""

    made = 0

    def _counted(self, value):
        Counted.made += 1
        return Counted(value)

    def __mul__(self, other):
        return self._counted(float(self) * float(other))

    def __truediv__(self, other):
        return self._counted(float(self) / float(other))

    def __sub__(self, other):
        return Counted(float(self) - float(other))


def counted(function, *arguments):
    Counted.made = 0
    return function(*arguments), Counted.made


@pytest.mark.parametrize("n", [5, 10, 30])
def test_products_that_elimination_takes(n):
    """n^3 / 3 for any matrix, half of it for a definite one, n^2 a solution, but for lower powers of n."""
    entries = [Counted(v) for v in definite(n, POINT).astype(float).ravel()]
    factor, general_ = counted(eliminated, entries, EPS)
    _, symmetric = counted(eliminated_symmetric, entries, EPS)
    _, solution = counted(solved, factor, [Counted(1.0)] * n)
    assert general_ <= n**3 / 3 + 2 * n**2
    assert symmetric <= n**3 / 6 + 2 * n**2
    assert solution == n**2


def test_a_jacobian_eliminates_once():
    """Nine columns of a Jacobian: one elimination, a solution for the value and one for each column."""
    program = program_of(lambda x: np.linalg.solve(definite(9, x[:3]), x), 9)
    graph = program.graph
    rows = jacobian(graph, program.tree.nodes, [graph.input("u", i) for i in range(9)])
    kinds = [graph.nodes[node][0] for node in ancestors(graph, [d for row in rows for d in row.values()])]
    assert kinds.count("factor_symmetric") == 1
    assert kinds.count("solved") == 10


def test_a_matrix_of_parameters_is_eliminated_with_them():
    """A constant mass matrix costs no elimination for each right-hand side."""
    chain = rebound(lambda x, p: np.linalg.solve(definite(6, p), x))

    def results(tracer):
        x, p = (
            np.array([tracer.symbol(g, i) for i in range(n)], dtype=object) for g, n in (("u", 6), ("p", 3))
        )
        return chain(x, p)

    field = Field(trace(results), [("u", i) for i in range(6)], {"p": 3})
    assert "contwalk_solved" in field.rhs_text
    assert "contwalk_factor" not in field.rhs_text
    assert "contwalk_factor" not in field.rhs_jac_text
    found = field(0.0, np.arange(6.0), field.constants(list(POINT)))
    expected = np.linalg.solve(definite(6, POINT).astype(float), np.arange(6.0))
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_independent_blocks_are_solved_each_for_itself():
    """Three bodies without joints: three systems of two, one division each for the rest."""

    def bodies(x):
        a = np.zeros((9, 9), dtype=object)
        for body in range(3):
            i = 3 * body
            a[i : i + 2, i : i + 2] = [[2.0, x[0]], [x[0], 3.0 + body]]
            a[i + 2, i + 2] = 1.0 + x[1] ** 2
        return np.linalg.solve(a[[3, 0, 1, 2, 4, 8, 7, 6, 5]], np.arange(9.0))

    program = program_of(bodies, 2)
    kinds = [program.graph.nodes[node] for node in ancestors(program.graph, program.tree.nodes)]
    assert sorted(len(key) for key in kinds if key[0] == "factor") == [5, 5, 5]
    np.testing.assert_allclose(kernel_of(bodies, 2)([0.4, 0.2]), in_floats(bodies, [0.4, 0.2]), rtol=1e-14)


# -- inverses and determinants -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "function",
    [
        lambda x: np.linalg.inv(definite(5, x)) @ np.ones(5),
        lambda x: np.ones(5) @ np.linalg.inv(definite(5, x)),
        lambda x: np.dot(np.linalg.inv(definite(5, x)), np.ones(5)),
        lambda x: (np.ones((2, 5)) @ np.linalg.inv(definite(5, x)) @ np.ones((5, 2))).ravel(),
        lambda x: (2.0 * np.linalg.inv(definite(5, x)) - np.linalg.inv(definite(5, x)).T).ravel(),
        lambda x: np.linalg.inv(definite(5, x))[1:3, 2] * x[0],
        lambda x: np.concatenate([np.linalg.inv(definite(5, x)), np.ones((1, 5))]).ravel(),
        lambda x: (np.linalg.inv(definite(5, x)) @ np.linalg.inv(general(5, x))).ravel(),
        lambda x: [sum(row[0] for row in np.linalg.inv(definite(5, x)))],
        lambda x: np.linalg.inv(definite(5, x)).dot(np.ones(5)) + np.linalg.inv(definite(5, x)).sum(),
    ],
)
def test_inverses_are_arrays(function):
    np.testing.assert_allclose(
        kernel_of(function, 3)(list(POINT)), in_floats(function, POINT), rtol=1e-12, atol=1e-13
    )


def test_an_inverse_times_a_vector_is_one_solution():
    program = program_of(lambda x: np.linalg.inv(definite(7, x)) @ right(7, x), 3)
    kinds = [program.graph.nodes[node][0] for node in ancestors(program.graph, program.tree.nodes)]
    assert kinds.count("solved") == 1


@pytest.mark.drawn(5)
@pytest.mark.parametrize("n", [2, 8, 9, 20])
@pytest.mark.parametrize("kind", MATRICES)
def test_determinants(kind, n):
    function = lambda x: np.linalg.det(MATRICES[kind](n, x))  # noqa: E731
    expected = np.linalg.det(MATRICES[kind](n, POINT).astype(float))
    kernel = kernel_of(function, 3)
    field = Field(program_of(function, 3), [("u", i) for i in range(3)], {}, outputs=1)
    assert kernel(list(POINT))[0] == pytest.approx(expected, rel=1e-12)
    assert field(0.0, POINT, field.constants([]))[0] == kernel(list(POINT))[0]
    slope = derivative_of(function, 3, (1,))
    with mpmath.workdps(60):
        at = tuple(mpmath.mpf(v) for v in POINT)
        truth = mpmath.diff(lambda *x: kernel.exactly(list(x))[0], at, (0, 1, 0))
        assert abs(slope.exactly(at)[0] - truth) <= 1e-15 * max(1, abs(truth))
        missed = abs(float(kernel.exactly(at)[0] - mpmath.mpf(kernel(list(POINT))[0])))
    assert missed <= bounds_of(function, 3)(list(POINT))[0] * EPS


def test_banded_determinants_exist_where_they_are_zero():
    """Twelve rows, few entries: by minors. det(x I - L) of a chain is zero at each of its eigenvalues."""

    def chain(x):
        a = np.zeros((12, 12), dtype=object)
        for i in range(12):
            a[i, i] = x[0]
            if i:
                a[i, i - 1] = a[i - 1, i] = -1.0
        return np.linalg.det(a)

    eigenvalue = 2.0 * math.cos(math.pi * 3 / 13)
    assert abs(kernel_of(chain, 1)([eigenvalue])[0]) < 1e-13  # the largest term is 2^12
    angle = math.pi * 3 / 13  # U_12(cos a)', of Chebyshev's polynomial sin(13 a) / sin(a), at its zero
    slope = -13.0 * math.cos(13 * angle) / (2.0 * math.sin(angle) ** 2)
    assert derivative_of(chain, 1, (0,))([eigenvalue])[0] == pytest.approx(slope, rel=1e-12)


def test_a_determinant_of_many_full_rows_has_no_slope_where_it_is_zero():
    """It is zero there; that its slope is not known is NaN, and not a wrong number."""
    function = lambda x: np.linalg.det(definite(10, POINT) * np.append(np.ones(9), x[0]))  # noqa: E731
    assert kernel_of(function, 1)([0.0])[0] == 0.0
    assert math.isnan(derivative_of(function, 1, (0,))([0.0])[0])
