"""First Lyapunov coefficient from its definition, in 50 digits and independent of the engine.

Derivatives of the field are polarised central differences in high precision; they are exact for polynomials
of degree three, and otherwise off by the square of a step of 1e-15.
"""

from collections.abc import Callable, Sequence
from typing import Any

import mpmath

DIGITS = 80
STEP = mpmath.mpf(10) ** -15

Field = Callable[[Sequence[Any]], list[Any]]


def first_lyapunov(field: Field, state: Sequence[Any], near: Any) -> tuple[Any, Any]:
    """l1 and omega at a Hopf point, with the eigenvalue nearest to i `near` (Kuznetsov 2004, eq. 5.34).

    l1 = Re[<p, C(q,q,q*)> - 2 <p, B(q, A^-1 B(q,q*))> + <p, B(q*, (2 i w - A)^-1 B(q,q))>] / (2 w).
    """
    with mpmath.workdps(DIGITS):
        x = mpmath.matrix([mpmath.mpf(v) for v in state])
        n = len(state)
        a = mpmath.matrix(n, n)
        for j in range(n):
            for i, value in enumerate(_first(field, x, _unit(n, j))):
                a[i, j] = value
        values, left, right = mpmath.eig(a, left=True, right=True)
        k = min(range(n), key=lambda i: abs(values[i] - 1j * near))
        omega = values[k].imag
        q, p = right[:, k], left[k, :]
        q = q / mpmath.sqrt(sum(abs(v) ** 2 for v in q))
        p = p / (p * q)[0]
        conj = q.apply(mpmath.conj)
        h11 = mpmath.lu_solve(a, _second(field, x, q, conj))
        h20 = mpmath.lu_solve(2j * omega * mpmath.eye(n) - a, _second(field, x, q, q))
        total = p * _third(field, x, q, q, conj)
        total += -2 * (p * _second(field, x, q, h11)) + p * _second(field, x, conj, h20)
        return mpmath.re(total[0]) / (2 * omega), omega


def _unit(n: int, j: int) -> Any:
    v = mpmath.matrix(n, 1)
    v[j] = 1
    return v


def _at(field: Field, x: Any) -> Any:
    return mpmath.matrix(field(list(x)))


def _first(field: Field, x: Any, v: Any) -> Any:
    return (_at(field, x + STEP * v) - _at(field, x - STEP * v)) / (2 * STEP)


def _second(field: Field, x: Any, v: Any, w: Any) -> Any:
    h = STEP

    def along(u: Any) -> Any:
        return _at(field, x + h * u) - 2 * _at(field, x) + _at(field, x - h * u)

    return (along(v + w) - along(v - w)) / (4 * h * h)


def _third(field: Field, x: Any, u: Any, v: Any, w: Any) -> Any:
    h = STEP
    total = mpmath.matrix(len(x), 1)
    for b in (1, -1):
        for c in (1, -1):
            s = u + b * v + c * w
            total += b * c * (_at(field, x + h * s) - _at(field, x - h * s))
    return total / (8 * h**3)
