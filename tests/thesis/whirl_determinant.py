"""Eigenvalues of balanced states in extended precision, derived by hand: a check that shares no code with
contwalk.

At a balanced state (q = 0) small motions are q = Q exp(s t), beta_j = b_j + B_j exp(s t), and with z = s +
i omega the equations (8) and (9) become, for the displacement Q in the axes of the rotating frame,

    M' z^2 Q + c z Q + k Q = m1 l1 sum_j -i z^2 B_j exp(i b_j)
    ((m1 + J) l1 s^2 + delta l1 s) B_j = -m1 Im(z^2 Q exp(-i b_j))

written for real and imaginary parts separately: d/dt + i omega acts on pairs (x, y) as
s + omega [[0, -1], [1, 0]].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpmath import mp, mpc, mpf


def dynamic_matrix(s: mpc, angles: Sequence[mpf], p: Mapping[str, mpf]) -> mp.matrix:
    """D(s), of size n + 2, with D(s) (Q1, Q2, B1..Bn) = 0 for a motion exp(s t)."""
    n = len(angles)
    total = p["M"] + p["m"] + n * p["m1"]
    moment = p["m1"] * p["l1"]
    turn = mp.matrix([[s, -p["omega"]], [p["omega"], s]])
    square = turn * turn
    d = mp.zeros(n + 2)
    suspension = total * square + p["c"] * turn + p["k"] * mp.eye(2)
    for row in range(2):
        for column in range(2):
            d[row, column] = suspension[row, column]
    for j, angle in enumerate(angles):
        # A mass at l1 exp(i b): its displacement by B is i l1 exp(i b) B, its acceleration square times that.
        sideways = mp.matrix([-mp.sin(angle), mp.cos(angle)])
        pull = moment * (square * sideways)
        d[0, j + 2], d[1, j + 2] = pull[0], pull[1]
        push = p["m1"] * (sideways.T * square)
        d[j + 2, 0], d[j + 2, 1] = push[0], push[1]
        d[j + 2, j + 2] = (p["m1"] + p["J"]) * p["l1"] * s**2 + (p["delta"] + p["gamma"]) * p["l1"] * s
    return d


def balanced_angles(n: int, p: Mapping[str, mpf]) -> list[mpf]:
    """beta of a balanced state: equations 11, 12 and 45 to 48."""
    held = [p[f"angle{i}"] for i in range(3, n + 1)]
    moment = p["m1"] * p["l1"]
    load = p["m"] * p["e"] + moment * mp.fsum(mpc(mp.cos(angle), mp.sin(angle)) for angle in held)
    aside = mp.acos(abs(load) / (2 * moment))
    return [mp.arg(load) + mp.pi - aside, mp.arg(load) + mp.pi + aside, *held]


def exact_hopf(
    parameters: Mapping[str, float],
    free: str,
    frequency: float,
    n: int = 2,
    held: Mapping[str, mpf] | None = None,
) -> tuple[mpf, mpf]:
    """Parameter and frequency at which a balanced state has eigenvalues +-i frequency, near given ones; 40
    digits.

    `held` replaces values that a double cannot hold, such as pi.
    """
    with mp.workdps(50):
        values = {name: mpf(value) for name, value in parameters.items()} | dict(held or {})

        def condition(at: mpf, omega: mpf) -> tuple[mpf, mpf]:
            p = values | {free: at}
            determinant = mp.det(dynamic_matrix(mpc(0, omega), balanced_angles(n, p), p))
            return determinant.real, determinant.imag

        at, omega = mp.findroot(condition, (mpf(parameters[free]), mpf(frequency)), tol=1e-70)
        return at, omega


def neutral_directions(angles: Sequence[mpf], parameters: Mapping[str, float]) -> int:
    """Number of independent neutral directions of a balanced state: the nullity of D(0), 40 digits."""
    with mp.workdps(50):
        p = {name: mpf(value) for name, value in parameters.items()}
        singular = mp.svd_r(dynamic_matrix(mpf(0), list(angles), p), compute_uv=False)
        return sum(1 for value in singular if value < mpf(10) ** -40 * singular[0])
