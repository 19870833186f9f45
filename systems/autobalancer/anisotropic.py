"""Different stiffness and damping along two directions at rest: the suspension is seen from a turning rotor.

State order for n masses: x1, x2, beta1..betan, then the rates. x is the displacement AB along the directions
of the springs, which are at rest; beta is measured from the unbalance, which is at the angle omega t. So a
balanced rotor is a constant solution: x = 0, and every mass stays where it is in the ring.

In these coordinates the field repeats after a whole turn, 2 pi / omega. Half a turn later the unbalance and
the masses push the other way: f(t + pi / omega, S z) = S f(t, z), with the S of `make_half_turn`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from contwalk.system import Neutral, Symmetry

from .masses import BETA, accelerations

X1, X2 = 0, 1


def make_field(n: int) -> Callable[..., None]:
    """Vector field of the rotor with n masses: equations 27 to 29 with their signs corrected.

        M' x1'' + c1 x1' + k1 x1 = m e omega^2 cos(omega t)
                                   + m1 l1 sum_j (beta_j'' sin + (beta_j' + omega)^2 cos)
        M' x2'' + c2 x2' + k2 x2 = m e omega^2 sin(omega t)
                                   - m1 l1 sum_j (beta_j'' cos - (beta_j' + omega)^2 sin)
        (m1 + J) l1 beta_j'' + (delta + gamma) l1 beta_j' = m1 (x1'' sin - x2'' cos)

    with sin and cos of beta_j + omega t.
    """
    x1_dot, x2_dot, beta_dot = n + 2, n + 3, n + 4

    def field(t: Any, x: Any, p: Any, dx: Any) -> None:
        turn = p.omega * t
        push = p.m * p.e * p.omega * p.omega
        force1 = push * math.cos(turn) - p.c1 * x[x1_dot] - p.k1 * x[X1]
        force2 = push * math.sin(turn) - p.c2 * x[x2_dot] - p.k2 * x[X2]
        rates = [x[beta_dot + j] for j in range(n)]
        angles = [x[BETA + j] + turn for j in range(n)]
        a1, a2, rolling = accelerations(n, p, (force1, force2), angles, rates)

        dx[X1] = x[x1_dot]
        dx[X2] = x[x2_dot]
        dx[x1_dot] = a1
        dx[x2_dot] = a2
        for j in range(n):
            dx[BETA + j] = rates[j]
            dx[beta_dot + j] = rolling[j]

    return field


def period(p: Any) -> Any:
    """One turn of the rotor."""
    return 2.0 * math.pi / abs(p.omega)


def make_half_turn(n: int) -> Symmetry:
    """x -> -x, x' -> -x' with the angles in the rotor kept: holds half a turn later (equations 41 to 43)."""

    def half_turn(t: Any, x: Any, p: Any, x_image: Any) -> None:
        for i in range(2 * n + 4):
            x_image[i] = x[i]
        for i in (X1, X2, n + 2, n + 3):
            x_image[i] = -x[i]

    return Symmetry("half_turn", "spatial", half_turn, about="half a turn later AB is on the other side of A")


def make_rotation(n: int) -> Neutral:
    """The same motion at an earlier time, seen from the rotor: x(t + s), beta(t + s) + omega s.

    It is a motion too where nothing marks the rotor, m e = 0. Of a balanced state all masses are turned.
    """
    field = make_field(n)

    def rotation(t: Any, x: Any, p: Any, v: Any) -> None:
        field(t, x, p, v)
        for j in range(n):
            v[BETA + j] = v[BETA + j] + p.omega

    return Neutral("rotation", rotation, about="the masses run ahead of the rotor; neutral where m e = 0")
