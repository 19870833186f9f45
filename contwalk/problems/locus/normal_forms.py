"""Normal forms of the special points of curves of equilibria (Kuznetsov 1999, SIAM J. Numer. Anal. 36, 1104).

Conventions are those of MatCont. q and p are right and left critical vectors, <q, q> = 1, <p, q> = 1; B, C,
.. the second, third, .. derivatives of the field by the states. The largest entry of a real q is positive.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.numerics.linear import Factored
from contwalk.problems.locus.bordered import (
    Critical,
    pair_borders,
    pair_condition,
    zero_borders,
    zero_condition,
)
from contwalk.problems.locus.plane import FloatPlace, Place, Plane

# A coefficient below this part of its terms is zero: others are not to be divided by it.
VANISHES = 1e-10


def root(kappa: Any) -> Any:
    """The frequency of a kappa, in its own arithmetic; NaN of a neutral saddle."""
    return kappa**0.5 if kappa >= 0 else float("nan")


def at_frequency(found: Critical, omega: Any) -> tuple[np.ndarray, np.ndarray]:
    """q and p of the eigenvalue i omega, shape (N,) each, <p, q> not yet one."""
    s = 1j * omega
    return found.right[0] + s * found.right[1], found.left[0] + s * found.left[1]


def lyapunov_numerator(place: Place, found: Critical, kappa: Any) -> Any:
    """Re <p, C(q,q,q*) - 2 B(q, A^-1 B(q,q*)) + B(q*, (2 i w - A)^-1 B(q,q))> with <p, q> = 1.

    Its sign is that of the first Lyapunov coefficient; q has the length that its border gives it.
    """
    p, terms = _driven(place, found, kappa)
    return (p @ sum(terms)).real


def lyapunov_known(place: FloatPlace, found: Critical, kappa: float) -> float:
    """`lyapunov_numerator`; zero where it is rounding of its terms, as all along a curve of centres."""
    p, terms = _driven(place, found, kappa)
    value, size = float((p @ sum(terms)).real), sum(float(np.abs(p) @ np.abs(term)) for term in terms)
    return value if abs(value) > VANISHES * size else 0.0


def _driven(place: Place, found: Critical, kappa: Any) -> tuple[np.ndarray, list[np.ndarray]]:
    """p, shape (N,), with <p, q> = 1, and the terms of what drives w |w|^2."""
    omega = root(kappa)
    q, p = at_frequency(found, omega)
    return p / (p @ (place.plane.finite * q)), _cubic(place, q, omega)[0]


def _cubic(place: Place, q: np.ndarray, omega: Any) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """The terms of what drives w |w|^2, with h11 and h20."""
    conjugate = np.conj(q)
    h11 = -place.solver(place.matrix)(_real(place.second(q, conjugate)))
    h20 = place.solver(_shifted(place, 2.0 * omega))(place.second(q, q))
    third = place.third(q, q, conjugate)
    return [third, 2 * place.second(q, h11), place.second(conjugate, h20)], h11, h20


def _shifted(place: Place, omega: Any) -> np.ndarray:
    """i omega E - F_u, shape (N, N)."""
    return 1j * omega * np.diag(place.plane.finite).astype(place.matrix.dtype) - place.matrix


def _real(v: np.ndarray) -> np.ndarray:
    """The real parts of a vector whose imaginary parts vanish."""
    return np.array([x.real for x in v.flat], dtype=object) if v.dtype == object else v.real


# -- what is told of each point ----------------------------------------------------------------------------


def _normalized(q: np.ndarray, p: np.ndarray, finite: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """<q, q> = 1 and <p, q> = 1."""
    q = q / np.linalg.norm(q)
    return q, p / (p @ (finite * q))


def _bordered_solve(matrix: np.ndarray, q: np.ndarray, p: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution of matrix h = right with <p, h> = 0, of a matrix that is singular along q."""
    bordered = np.block([[matrix, q[:, None]], [p[None, :], np.zeros((1, 1))]])
    return Factored(bordered).solve(np.append(right, 0.0))[: len(q)]


