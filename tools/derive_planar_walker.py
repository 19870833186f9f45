"""Equations of the planar walker, derived with SymPy from energies alone.

The free walker has six coordinates: the thighs q1 and q2, the knees q3 and q6, and the hip (q4, q5). Its
kinetic and potential energy are those of four bodies; Lagrange's equations give the mass matrix and the
forces. Contacts and locked knees are added afterwards as constraints on the velocity, with their forces or
impulses as further unknowns. Nothing is eliminated by hand, and nothing of the plugin's own equations enters.

    python tools/derive_planar_walker.py

prints mass matrix, forces and constraints. The tests compare the plugin with what is derived here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import mpmath
import sympy as sp

NAMES = ("m1", "m2", "i1", "i2", "l1", "l2", "l1x", "l1y", "l2x", "l2y", "lf", "rf", "g", "alpha")
M1, M2, I1, I2, L1, L2, L1X, L1Y, L2X, L2Y, LF, RF, G, ALPHA = PARAMETERS = sp.symbols(NAMES)
Q = sp.symbols("q1:7")
U = sp.symbols("u1:7")
HIP = sp.Matrix([Q[3], Q[4]])
# Thigh, knee: positions among the coordinates.
LEG_1, LEG_2 = (0, 5), (1, 2)


def turned(angle: Any, x: Any, y: Any) -> sp.Matrix:
    """Vector (x, y) of a frame that is turned by an angle, counter-clockwise."""
    return sp.Matrix([sp.cos(angle) * x - sp.sin(angle) * y, sp.sin(angle) * x + sp.cos(angle) * y])


def rate(expression: Any) -> Any:
    """Derivative by time: every coordinate changes with its rate."""
    return sum((sp.diff(expression, q) * u for q, u in zip(Q, U, strict=True)), start=expression * 0)


def limbs(leg: tuple[int, int]) -> dict[str, Any]:
    """Centres of mass, centre of the foot and angles of the limbs of a leg; a knee bends clockwise."""
    thigh = Q[leg[0]]
    shank = thigh - Q[leg[1]]
    knee = HIP + turned(thigh, 0, -L2)
    return {
        "thigh": thigh,
        "shank": shank,
        "thigh_centre": HIP + turned(thigh, L2X, -L2Y),
        "shank_centre": knee + turned(shank, L1X, -L1Y),
        "foot": knee + turned(shank, LF, -L1),
    }


def energies() -> tuple[Any, Any]:
    """Kinetic and potential energy of the free walker."""
    kinetic, potential = sp.Integer(0), sp.Integer(0)
    up = sp.Matrix([-sp.sin(ALPHA), sp.cos(ALPHA)])
    for leg in (LEG_1, LEG_2):
        parts = limbs(leg)
        for name, mass, inertia in (("thigh", M2, I2), ("shank", M1, I1)):
            centre = parts[f"{name}_centre"]
            velocity = rate(centre)
            kinetic += mass * velocity.dot(velocity) / 2 + inertia * rate(parts[name]) ** 2 / 2
            potential += mass * G * up.dot(centre)
    return kinetic, potential


def contact_velocity(leg: tuple[int, int]) -> sp.Matrix:
    """Velocity of the point of the foot that is lowest: it is fixed to the shank."""
    parts = limbs(leg)
    spin = rate(parts["shank"])
    # omega x (0, -rf)
    return rate(parts["foot"]) + sp.Matrix([spin * RF, 0])


def constraints(leg: tuple[int, int], knees: Sequence[int]) -> sp.Matrix:
    """Velocities that are zero: of the standing foot, of the locked knees (3, 6)."""
    return sp.Matrix([*contact_velocity(leg), *[U[knee - 1] for knee in knees]])


@cache
def derived() -> tuple[sp.Matrix, sp.Matrix, Any, Any]:
    """Mass matrix and forces of the free walker, M u' = F, and its energies."""
    kinetic, potential = energies()
    momenta = sp.Matrix([sp.diff(kinetic, u) for u in U])
    mass = momenta.jacobian(sp.Matrix(U))
    # d/dt of the momenta at constant rates, taken to the right-hand side.
    force = sp.Matrix([sp.diff(kinetic - potential, q) for q in Q]) - momenta.jacobian(Q) * sp.Matrix(U)
    return mass, force, kinetic, potential


