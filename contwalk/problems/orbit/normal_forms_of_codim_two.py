"""Normal forms of orbits with two critical conditions: strong resonances, and two multipliers at once.

Notation as in `normal_forms`: A, B, C are the derivatives of the map that takes the section once round, q and
p right and left critical vectors, |q| = 1 over the orbit. Formulas of Kuznetsov (2004), sections 9.5 and
9.6, and of Govaerts, Khoshsiar Ghaziani, Kuznetsov & Meijer (2007), SIAM J. Sci. Comput. 29, 2644, whose
names the coefficients have. Here they stand with generalized vectors where the multiplier is double.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.numerics.linear import Factored
from contwalk.problems.orbit.normal_forms import SectionMap, cubic_of_flip, cubic_of_torus

# A pair of multipliers this near to the unit circle is on it.
ON_CIRCLE = 1e-3
# Against both lengths: below it a double multiplier has two directions.
SINGLE = 1e-8
# Two coefficients that differ by less than this part of them are equal, as where areas are preserved.
EQUAL = 1e-9
# A resonant coefficient below this part of its unit is none, as where the orbit is a wave that rotates: there
# what is over it is not told.
NONE = 1e-9
SCALED = "|q| = 1 over the orbit, p.q = 1"


def one_to_one(map_: SectionMap) -> dict[str, Any]:
    """a, b and s of a fold of orbits with the multiplier one twice."""
    q0, q1, p0, p1 = _chain(map_, 1.0)
    b00 = map_.b(q0, q0)
    a = 0.5 * float(p0 @ b00)
    b = float(p1 @ b00 + p0 @ map_.b(q0, q1))
    return {
        "a": a,
        "b": b,
        "s": float(np.sign(a * (b - 2.0 * a))) if abs(b - 2.0 * a) > EQUAL * abs(b) else 0.0,
        "convention": "return map (w0 + w1, w1 + a w0^2 + b w0 w1), a = p0.B(q0,q0)/2, b = p1.B(q0,q0) + "
        "p0.B(q0,q1), (A-1) q1 = q0, p1 (A-1) = p0, p0.q1 = p1.q0 = 1, p1.q1 = 0, |q0| = 1 over the orbit; "
        "s = sign(a (b - 2 a)) (Kuznetsov 2004, section 9.5.2)",
    }


def one_to_two(map_: SectionMap) -> dict[str, Any]:
    """c and d of an orbit with the multiplier minus one twice."""
    q0, q1, p0, p1 = _chain(map_, -1.0)
    inverse = Factored(np.eye(len(q0)) - map_.a)
    h20 = inverse.solve(map_.b(q0, q0))
    h11 = inverse.solve(map_.b(q0, q1) + h20)
    third = map_.curve(q0, h20)[2]  # C(q0,q0,q0) + 3 B(q0,h20)
    mixed = map_.c_twice(q1, q0).real + map_.b(q1, h20) + 2.0 * map_.b(q0, h11)
    return {
        "c": float(p0 @ third) / 6.0,
        "d": 0.5 * float(p0 @ mixed + p1 @ third),
        "convention": "return map (-w0 + w1, -w1 + c w0^3 + d w0^2 w1), (A+1) q1 = q0, p1 (A+1) = p0, "
        "p0.q1 = p1.q0 = 1, p1.q1 = 0, |q0| = 1 over the orbit (Kuznetsov 2004, section 9.5.3)",
    }


def one_to_three(map_: SectionMap) -> dict[str, Any]:
    """|b|, Re c and a of an orbit whose multipliers are third roots of one."""
    turn = np.exp(2j * np.pi / 3.0)
    q, p = map_.critical(turn)
    bqq = map_.b_complex(q, q)
    b = 0.5 * complex(p @ bqq.conj())  # p.B(q*,q*)/2
    one = np.eye(len(q))
    h11 = np.linalg.solve(one - map_.a, map_.b_complex(q, q.conj()))
    shifted = np.conj(turn) * one - map_.a  # singular along q*
    right = bqq - 2.0 * np.conj(b) * q.conj()
    bordered = np.block([[shifted, q.conj()[:, None]], [p.conj()[None, :], np.zeros((1, 1))]])
    h20 = np.linalg.solve(bordered, np.append(right, 0.0))[:-1]
    drive = map_.c_squared(q) + map_.b_complex(q.conj(), h20) + 2.0 * map_.b_complex(q, h11)
    c = float((np.conj(turn) * 0.5 * (p @ drive)).real)
    found = {"b": abs(b), "c": c}
    if abs(b) > NONE * map_.unit_of_cubic(q) ** 0.5:
        found["a"] = c / abs(b) ** 2 - 1.0
    return {
        **found,
        "convention": "return map exp(2 pi i/3) w (1 + (c + i ..) |w|^2) + b w*^2: |b|, c real, "
        f"a = c/|b|^2 - 1, {SCALED} (Kuznetsov 2004, section 9.5.4)",
    }


def one_to_four(map_: SectionMap) -> dict[str, Any]:
    """A = -i c / |d| and |d| of an orbit whose multipliers are i and -i."""
    q, p = map_.critical(1j)
    one = np.eye(len(q))
    bqq = map_.b_complex(q, q)
    h11 = np.linalg.solve(one - map_.a, map_.b_complex(q, q.conj()))
    h20 = np.linalg.solve(-one - map_.a, bqq)
    drive = map_.c_squared(q) + map_.b_complex(q.conj(), h20) + 2.0 * map_.b_complex(q, h11)
    c = 0.5 * complex(p @ drive)
    cube = (map_.c_cubed(q) + 3.0 * map_.b_complex(q, h20)).conj()
    d = complex(p @ cube) / 6.0
    found = {"d": abs(d)}
    if abs(d) > NONE * map_.unit_of_cubic(q):
        ratio = -1j * c / abs(d)
        found |= {"A_real": ratio.real, "A_imag": ratio.imag}
    return {
        **found,
        "convention": f"return map i w + c w |w|^2 + d w*^3: |d|, A = -i c/|d|, {SCALED} (Kuznetsov 2004, "
        "section 9.5.5)",
    }


def fold_and_flip(map_: SectionMap) -> dict[str, Any]:
    """a, b and e of an orbit with the multipliers one and minus one."""
    (q0, p0), (q1, p1) = map_.critical(1.0), map_.critical(-1.0)
    return {
        "a": float(p0 @ map_.b(q0, q0)),
        "b": float(p0 @ map_.b(q1, q1)),
        "e": float(p1 @ map_.b(q0, q1)),
        "convention": "return map (w0 + a w0^2/2 + b w1^2/2, -w1 + e w0 w1), a = p0.B(q0,q0), "
        f"b = p0.B(q1,q1), e = p1.B(q0,q1), {SCALED} (Kuznetsov, Meijer & van Veen 2004)",
    }


def fold_and_torus(map_: SectionMap) -> dict[str, Any]:
    """s and theta of an orbit with the multiplier one and a pair on the unit circle."""
    (angle,) = _angles(map_, 1)
    turn = np.exp(1j * angle)
    (q0, p0), (q, p) = map_.critical(1.0), map_.critical(turn)
    f200 = 0.5 * float(p0 @ map_.b(q0, q0))
    f011 = float(p0 @ map_.b_complex(q, q.conj()).real)
    g110 = float((np.conj(turn) * (p @ map_.b_complex(q0.astype(complex), q))).real)
    found = {"angle": angle, "f200": f200, "f011": f011, "g110_real": g110}
    if f200 * f011 != 0.0:
        found |= {"s": float(np.sign(f200 * f011)), "theta": g110 / (2.0 * f200)}
    return {
        **found,
        "convention": "return map (w0 + f200 w0^2 + f011 |w1|^2, exp(i angle) w1 (1 + g110 w0)), "
        f"s = sign(f200 f011), theta = Re g110/(2 f200), {SCALED}; angle in rad per closure",
    }


def flip_and_torus(map_: SectionMap) -> dict[str, Any]:
    """Real parts of the cubic coefficients of an orbit with minus one and a pair on the unit circle."""
    (angle,) = _angles(map_, 1)
    turn, one = np.exp(1j * angle), np.eye(len(map_.a))
    (q0, p0), (q, p) = map_.critical(-1.0), map_.critical(turn)
    real = q0.astype(complex)
    h200 = np.linalg.solve(one - map_.a, map_.b(q0, q0)).astype(complex)
    h011 = np.linalg.solve(one - map_.a, map_.b_complex(q, q.conj())).real
    h110 = np.linalg.solve(-turn * one - map_.a, map_.b_complex(real, q))
    around = map_.c_twice(real, q.real) + map_.c_twice(real, q.imag)
    first = around.real + map_.b(q0, h011) + 2.0 * map_.b_complex(q.conj(), h110).real
    second = map_.c_twice(q, q0) + map_.b_complex(q, h200) + 2.0 * map_.b_complex(real, h110)
    found = {
        "p11": -cubic_of_flip(map_)[0],
        "p12": -float(p0 @ first),
        "p21": 0.5 * float((np.conj(turn) * (p @ second)).real),
        "p22": cubic_of_torus(map_, angle)[0].real,
        "angle": angle,
    }
    form = "(-w1 (1 + p11 w1^2 + p12 |w2|^2), exp(i angle) w2 (1 + p21 w1^2 + p22 |w2|^2))"
    return _amplitudes(found, form)


def two_tori(map_: SectionMap) -> dict[str, Any]:
    """Real parts of the cubic coefficients of an orbit with two pairs on the unit circle."""
    angles = sorted(_angles(map_, 2), reverse=True)
    pairs = [(np.exp(1j * angle), *map_.critical(np.exp(1j * angle))) for angle in angles]
    found = {
        "p11": cubic_of_torus(map_, angles[0])[0].real,
        "p12": _of_other_pair(map_, pairs[0], pairs[1]),
        "p21": _of_other_pair(map_, pairs[1], pairs[0]),
        "p22": cubic_of_torus(map_, angles[1])[0].real,
        "angle_1": angles[0],
        "angle_2": angles[1],
    }
    form = (
        "(exp(i angle_1) w1 (1 + p11 |w1|^2 + p12 |w2|^2), exp(i angle_2) w2 (1 + p21 |w1|^2 + p22 |w2|^2)), "
        "angle_1 > angle_2"
    )
    return _amplitudes(found, form)


def _of_other_pair(
    map_: SectionMap, own: tuple[complex, np.ndarray, np.ndarray], other: tuple[Any, np.ndarray, Any]
) -> float:
    """Re of the coefficient of w1 |w2|^2, over the first multiplier; each pair as (multiplier, q, p)."""
    (turn, q, p), (turn2, r, _) = own, other
    one = np.eye(len(q))
    h0011 = np.linalg.solve(one - map_.a, map_.b_complex(r, r.conj()))
    h1010 = np.linalg.solve(turn * turn2 * one - map_.a, map_.b_complex(q, r))
    h1001 = np.linalg.solve(turn * np.conj(turn2) * one - map_.a, map_.b_complex(q, r.conj()))
    drive = map_.c_twice(q, r.real) + map_.c_twice(q, r.imag) + map_.b_complex(q, h0011)
    drive = drive + map_.b_complex(r, h1001) + map_.b_complex(r.conj(), h1010)
    return float((np.conj(turn) * (p @ drive)).real)


def _amplitudes(found: dict[str, Any], form: str) -> dict[str, Any]:
    """Coefficients with the ratios that say how both amplitudes act on each other."""
    if found["p11"] * found["p22"] != 0.0:
        found |= {"theta": found["p12"] / found["p22"], "delta": found["p21"] / found["p11"]}
    convention = f"return map {form}, real parts, theta = p12/p22, delta = p21/p11, {SCALED}"
    return {**found, "convention": f"{convention}; angles in rad per closure"}


def _angles(map_: SectionMap, count: int) -> list[float]:
    """The angles of the pairs of multipliers nearest to the unit circle.

    Raises
    ------
    NotFinite
        If there are not so many.
    """
    found = [value for value in np.linalg.eigvals(map_.a) if value.imag > 0.0]
    near = sorted(found, key=lambda value: abs(abs(value) - 1.0))[:count]
    if len(near) < count or any(abs(abs(value) - 1.0) > ON_CIRCLE for value in near):
        raise NotFinite("the pair of multipliers is not to be told from the others")
    return [float(np.angle(value)) for value in near]


def _chain(map_: SectionMap, value: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """q0, q1, p0, p1 of a double multiplier with a single direction: (A - m) q1 = q0, p1 (A - m) = p0.

    p0 q1 = p1 q0 = 1, p1 q1 = 0, |q0| = 1 over the orbit, its largest entry positive.

    Raises
    ------
    NotFinite
        If it has two directions.
    """
    shifted = map_.a - value * np.eye(len(map_.a))
    u, _, vh = np.linalg.svd(shifted)
    q0, p0 = vh[-1], u[:, -1]
    q0 = q0 * np.sign(q0[np.argmax(np.abs(q0))]) / map_.size(q0)
    bordered = Factored(np.block([[shifted, p0[:, None]], [q0[None, :], np.zeros((1, 1))]]))
    q1 = bordered.solve(np.append(q0, 0.0))[:-1]
    length = float(p0 @ q1)
    if not abs(length) > SINGLE * float(np.linalg.norm(q1)):
        raise NotFinite("the double multiplier has two directions")
    p0 = p0 / length
    p1 = bordered.solve_adjoint(np.append(p0, 0.0))[:-1]
    return q0, q1, p0, p1 - (p1 @ q1) * p0
