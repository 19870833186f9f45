"""Equations of motion, and the maps and directions that leave them unchanged.

State order for n masses: q1, q2, beta1..betan, then the rates in the same order (2 n + 4 states).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from contwalk.system import Neutral, Symmetry

Q1, Q2, BETA = 0, 1, 2


def make_field(n: int) -> Callable[..., None]:
    """Vector field of the rotor with n masses.

    With the acceleration a = q'' + 2 i omega q' - omega^2 q of the ring's centre (complex notation, axes
    of the rotating frame) the equations are

        M' a = omega^2 m e - c (q' + i omega q) - k q
               + m1 l1 sum_j ((beta_j' + omega)^2 - i beta_j'') exp(i beta_j)
        (m1 + J) l1 beta_j'' = m1 (a1 sin beta_j - a2 cos beta_j) - (delta + gamma) l1 beta_j'

    The second, put into the first, leaves a symmetric 2x2 system for a. It is positive definite whenever
    M + m > 0, as M' = M + m + n m1.
    """
    q1_dot, q2_dot, beta_dot = n + 2, n + 3, n + 4

    def field(t: Any, x: Any, p: Any, dx: Any) -> None:
        rolling_mass = p.m1 + p.J
        drag = (p.delta + p.gamma) / rolling_mass
        coupling = p.m1 / rolling_mass
        total_mass = p.M + p.m + n * p.m1
        moment = p.m1 * p.l1

        force1 = p.m * p.e * p.omega * p.omega - p.c * (x[q1_dot] - p.omega * x[Q2]) - p.k * x[Q1]
        force2 = -p.c * (x[q2_dot] + p.omega * x[Q1]) - p.k * x[Q2]
        mass11 = total_mass
        mass12 = 0.0
        mass22 = total_mass
        for j in range(n):
            sine = math.sin(x[BETA + j])
            cosine = math.cos(x[BETA + j])
            speed = x[beta_dot + j] + p.omega
            force1 = force1 + moment * (speed * speed * cosine - drag * x[beta_dot + j] * sine)
            force2 = force2 + moment * (speed * speed * sine + drag * x[beta_dot + j] * cosine)
            mass11 = mass11 - coupling * p.m1 * sine * sine
            mass12 = mass12 + coupling * p.m1 * sine * cosine
            mass22 = mass22 - coupling * p.m1 * cosine * cosine
        determinant = mass11 * mass22 - mass12 * mass12
        a1 = (mass22 * force1 - mass12 * force2) / determinant
        a2 = (mass11 * force2 - mass12 * force1) / determinant

        dx[Q1] = x[q1_dot]
        dx[Q2] = x[q2_dot]
        dx[q1_dot] = a1 + 2.0 * p.omega * x[q2_dot] + p.omega * p.omega * x[Q1]
        dx[q2_dot] = a2 - 2.0 * p.omega * x[q1_dot] + p.omega * p.omega * x[Q2]
        for j in range(n):
            tangential = a1 * math.sin(x[BETA + j]) - a2 * math.cos(x[BETA + j])
            dx[BETA + j] = x[beta_dot + j]
            dx[beta_dot + j] = coupling * tangential / p.l1 - drag * x[beta_dot + j]

    return field


def make_symmetries(n: int) -> tuple[Symmetry, ...]:
    """Exchange of each mass with the next; together they generate every renumbering.

    There is no mirror symmetry: (q2, beta) -> (-q2, -beta) turns the rotation round (omega -> -omega).
    """
    return tuple(
        Symmetry(
            f"exchange_{i}_{i + 1}",
            "relabel",
            _exchange(n, i - 1),
            about=f"masses {i} and {i + 1} change names",
        )
        for i in range(1, n)
    )


def _exchange(n: int, first: int) -> Callable[..., None]:
    """Map that swaps masses `first` and `first + 1`, counted from zero."""

    def exchange(t: Any, x: Any, p: Any, x_image: Any) -> None:
        for i in range(2 * n + 4):
            x_image[i] = x[i]
        for angle in (BETA + first, n + 4 + first):
            x_image[angle] = x[angle + 1]
            x_image[angle + 1] = x[angle]

    return exchange


def make_neutral(n: int) -> tuple[Neutral, ...]:
    """Rotation of everything (neutral at m e = 0), and one family of balanced states per mass beyond two."""
    rotation = Neutral(
        "rotation", _rotation(n), about="rotor and masses turn together; neutral where m e = 0"
    )
    families = tuple(
        Neutral(
            f"family{i}",
            _family(n, i),
            pin=f"beta{i}",
            value=f"angle{i}",
            about=f"mass {i} moves and masses 1, 2 make up for it; neutral where the rotor is balanced",
        )
        for i in range(3, n + 1)
    )
    return (rotation, *families)


def _rotation(n: int) -> Callable[..., None]:
    """Generator of q -> q exp(i s), q' -> q' exp(i s), beta -> beta + s."""

    def rotation(t: Any, x: Any, p: Any, v: Any) -> None:
        for rates in (0, n + 2):
            v[rates] = -x[rates + 1]
            v[rates + 1] = x[rates]
        for j in range(n):
            v[BETA + j] = 1.0
            v[n + 4 + j] = 0.0

    return rotation


def _family(n: int, i: int) -> Callable[..., None]:
    """Generator that moves masses 1, 2 and i so that the sum of exp(i beta) stays."""
    moved = BETA + i - 1

    def family(t: Any, x: Any, p: Any, v: Any) -> None:
        for entry in range(2 * n + 4):
            v[entry] = 0.0
        v[BETA] = math.sin(x[BETA + 1] - x[moved])
        v[BETA + 1] = math.sin(x[moved] - x[BETA])
        v[moved] = math.sin(x[BETA] - x[BETA + 1])

    return family