@cache
def _free() -> Any:
    mass, force, kinetic, potential = derived()
    return sp.lambdify([*Q, *U, *PARAMETERS], (mass, force, kinetic, potential), "mpmath", cse=True)


@cache
def _held(leg: tuple[int, int], knees: tuple[int, ...]) -> Any:
    velocities = constraints(leg, knees)
    matrix = velocities.jacobian(U)
    return sp.lambdify([*Q, *U, *PARAMETERS], (matrix, rate(velocities)), "mpmath", cse=True)


def _numbers(q: Sequence[Any], u: Sequence[Any], p: Mapping[str, float]) -> list[Any]:
    return [mpmath.mpf(value) for value in (*q, *u, *(p[name] for name in NAMES))]


def energy(q: Sequence[Any], u: Sequence[Any], p: Mapping[str, float]) -> tuple[Any, Any]:
    """Kinetic and potential energy, of six coordinates and six rates."""
    return _free()(*_numbers(q, u, p))[2:]


def mass_matrix(q: Sequence[Any], p: Mapping[str, float]) -> Any:
    """Mass matrix of the free walker, 6 by 6."""
    return _free()(*_numbers(q, [0] * 6, p))[0]


def standing(
    q: Sequence[Any], limb_rates: Sequence[Any], p: Mapping[str, float], leg: tuple[int, int] = LEG_1
) -> list[Any]:
    """All six rates when (u1, u2, u3, u6) are given and the foot of a leg rolls: the hip follows."""
    u1, u2, u3, u6 = limb_rates
    slip = _held(leg, ())(*_numbers(q, [0] * 6, p))[0] * mpmath.matrix([u1, u2, u3, 0, 0, u6])
    return [mpmath.mpf(value) for value in (u1, u2, u3, -slip[0], -slip[1], u6)]


def motion(
    q: Sequence[Any], u: Sequence[Any], p: Mapping[str, float], knees: tuple[int, ...]
) -> tuple[Any, Any]:
    """Accelerations of the six coordinates and forces (R_x, R_y, knees..) while leg 1 stands."""
    numbers = _numbers(q, u, p)
    mass, force, *_ = _free()(*numbers)
    matrix, bias = _held(LEG_1, knees)(*numbers)
    return _bordered(mass, matrix, force, -bias)


def impact(
    q: Sequence[Any], u: Sequence[Any], p: Mapping[str, float], leg: tuple[int, int]
) -> tuple[Any, Any]:
    """Rates after an impact that leaves a leg standing and both knees held, and (R_x, R_y, Q_1, Q_2)."""
    numbers = _numbers(q, u, p)
    mass = _free()(*numbers)[0]
    matrix, _ = _held(leg, (6, 3))(*numbers)
    return _bordered(mass, matrix, mass * mpmath.matrix(numbers[6:12]), mpmath.zeros(matrix.rows, 1))


def _bordered(mass: Any, matrix: Any, right: Any, constraint: Any) -> tuple[Any, Any]:
    """Solution of mass v - matrix^T r = right, matrix v = constraint."""
    n, k = mass.rows, matrix.rows
    full, known = mpmath.zeros(n + k), mpmath.zeros(n + k, 1)
    full[:n, :n] = mass
    full[:n, n:] = -matrix.T
    full[n:, :n] = matrix
    known[:n, 0] = right
    known[n:, 0] = constraint
    solution = mpmath.lu_solve(full, known)
    return list(solution[:n]), list(solution[n:])


def main() -> None:
    """Print what is derived."""
    mass, force, *_ = derived()
    for i in range(6):
        for j in range(i, 6):
            print(f"M{i + 1}{j + 1} =", sp.simplify(mass[i, j]))
    for i in range(6):
        print(f"F{i + 1} =", sp.simplify(force[i]))
    matrix = constraints(LEG_1, (6, 3)).jacobian(U).T
    for i in range(6):
        for j in range(4):
            if matrix[i, j] != 0:
                print(f"C{i + 1}{j + 1} =", sp.simplify(matrix[i, j]))


if __name__ == "__main__":
    main()
