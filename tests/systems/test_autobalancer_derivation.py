"""The compiled equations against Lagrange's, derived with SymPy from energies and Rayleigh's function.

Nothing of the plugin or of the thesis's equations enters: only where the bodies are, how they roll, and what
springs, dampers and drag do.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import sympy as sp

from contwalk.fields.kernel import Kernel
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import trace
from contwalk.system import load_system
from contwalk.system.declarations import ParameterValues

T = sp.Symbol("t")
M, M_C, E, M1, L1, J, DRAG, OMEGA, RIM = sp.symbols("M m e m1 l1 J drag omega rim")
K1, K2, C1, C2, K, C = sp.symbols("k1 k2 c1 c2 k c")
DIGITS = 40


def lagrange(x, velocity_of_suspension, stiffness, damping, coordinates, n):
    """Lagrange's equations for the displacement x (a pair of expressions in the coordinates and t)."""
    beta = coordinates[2:]
    turn = OMEGA * T

    def square_of_speed(position):
        return sum(sp.diff(component, T) ** 2 for component in position)

    unbalance = (x[0] + E * sp.cos(turn), x[1] + E * sp.sin(turn))
    kinetic = M * square_of_speed(x) / 2 + M_C * square_of_speed(unbalance) / 2
    # Rayleigh's function: half the power lost
    lost = sum(c * v**2 for c, v in zip(damping, velocity_of_suspension, strict=True)) / 2
    for angle in beta:
        alpha = angle + turn
        ball = (x[0] + L1 * sp.cos(alpha), x[1] + L1 * sp.sin(alpha))
        # A ball of radius r and inertia I = J r^2 rolls on the rim of radius `rim`, which turns with omega:
        # at the contact l1 alpha' + r spin = rim omega.
        r_spin = RIM * OMEGA - L1 * sp.diff(alpha, T)
        kinetic += M1 * square_of_speed(ball) / 2 + J * r_spin**2 / 2
        lost += DRAG * L1**2 * sp.diff(angle, T) ** 2 / 2
    potential = sum(k * s**2 for k, s in zip(stiffness, x, strict=True)) / 2
    function = kinetic - potential
    equations = []
    for q in coordinates[: n + 2]:
        rate = sp.diff(q, T)
        equations.append(sp.diff(sp.diff(function, rate), T) - sp.diff(function, q) + sp.diff(lost, rate))
    return equations


@cache
def derived(suspension: str, n: int):
    """(inertia, force) as a function of 40-digit numbers: the accelerations solve inertia a = force."""
    first, second = ("q1", "q2") if suspension == "isotropic" else ("x1", "x2")
    names = [first, second, *[f"beta{i}" for i in range(1, n + 1)]]
    coordinates = [sp.Function(name)(T) for name in names]
    u, v = coordinates[:2]
    if suspension == "isotropic":
        cos, sin = sp.cos(OMEGA * T), sp.sin(OMEGA * T)
        x, stiffness, damping = (u * cos - v * sin, u * sin + v * cos), (K, K), (C, C)
    else:
        x, stiffness, damping = (u, v), (K1, K2), (C1, C2)
    velocity = [sp.diff(component, T) for component in x]
    equations = lagrange(x, velocity, stiffness, damping, coordinates, n)
    plain = sp.symbols(names)
    rates = sp.symbols([f"{name}_dot" for name in names])
    accelerations = sp.symbols([f"{name}_ddot" for name in names])
    for order, symbols in ((2, accelerations), (1, rates), (0, plain)):
        swap = {sp.diff(q, T, order) if order else q: s for q, s in zip(coordinates, symbols, strict=True)}
        equations = [equation.subs(swap) for equation in equations]
    inertia = sp.Matrix([[sp.diff(e, a) for a in accelerations] for e in equations])
    at_rest = dict.fromkeys(accelerations, 0)
    force = sp.Matrix([-equation.subs(at_rest) for equation in equations])
    given = [T, *plain, *rates, M, M_C, E, M1, L1, J, DRAG, OMEGA, RIM, K1, K2, C1, C2, K, C]
    return sp.lambdify(given, (inertia, force), "mpmath")


def accelerations_of(suspension, n, t, x, p):
    """Accelerations by Lagrange's equations, in 40 digits."""
    stiffness = [mpmath.mpf(getattr(p, name, 0)) for name in ("k1", "k2", "c1", "c2", "k", "c")]
    physical = [p.M, p.m, p.e, p.m1, p.l1, p.J, mpmath.mpf(p.delta) + mpmath.mpf(p.gamma), p.omega]
    rim = mpmath.mpf(7) / 3  # any: it drops out
    numbers = [mpmath.mpf(value) for value in (t, *x, *physical)]
    inertia, force = derived(suspension, n)(*numbers, rim, *stiffness)
    return mpmath.lu_solve(inertia, force)


def compiled(system):
    """The field as the program runs it, in 40 digits too: traced, and turned into text."""
    field = rebound(system.modes[0].field)

    def record(tracer):
        x = np.array([tracer.symbol("x", i) for i in range(len(system.states))], dtype=object)
        p = ParameterValues(**{name: tracer.symbol("p", k) for k, name in enumerate(system.parameter_names)})
        dx = np.full(len(x), None, dtype=object)
        field(tracer.symbol("t", 0), x, p, dx)
        return list(dx)

    return Kernel(trace(record), ("t", "x", "p"), (len(system.states),))


def random_case(suspension, n, seed):
    random = np.random.default_rng(seed)
    system = load_system("autobalancer", {"masses": n, "suspension": suspension})
    parameters = {q.name: float(random.uniform(0.3, 1.7)) for q in system.parameters}
    parameters["omega"] = float(random.uniform(-3.0, 3.0))
    parameters["e"] = float(random.uniform(-1.0, 1.0))
    return system, parameters, float(random.uniform(0.0, 5.0)), random.normal(size=2 * n + 4)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("suspension", ["isotropic", "anisotropic"])
@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_compiled_equations_are_lagranges(suspension, n, seed):
    system, parameters, t, x = random_case(suspension, n, seed)
    p = SimpleNamespace(**parameters)
    with mpmath.workdps(DIGITS):
        expected = [*x[n + 2 :], *accelerations_of(suspension, n, t, x, p)]
        arguments = [[mpmath.mpf(v) for v in group] for group in ((t,), x, parameters.values())]
        exact = compiled(system).exactly(*arguments)
        # sums of a dozen terms of order 10, divided by determinants of order 1
        assert max(abs(a - b) for a, b in zip(exact, expected, strict=True)) < mpmath.mpf(10) ** (4 - DIGITS)
    in_floats = compiled(system)([t], x.tolist(), list(parameters.values()))
    assert np.asarray(in_floats) == pytest.approx([float(v) for v in expected], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("n", [1, 2])
def test_in_the_rotors_frame_the_isotropic_equations_do_not_know_the_time(n):
    """Lagrange's equations there, at two times: why the isotropic model is autonomous."""
    _, parameters, t, x = random_case("isotropic", n, 5)
    p = SimpleNamespace(**parameters)
    with mpmath.workdps(DIGITS):
        now, later = (accelerations_of("isotropic", n, time, x, p) for time in (t, t + 0.77))
        assert max(abs(a - b) for a, b in zip(now, later, strict=True)) < mpmath.mpf(10) ** (4 - DIGITS)