def cusp_coefficient(plane: Plane, z: np.ndarray) -> dict[str, Any]:
    """c of y' = b1 + b2 y + c y^3 at z, shape (N + 2,); none where the eigenvalue zero is a double one."""
    place = FloatPlace(plane, z)
    found = zero_condition(place, zero_borders(place.matrix))
    right, left = found.right[0], found.left[0]
    moved = plane.finite * right
    if abs(left @ moved) <= VANISHES * np.linalg.norm(left) * np.linalg.norm(moved):
        return {}
    q, p = _normalized(right, left, plane.finite)
    b = place.second(q, q)
    h = _bordered_solve(place.matrix, q, p, -(b - (p @ b) * q))
    c = float(p @ (place.third(q, q, q) + 3.0 * place.second(q, h))) / 6.0
    return {
        "c": c,
        "convention": "MatCont: y' = b1 + b2 y + c y^3, c = p.(C(q,q,q) + 3 B(q,h2))/6, |q| = 1, p.q = 1",
    }


def pitchfork_coefficients(plane: Plane, z: np.ndarray) -> dict[str, Any]:
    """c, which is zero, and e of y' = b y + c y^3 + e y^5 at a degenerate pitchfork z, shape (N + 2,)."""
    place = FloatPlace(plane, z)
    found = zero_condition(place, zero_borders(place.matrix))
    q, p = _normalized(found.right[0], found.left[0], plane.finite)
    second, third, several = place.second, place.third, place.several

    def solved(right: np.ndarray) -> np.ndarray:
        return _bordered_solve(place.matrix, q, p, (p @ right) * plane.finite * q - right)

    h2 = solved(second(q, q))
    drive = third(q, q, q) + 3 * second(q, h2)
    h3 = solved(drive)
    h4 = solved(several(q, q, q, q) + 6 * third(q, q, h2) + 3 * second(h2, h2) + 4 * second(q, h3))
    fifth = (
        several(q, q, q, q, q)
        + 10 * (several(q, q, q, h2) + third(q, q, h3) + second(h2, h3))
        + 15 * third(q, h2, h2)
        + 5 * second(q, h4)
    )
    return {
        "c": float(p @ drive) / 6.0,
        "e": float(p @ fifth) / 120.0,
        "convention": "y' = b y + c y^3 + e y^5, |q| = 1, p.q = 1",
    }


def bogdanov_takens_coefficients(plane: Plane, z: np.ndarray) -> dict[str, Any]:
    """a and b of y1' = y2, y2' = b1 + b2 y1 + a y1^2 + b y1 y2 at z, shape (N + 2,)."""
    place = FloatPlace(plane, z)
    found = pair_condition(place, pair_borders(place.matrix, plane.finite, 0.0), 0.0)
    finite = plane.finite
    # In the numbers a + s b with s^2 = 0 the vectors are those of the chain: A q0 = 0, A q1 = q0.
    q0, q1 = found.right
    p1, p0 = found.left
    q0, q1 = q0 / np.linalg.norm(q0), q1 / np.linalg.norm(q0)
    sign = np.sign(q0[np.argmax(np.abs(q0))])
    q0, q1 = sign * q0, sign * q1
    q1 = q1 - (q0 @ q1) * q0
    scale = p1 @ (finite * q1)
    p1 = p1 / scale
    p0 = p0 / scale
    p0 = p0 - (p0 @ (finite * q1)) * p1
    a = 0.5 * float(p1 @ place.second(q0, q0))
    b = float(p0 @ place.second(q0, q0) + p1 @ place.second(q0, q1))
    convention = (
        "MatCont: y1' = y2, y2' = b1 + b2 y1 + a y1^2 + b y1 y2, |q0| = 1, q0.q1 = 0, p0.q0 = p1.q1 = 1, "
        "p0.q1 = p1.q0 = 0, the largest entry of q0 positive"
    )
    return {"a": a, "b": b, "convention": convention}


def _pair(place: FloatPlace, kappa: float) -> tuple[np.ndarray, np.ndarray, float]:
    """q, p and the frequency of the pair of a kappa, normalized."""
    omega = float(root(kappa))
    found = pair_condition(place, pair_borders(place.matrix, place.plane.finite, kappa), kappa)
    q, p = at_frequency(found, omega)
    return *_normalized(q, p, place.plane.finite), omega


