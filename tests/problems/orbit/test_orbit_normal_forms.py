"""Derivatives of the return map against a section map that scipy integrates, and normal forms of known
maps.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_systems import small_system

import contwalk as cw
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit.normal_forms import units
from contwalk.problems.orbit.point_records import criticality_of
from contwalk.problems.orbit.return_map import ReturnMap
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import State


def field(t, x, p, dx):
    """A cycle that is no circle, with two states across it that feed back."""
    s = x[0] ** 2 + x[1] ** 2
    g = p.lam - s + 0.4 * x[2] + 0.3 * x[3] ** 2
    w = 2.0 + 0.3 * x[0] + 0.2 * x[2]
    dx[0] = g * x[0] - w * x[1]
    dx[1] = w * x[0] + g * x[1]
    dx[2] = -0.4 * x[2] + 0.5 * x[3] + 0.2 * x[0] * x[1] + 0.3 * x[2] ** 2
    dx[3] = -0.5 * x[2] - 0.2 * x[3] + 0.4 * x[0] * x[3] - 0.2 * x[3] ** 3


SYSTEM = small_system(field, "xyzw", {"lam": 1.0})
# Differences with steps of 1e-2 to 1e-3 of a map known to 1e-13 give derivatives of order k to 1e-13 / h^k.
TOLERANCE = {1: 1e-8, 2: 1e-6, 3: 1e-4}


@pytest.fixture(scope="module")
def at_orbit():
    """The return map on a converged orbit, in one segment."""
    chosen = cw.Discretization(accuracy=1e-12, segments=1)
    problem = cw.PeriodicOrbit(SYSTEM, SYSTEM.defaults(), "lam", discretization=chosen)
    first = next(
        cw.points(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.5), until="settled", max_points=2)
    ).state.sample
    x, period = first.z[:4], float(first.z[4])
    there, z = orbit_at(
        SYSTEM, ParameterLine.of(SYSTEM, SYSTEM.defaults(), "lam"), None, x, period, discretization=chosen
    )
    for _ in range(5):  # onto this problem's own steps, in its section
        linearization = there.linearize(z)
        z = z.copy()
        z[:-1] -= np.linalg.solve(linearization.jacobian[:, :-1], linearization.residual)
    return ReturnMap(there, z), z


def section_map(map_, z, xi, lam):
    """Coordinates of the first return near the period, by scipy."""
    x0, period = z[:4], float(z[4])
    normal = map_.problem.section.normal
    p = type("P", (), {"lam": lam})

    def right(t, x):
        dx = np.zeros(4)
        field(t, x, p, dx)
        return dx

    def crossing(t, x):
        return float(normal @ (x - x0))

    start = x0 + map_.basis @ xi
    way = solve_ivp(right, (0.0, 0.9 * period), start, method="DOP853", rtol=3e-14, atol=1e-15).y[:, -1]
    crossing.terminal, crossing.direction = True, 1.0
    found = solve_ivp(
        right, (0.9 * period, 1.1 * period), way, method="DOP853", rtol=3e-14, atol=1e-15, events=crossing
    )
    return map_.coordinates @ (found.y_events[0][0] - x0)


def differences(function, h):
    """First three derivatives at 0 by central differences of fourth order or better."""
    f = {k: function(k * h) for k in range(-3, 4)}
    one = (45 * (f[1] - f[-1]) - 9 * (f[2] - f[-2]) + (f[3] - f[-3])) / (60 * h)
    two = (270 * (f[1] + f[-1]) - 27 * (f[2] + f[-2]) + 2 * (f[3] + f[-3]) - 490 * f[0]) / (180 * h**2)
    three = (-13 * (f[1] - f[-1]) + 8 * (f[2] - f[-2]) - (f[3] - f[-3])) / (8 * h**3)
    return one, two, three


def test_the_basis_is_dual_and_lies_in_the_section(at_orbit):
    map_, _ = at_orbit
    np.testing.assert_allclose(map_.coordinates @ map_.basis, np.eye(3), rtol=0, atol=1e-14)
    normal = map_.problem.section.normal
    np.testing.assert_allclose(normal @ map_.basis / np.linalg.norm(normal), 0.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", [0, 1])
def test_derivatives_along_lines(at_orbit, seed):
    map_, z = at_orbit
    direction = np.random.default_rng(seed).standard_normal(3)
    direction /= np.linalg.norm(direction)
    found = map_.curve(direction)
    wanted = differences(lambda s: section_map(map_, z, s * direction, float(z[-1])), 4e-3)
    for k, (a, b) in enumerate(zip(found, wanted, strict=True), start=1):
        np.testing.assert_allclose(a, b, rtol=0, atol=TOLERANCE[k] * max(1.0, float(np.abs(b).max())))
    np.testing.assert_allclose(map_.a @ direction, found[0], rtol=0, atol=1e-11)


def test_derivatives_along_a_bent_curve_with_the_parameter(at_orbit):
    map_, z = at_orbit
    x1, x2 = np.array([0.5, -0.3, 0.4]), np.array([0.2, 0.6, -0.5])
    found = map_.curve(x1, x2, 0.5)
    wanted = differences(
        lambda s: section_map(map_, z, s * x1 + 0.5 * s * s * x2, float(z[-1]) + 0.5 * s), 4e-3
    )
    for k, (a, b) in enumerate(zip(found, wanted, strict=True), start=1):
        np.testing.assert_allclose(a, b, rtol=0, atol=TOLERANCE[k] * max(1.0, float(np.abs(b).max())))


def test_bilinear_forms_are_polarised(at_orbit):
    map_, _ = at_orbit
    random = np.random.default_rng(3)
    v, w, u = random.standard_normal((3, 3))
    np.testing.assert_allclose(map_.b(v, w), map_.b(w, v), rtol=0, atol=1e-10)
    np.testing.assert_allclose(map_.b(v + u, w), map_.b(v, w) + map_.b(u, w), rtol=0, atol=1e-9)
    q = v + 1j * w
    exact = map_.b(v, v) - map_.b(w, w) + 2j * map_.b(v, w)
    np.testing.assert_allclose(map_.b_complex(q, q), exact, rtol=0, atol=1e-9)


def test_the_multipliers_are_those_of_the_map(at_orbit):
    map_, z = at_orbit
    own = map_.problem.multipliers(z, map_.problem.linearize(z).jacobian).values
    values = np.linalg.eigvals(map_.a)
    for value in own:
        assert np.min(np.abs(values - value)) < 1e-11


@pytest.mark.parametrize("which", [0, 1, 2])
def test_critical_vectors(at_orbit, which):
    """Right and left eigenvectors; a doubled length of the deviation over the orbit would be seen in both."""
    map_, _ = at_orbit
    value = np.linalg.eigvals(map_.a)[which]
    value = value.real if value.imag == 0.0 else value
    q, p = map_.critical(value)
    np.testing.assert_allclose(map_.a @ q, value * q, rtol=0, atol=1e-12 * np.abs(q).max())
    np.testing.assert_allclose(p @ map_.a, value * p, rtol=0, atol=1e-12 * np.abs(p).max())
    assert p @ q == pytest.approx(1.0, rel=1e-12)
    largest = q[np.argmax(np.abs(q))]
    assert largest.real > 0.0
    assert abs(largest.imag) <= 1e-14 * largest.real


def test_deviations_are_measured_in_what_the_orbit_moves_by_or_in_what_it_moves_by_most():
    """A state at rest has its declared scale, or its magnitude; where neither is known, the largest range."""
    states = np.array([[2.0, 0.0, -0.25, 3.0, 0.0], [-2.0, 0.0, 0.25, 3.0, 0.0]])
    names = (State("a"), State("b"), State("c"), State("d"), State("e", scale=7.0))
    found = units(SimpleNamespace(states=names), states, np.array([2.0, 0.0, 0.25, 3.0, 7.0]))
    assert found.tolist() == [2.0, 2.0, 0.25, 3.0, 7.0]


@pytest.mark.parametrize(
    ("coefficient", "error", "expected"),
    [
        (-2.0, None, "supercritical"),
        (2.0, None, "subcritical"),
        (-2.0, 1.0, "supercritical"),
        (1.0, 2.0, None),
    ],
)
def test_a_negative_cubic_coefficient_is_supercritical_where_it_is_known_not_to_vanish(
    coefficient, error, expected
):
    criticality, note = criticality_of(coefficient, error)
    assert criticality == expected
    assert (note is None) == (expected is not None)
