"""What both suspensions share: masses in the ring, their renumberings, and families of balanced states.

State order for n masses: two displacements, beta1..betan, then the rates in the same order (2 n + 4 states).
beta is measured from the unbalance, in the rotor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from contwalk.system import Neutral, Symmetry

AB1, AB2, BETA = 0, 1, 2  # the displacement AB of the ring's centre, and the first angle


def accelerations(
    n: int, p: Any, force: tuple[Any, Any], angles: Sequence[Any], rates: Sequence[Any]
) -> tuple[Any, Any, list[Any]]:
    """Accelerations of the ring's centre and of the masses relative to the ring.

    With a the acceleration of the centre and alpha_j the angles of the masses from the same axes,

        M' a = force + m1 l1 sum_j ((beta_j' + omega)^2 - i beta_j'') exp(i alpha_j)
        (m1 + J) l1 beta_j'' = m1 (a1 sin alpha_j - a2 cos alpha_j) - (delta + gamma) l1 beta_j'

    (complex notation). The second, put into the first, leaves a symmetric 2x2 system for a. It is positive
    definite whenever M + m > 0, as M' = M + m + n m1.

    Parameters
    ----------
    n : int
    p : parameters by name
    force : pair
        Forces of suspension and unbalance on the centre, along the axes in which the angles are measured.
    angles, rates : sequence of length n
        alpha_j and beta_j'.

    Returns
    -------
    tuple
        a1, a2 and the list of beta_j''.
    """
    rolling_mass = p.m1 + p.J
    drag = (p.delta + p.gamma) / rolling_mass
    coupling = p.m1 / rolling_mass
    total_mass = p.M + p.m + n * p.m1
    moment = p.m1 * p.l1

    force1, force2 = force
    mass11 = total_mass
    mass12 = 0.0
    mass22 = total_mass
    for j in range(n):
        sine = math.sin(angles[j])
        cosine = math.cos(angles[j])
        speed = rates[j] + p.omega
        force1 = force1 + moment * (speed * speed * cosine - drag * rates[j] * sine)
        force2 = force2 + moment * (speed * speed * sine + drag * rates[j] * cosine)
        mass11 = mass11 - coupling * p.m1 * sine * sine
        mass12 = mass12 + coupling * p.m1 * sine * cosine
        mass22 = mass22 - coupling * p.m1 * cosine * cosine
    determinant = mass11 * mass22 - mass12 * mass12
    a1 = (mass22 * force1 - mass12 * force2) / determinant
    a2 = (mass11 * force2 - mass12 * force1) / determinant

    rolling = []
    for j in range(n):
        tangential = a1 * math.sin(angles[j]) - a2 * math.cos(angles[j])
        rolling.append(coupling * tangential / p.l1 - drag * rates[j])
    return a1, a2, rolling


def make_exchanges(n: int) -> tuple[Symmetry, ...]:
    """Exchange of each mass with the next; together they generate every renumbering.

    There is no mirror symmetry: turning the second displacement and beta round turns the rotation round too.
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


def make_families(n: int) -> tuple[Neutral, ...]:
    """One family of balanced states per mass beyond two."""
    return tuple(
        Neutral(
            f"family{i}",
            _family(n, i),
            pin=f"beta{i}",
            value=f"angle{i}",
            about=f"mass {i} moves and masses 1, 2 make up for it; neutral where the rotor is balanced",
        )
        for i in range(3, n + 1)
    )


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