def hopf_coefficients(plane: Plane, z: np.ndarray, kappa: float) -> dict[str, Any]:
    """l1 of a Hopf point z, shape (N + 2,); kappa is omega squared."""
    place = FloatPlace(plane, z)
    q, p, omega = _pair(place, kappa)
    l1 = float((p @ sum(_cubic(place, q, omega)[0])).real) / (2.0 * omega)
    convention = "Kuznetsov 2004, eq. 5.34: l1 = Re(c1)/omega with <q,q> = 1, <p,q> = 1"
    return {"l1": l1, "omega": omega, "convention": convention}


def cubic_rate(plane: Plane, z: np.ndarray, kappa: float) -> float:
    """Re c1 of w' = i omega w + c1 w |w|^2 at a Hopf point z, shape (N + 2,), with <q, q> = <p, q> = 1.

    kappa is omega squared.
    """
    place = FloatPlace(plane, z)
    q, p, omega = _pair(place, kappa)
    return 0.5 * float((p @ sum(_cubic(place, q, omega)[0])).real)


def bautin_coefficients(plane: Plane, z: np.ndarray, kappa: float) -> dict[str, Any]:
    """l2 = Re G32 / 12 of w' = i omega w + G21 w |w|^2 / 2 + G32 w |w|^4 / 12, where Re G21 = 0.

    z has the shape (N + 2,); kappa is omega squared.
    """
    place = FloatPlace(plane, z)
    q, p, omega = _pair(place, kappa)
    c, several = np.conj(q), place.several
    conj, second, third = np.conj, place.second, place.third
    terms, h11, h20 = _cubic(place, q, omega)
    drive = sum(terms)
    h02 = conj(h20)
    twice, triple = (Factored(_shifted(place, times * omega)).solve for times in (2.0, 3.0))
    inverse = Factored(place.matrix).solve
    h30 = triple(third(q, q, q) + 3 * second(q, h20))
    g21 = p @ drive
    h21 = _bordered_solve(-_shifted(place, omega), q, p, g21 * q * plane.finite - drive)
    h12 = conj(h21)
    h31 = twice(
        several(q, q, q, c)
        + 3 * (third(q, q, h11) + third(q, c, h20) + second(h20, h11) + second(q, h21))
        + second(c, h30)
        - 3 * g21 * plane.finite * h20
    )
    h22 = -inverse(
        (
            several(q, q, c, c)
            + 4 * third(q, c, h11)
            + third(c, c, h20)
            + third(q, q, h02)
            + 2 * (second(h11, h11) + second(c, h21) + second(q, h12))
            + second(h20, h02)
        ).real
    )
    fifth = (
        several(q, q, q, c, c)
        + several(q, q, q, h02)
        + 3 * several(q, c, c, h20)
        + 6 * several(q, q, c, h11)
        + third(c, c, h30)
        + 3 * (third(q, q, h12) + third(q, h20, h02))
        + 6 * (third(q, h11, h11) + third(c, h20, h11) + third(q, c, h21))
        + 2 * second(c, h31)
        + 3 * (second(q, h22) + second(h20, h12))
        + second(h02, h30)
        + 6 * second(h11, h21)
    )
    convention = "MatCont: l2 = Re G32 / 12 (Kuznetsov 1999), <q,q> = 1, <p,q> = 1"
    return {"l2": float((p @ fifth).real) / 12.0, "omega": omega, "convention": convention}


