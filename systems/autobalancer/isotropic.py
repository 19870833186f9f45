"""Equal stiffness and damping in all directions: in the frame of the rotor the equations do not contain time.

State order for n masses: q1, q2, beta1..betan, then the rates. q1 is the displacement AB along the
unbalance, q2 across it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contwalk.system import Neutral

from .masses import BETA, accelerations

Q1, Q2 = 0, 1


def make_field(n: int) -> Callable[..., None]:
    """Vector field of the rotor with n masses, axes of the rotating frame.

    With the acceleration a = q'' + 2 i omega q' - omega^2 q of the ring's centre (complex notation) the
    equations are

        M' a = omega^2 m e - c (q' + i omega q) - k q
               + m1 l1 sum_j ((beta_j' + omega)^2 - i beta_j'') exp(i beta_j)
        (m1 + J) l1 beta_j'' = m1 (a1 sin beta_j - a2 cos beta_j) - (delta + gamma) l1 beta_j'
    """
    q1_dot, q2_dot, beta_dot = n + 2, n + 3, n + 4

    def field(t: Any, x: Any, p: Any, dx: Any) -> None:
        force1 = p.m * p.e * p.omega * p.omega - p.c * (x[q1_dot] - p.omega * x[Q2]) - p.k * x[Q1]
        force2 = -p.c * (x[q2_dot] + p.omega * x[Q1]) - p.k * x[Q2]
        rates = [x[beta_dot + j] for j in range(n)]
        a1, a2, rolling = accelerations(n, p, (force1, force2), [x[BETA + j] for j in range(n)], rates)

        dx[Q1] = x[q1_dot]
        dx[Q2] = x[q2_dot]
        dx[q1_dot] = a1 + 2.0 * p.omega * x[q2_dot] + p.omega * p.omega * x[Q1]
        dx[q2_dot] = a2 - 2.0 * p.omega * x[q1_dot] + p.omega * p.omega * x[Q2]
        for j in range(n):
            dx[BETA + j] = rates[j]
            dx[beta_dot + j] = rolling[j]

    return field


def make_rotation(n: int) -> Neutral:
    """Rotation of everything: q -> q exp(i s), q' -> q' exp(i s), beta -> beta + s."""

    def rotation(t: Any, x: Any, p: Any, v: Any) -> None:
        for rates in (0, n + 2):
            v[rates] = -x[rates + 1]
            v[rates + 1] = x[rates]
        for j in range(n):
            v[BETA + j] = 1.0
            v[n + 4 + j] = 0.0

    return Neutral("rotation", rotation, about="rotor and masses turn together; neutral where m e = 0")
