"""`numpy.linalg`, tables and other functions of arrays: NumPy's values, and exact derivatives."""

from __future__ import annotations

import cmath
import itertools
import math

import mpmath
import numpy as np
import pytest
from numpy.linalg import inv, solve
from scipy import linalg, special
from scipy.interpolate import (
    Akima1DInterpolator,
    CubicSpline,
    PchipInterpolator,
    UnivariateSpline,
    make_interp_spline,
)
from traced_kernels import derivative_of, kernel_of, program_of

from contwalk.flow.compiled.field import Field

SPLINE = CubicSpline([-1.5, 0.0, 0.5, 2.0, 3.0], [0.0, 1.0, -1.0, 0.25, 5.0])
PERIODIC = CubicSpline([0.0, 0.4, 1.0, 1.6], [1.0, 2.0, -1.0, 1.0], bc_type="periodic")
PCHIP = PchipInterpolator([-1.0, 0.0, 1.0, 2.0], [0.0, 1.0, 1.5, 4.0])
AKIMA = Akima1DInterpolator([-1.0, 0.0, 0.2, 0.9, 2.0], [0.0, 1.0, 1.5, 4.0, 2.0])
B_SPLINE = make_interp_spline([-1.0, 0.0, 1.0, 2.0], [0.0, 1.0, 1.5, 4.0])
SMOOTHED = UnivariateSpline(np.linspace(-1.0, 3.0, 9), np.linspace(-1.0, 3.0, 9) ** 3, s=0.1)
SEVERAL = CubicSpline([0.0, 1.0, 2.0, 3.0], np.arange(12.0).reshape(4, 3) ** 2)
SPLINES = {"one": SPLINE}


class Curve:
    """A plugin's object that keeps a spline."""

    def __init__(self):
        self.spline = SPLINE

    def force(self, x):
        return self.spline(x[0]) * x[1]

    def __call__(self, x):
        return self.force(x) + self.power(x[2])

    def power(self, v):
        return np.cosh(v) + np.arctan2(v, 2.0)


class Steeper(Curve):
    """Its method calls that of its parent class, which knows nothing of stand-ins."""

    def power(self, v):
        return 2.0 * super().power(v) + np.arcsinh(v)

    def force(self, x):
        return self.power(x[0])


CURVE = Curve()
TABLE = ([-1.0, 0.0, 0.5, 2.0, 3.0], [0.0, 1.0, -1.0, 0.25, 5.0])


def matrix(x):
    """Which of its entries are the largest changes with x; the first is zero at x[0] = 0."""
    return np.array([[x[0], x[1], 0.3], [x[2] + 1.0, 3.0 * x[0], x[0]], [0.1, x[1] ** 2, math.cos(x[2])]])


def large(x):
    return np.array(
        [[math.cos((i + 1) * (j + 2) * x[0]) + x[1] * (i == j) for j in range(6)] for i in range(6)]
    )