def zero_hopf_coefficients(plane: Plane, z: np.ndarray, kappa: float) -> dict[str, Any]:
    """s, theta and E of the truncated normal form of a zero-Hopf point z, shape (N + 2,)."""
    place = FloatPlace(plane, z)
    found = zero_condition(place, zero_borders(place.matrix))
    q0, p0 = _normalized(found.right[0], found.left[0], plane.finite)
    q, p, omega = _pair(place, kappa)
    c, second, third, e = np.conj(q), place.second, place.third, plane.finite
    b00, b01, b11 = second(q0, q0), second(q0, q), second(q, c).real
    f200, f011, g110 = 0.5 * float(p0 @ b00), float(p0 @ b11), p @ b01
    h200 = _bordered_solve(place.matrix, q0, p0, 2.0 * f200 * e * q0 - b00)
    h110 = _bordered_solve(_shifted(place, omega), q, p, b01 - g110 * e * q)
    h020 = Factored(_shifted(place, 2.0 * omega)).solve(second(q, q))
    h011 = _bordered_solve(place.matrix, q0, p0, f011 * e * q0 - b11)
    f300 = float(p0 @ (third(q0, q0, q0) + 3 * second(q0, h200))) / 6.0
    f111 = float((p0 @ (third(q0, q, c) + 2 * second(q, np.conj(h110)).real + second(q0, h011))).real)
    g210 = p @ (third(q0, q0, q) + 2 * second(q0, h110) + second(q, h200)) / 2.0
    g021 = p @ (third(q, q, c) + 2 * second(q, h011) + second(c, h020)) / 2.0
    numbers = {"omega": omega, "f200": f200, "f011": f011, "g110_real": float(g110.real)}
    convention = (
        "MatCont: s = sign(f200 f011), theta = Re g110 / (2 f200), E = Re(g210 + g110 (Re g021/f011 - "
        "3 f300/(2 f200) + f111/(2 f011)) - g021 f200/f011) of w0' = f200 w0^2 + f011 |w1|^2 + .., "
        "w1' = i omega w1 + g110 w0 w1 + .."
    )
    sizes = [float(np.linalg.norm(p0) * np.linalg.norm(b)) for b in (b00, b11)]
    if abs(f200) <= VANISHES * sizes[0] or abs(f011) <= VANISHES * sizes[1]:  # as on an invariant face
        return {**numbers, "convention": convention}
    cubic = g210 + g110 * (g021.real / f011 - 1.5 * f300 / f200 + 0.5 * f111 / f011) - g021 * f200 / f011
    told = {
        "s": float(np.sign(f200 * f011)),
        "theta": float(g110.real) / (2.0 * f200),
        "E": float(cubic.real),
    }
    return {**told, **numbers, "convention": convention}


def double_hopf_coefficients(plane: Plane, z: np.ndarray, kappas: Sequence[float]) -> dict[str, Any]:
    """Real parts of the cubic coefficients p11, p12, p21, p22, the larger frequency first; theta, delta.

    z has the shape (N + 2,); the kappas are both frequencies squared.
    """
    place = FloatPlace(plane, z)
    fast, slow = (_pair(place, kappa) for kappa in sorted(kappas, reverse=True))
    numbers: dict[str, Any] = {}
    for name, (q, p, omega) in (("p11", fast), ("p22", slow)):
        numbers[name] = 0.5 * float((p @ sum(_cubic(place, q, omega)[0])).real)
    for name, own, other in (("p12", fast, slow), ("p21", slow, fast)):
        numbers[name] = float((own[1] @ _mixed(place, own, other)).real)
    numbers["omega_1"], numbers["omega_2"] = fast[2], slow[2]
    if numbers["p11"] * numbers["p22"] != 0.0:
        numbers["theta"], numbers["delta"] = numbers["p12"] / numbers["p22"], numbers["p21"] / numbers["p11"]
    numbers["convention"] = (
        "MatCont: w1' = w1 (i omega_1 + p11 |w1|^2 + p12 |w2|^2), w2' = w2 (i omega_2 + p21 |w1|^2 + "
        "p22 |w2|^2), real parts, omega_1 > omega_2, theta = p12/p22, delta = p21/p11, <q,q> = 1, <p,q> = 1"
    )
    return numbers


def _mixed(
    place: FloatPlace, own: tuple[np.ndarray, np.ndarray, float], other: tuple[np.ndarray, np.ndarray, float]
) -> np.ndarray:
    """What drives w1 |w2|^2."""
    (q1, _, omega1), (q2, _, omega2) = own, other
    second = place.second
    h0011 = -Factored(place.matrix).solve(second(q2, np.conj(q2)).real)
    h1010 = Factored(_shifted(place, omega1 + omega2)).solve(second(q1, q2))
    h1001 = Factored(_shifted(place, omega1 - omega2)).solve(second(q1, np.conj(q2)))
    third = place.third(q1, q2, np.conj(q2))
    return third + second(q1, h0011) + second(q2, h1001) + second(np.conj(q2), h1010)