FUNCTIONS = {
    "solve": lambda x: np.linalg.solve(matrix(x), x),
    "solve, columns": lambda x: solve(matrix(x), np.array([[1.0, x[0]], [0.0, x[1]], [2.0, 1.0]])).ravel(),
    "solve, numbers on one side": lambda x: np.linalg.solve(np.array([[0.0, 2.0], [1.0, 1.0]]), x[:2]),
    "solve, six equations": lambda x: np.linalg.solve(large(x), np.arange(6.0)),
    "solve, several": lambda x: solve(
        np.array([matrix(x), large(x)[:3, :3]]), np.array([x, 2.0 * x]).reshape(2, 3, 1)
    ).ravel(),
    "inv and det of several": lambda x: np.append(
        inv(np.array([matrix(x), large(x)[:3, :3]])).ravel(),
        np.linalg.det(np.array([matrix(x), large(x)[:3, :3]])),
    ),
    "inv": lambda x: inv(matrix(x)).ravel(),
    "det": lambda x: np.linalg.det(matrix(x)),
    "det, six rows": lambda x: np.linalg.det(large(x)),
    "norm": lambda x: np.linalg.norm(x),
    "cross": lambda x: np.cross(x, [1.0, x[0], 2.0]),
    "interp": lambda x: np.interp(x[0] + x[1], *TABLE),
    "interp, two points": lambda x: np.interp(x[0], [0.0, 1.0], [1.0, 3.0]),
    "interp, values that are parameters": lambda x: np.interp(
        x[0], TABLE[0], [x[1], x[2], 1.0, x[1] ** 2, 0.0]
    ),
    "interp of an array": lambda x: np.interp(x, *TABLE, left=-7.0, right=7.0),
    "interp, periodic": lambda x: np.interp(5.0 * x[0], [0.2, 1.0, 0.7], [1.0, 2.0, x[1]], period=1.25),
    "clip": lambda x: np.clip(x, -0.2, 0.9) + np.clip(x[0], None, 0.1),
    "heaviside": lambda x: np.heaviside(x[0], 0.5) * x[1],
    "ceil": lambda x: math.ceil(x[0]) * x[1] + np.ceil(x[2]),
    "ufuncs of arithmetic": lambda x: np.multiply(np.add(x[0], x[1]), np.square(np.subtract(x[2], x[0]))),
    "remainder": lambda x: np.mod(x[0], 0.41) + np.floor_divide(x[1], 0.37),
    "from numpy": lambda x: float(np.float64(x[0])) + np.vdot(x, x) + np.std(x),
    "sinc": lambda x: np.sinc([x[0], x[1] * x[2], 0.01 * x[0]]),
    "complex": lambda x: (
        abs(np.exp(1j * x[0]) * x[1] + 2.0) + (x[0] + 1j * x[1]).real * complex(x[2], x[0]).imag
    ),
    "complex arrays": lambda x: np.imag(np.exp(1j * x[:3]) / (1.0 + 2j)) + np.angle(1.0 + 1j * x),
    "complex functions": lambda x: [
        v
        for f in (
            np.sin,
            np.cos,
            np.tan,
            np.sinh,
            np.cosh,
            np.tanh,
            np.exp,
            np.log,
            np.sqrt,
            cmath.exp,
            cmath.phase,
        )
        for v in (f(x[0] + 1j * x[1] + 0.3).real, f(x[0] - 1j * x[1] + 0.3).imag)
    ],
    "complex powers": lambda x: [
        ((x[0] + 1j * x[1]) ** 3).real + ((1.0 + 1j * x[1]) ** x[0]).imag,
        ((x[0] + 1j * x[1]) ** -2).imag + cmath.polar(x[0] + 1j * x[1])[0],
        (cmath.rect(x[0], x[1]) * np.conj(x[2] + 1j)).imag + 0.0 * ((x[0] + 0j) == 1j),
    ],
    "a quotient of impedances": lambda x: abs((1.0 + 1j * x[0]) / (x[1] - x[0] ** 2 + 0.1j * x[0])),
    "solve, as SciPy calls it": lambda x: (
        linalg.solve(matrix(x), x, assume_a="gen") + linalg.inv(matrix(x)) @ x
    ),
    "cubic spline": lambda x: SPLINE(x[0] + x[1]) + SPLINE(x[0], 1) * SPLINE.derivative(2)(x[2]),
    "periodic spline": lambda x: PERIODIC([x[0], 3.0 * x[1]]),
    "splines of other kinds": lambda x: PCHIP(x[0]) + B_SPLINE(x[1]) + SMOOTHED(x[2]) + AKIMA(x[1]),
    "spline of several values": lambda x: SEVERAL(x[0]) * SPLINES["one"](x[1]),
    "from an object": CURVE.force,
    "from an object that is called": CURVE,
    "from a class's parent": Steeper().force,
    "exponentials": lambda x: (
        np.exp2(x[0]) + np.logaddexp(x[0], x[1]) + np.fmax(x[1], x[2]) * np.fmin(x[0], x[2])
    ),
    "scipy": lambda x: (
        special.erf(x[0]) + special.expit(x[1]) + special.gamma(x[2] + 3.0) + special.psi(x[0] + 4.0)
    ),
}
POINTS = ((0.0, 0.7, 0.2), (0.3, 0.7, 0.2), (-1.3, 0.4, 0.9), (2.1, -0.6, -0.35), (4.0, 0.11, 0.23))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_values_are_numpys(name):
    """To some units of rounding of solutions of well-conditioned systems: 1e-12 covers all points."""
    function = FUNCTIONS[name]
    program = program_of(function, 3)
    outputs = len(program.leaves()[0].nodes)
    field = Field(program, [("u", i) for i in range(3)], {}, outputs=outputs)
    kernel, c = kernel_of(function, 3), field.constants([])
    for point in POINTS:
        expected = np.ravel(function(np.array(point)))
        with mpmath.workdps(30):
            exact = [float(v) for v in kernel.exactly([mpmath.mpf(v) for v in point])]
        for found in (kernel(list(point)), field(0.0, point, c), exact):
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    "name", [n for n in FUNCTIONS if n not in ("scipy", "solve, six equations", "det, six rows")]
)
def test_derivatives_three_orders_deep(name):
    """Against differences of the function itself with 60 digits, away from kinks: good to 15 digits."""
    function, point = FUNCTIONS[name], POINTS[1]
    kernel = kernel_of(function, 3)
    for orders in itertools.chain.from_iterable(
        itertools.combinations_with_replacement(range(3), order) for order in (1, 2, 3)
    ):
        counts = tuple(orders.count(i) for i in range(3))
        derivative = derivative_of(function, 3, orders)
        with mpmath.workdps(60):
            at = tuple(mpmath.mpf(v) for v in point)
            exact = derivative.exactly(at)
            for k in {0, len(exact) - 1}:
                truth = mpmath.diff(lambda *x, k=k: kernel.exactly(list(x))[k], at, counts)
                assert abs(exact[k] - truth) <= 1e-15 * max(1, abs(truth)), (orders, k)
        assert derivative(list(point))[0] == pytest.approx(float(exact[0]), rel=1e-9, abs=1e-9)


def test_singular_systems():
    """A determinant is zero with its derivative; a solution does not exist."""
    singular = np.array([[1.0, 2.0], [2.0, 4.0]])
    assert kernel_of(lambda x: np.linalg.det(singular * x[0]), 1)([1.0])[0] == 0.0
    slope = derivative_of(lambda x: np.linalg.det(np.array([[x[0], 2.0], [2.0, 4.0]])), 1, (0,))
    assert slope([1.0])[0] == 4.0
    assert math.isnan(kernel_of(lambda x: np.linalg.solve(singular * x[0], np.ones(2))[0], 1)([1.0])[0])


def test_systems_make_no_paths():
    assert len(program_of(FUNCTIONS["solve, six equations"], 3).leaves()) == 1


def test_long_tables():
    """A thousand points, as measured data have: a tree of choices that is ten deep."""
    places = np.linspace(0.0, 10.0, 1000)
    kernel = kernel_of(lambda x: np.interp(x[0], places, np.sin(places)), 1)
    for x in (0.0, 0.001, 3.21, 9.999, 10.0, 11.0, -1.0):
        assert kernel([x])[0] == pytest.approx(np.interp(x, places, np.sin(places)), rel=1e-12, abs=1e-13)
