"""The periodic Schur form by plane rotations, in loops that numba compiles; see `periodic_schur`.

Factors are row-major complex matrices (r, r), one after the other in the order in which they act; the last
one is brought to Hessenberg form, and then, like the others before it, to a triangle. A rotation of
neighbouring rows of the last factor is undone by one of the first factor's columns; that leaves an entry
below its diagonal, which a rotation of its rows removes, and so on until the last one's columns.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import complexes, inlined

MOST_SWEEPS = 60
# Every so many sweeps without a new eigenvalue the shift is another one, against cycles.
EXCEPTIONAL = 11
# An eigenvalue this small against the block that it is in is not known from it.
GRADED = 1e-6
EPSILON = 2.0**-52
# A factor that is singular to rounding has this part of its size instead of a zero: zeros stop the sweeps.
NO_ZERO = 0.1 * EPSILON
# Powers of two further apart than this are as good as zero beside each other.
FARTHEST = 1000
NOT_CONVERGED = -1


@inlined
def _size(value: complex) -> float:
    """Modulus; nothing overflows on the way."""
    a, b = abs(value.real), abs(value.imag)
    larger, smaller = max(a, b), min(a, b)
    if smaller == 0.0:
        return larger
    ratio = smaller / larger
    return larger * math.sqrt(1.0 + ratio * ratio)


@inlined
def _root(value: complex) -> complex:
    """The square root with a real part that is not negative."""
    size = _size(value)
    if size == 0.0:
        return 0j
    real = math.sqrt(0.5 * (size + abs(value.real)))
    imaginary = 0.5 * value.imag / real
    if value.real >= 0.0:
        return complex(real, imaginary)
    return complex(abs(imaginary), real if value.imag >= 0.0 else -real)


@inlined
def _power(size: float) -> int:
    """The power of two that a number is one half to one times of; 0 of zero."""
    power = 0
    if not 0.0 < size < math.inf:
        return power
    while size >= 1.0:
        far = 64 if size >= 2.0**64 else 1
        size, power = size * (2.0**-64 if far == 64 else 0.5), power + far
    while size < 0.5:
        far = 64 if size < 2.0**-64 else 1
        size, power = size * (2.0**64 if far == 64 else 2.0), power - far
    return power


@inlined
def _two_to(power: int) -> float:
    """A power of two, none below those of `FARTHEST`."""
    result, left = 1.0, max(power, -FARTHEST)
    while left > 0:
        far = min(left, 64)
        result, left = result * (2.0**64 if far == 64 else 2.0), left - (64 if far == 64 else 1)
    while left < 0:
        far = -max(left, -64)
        result, left = result * (2.0**-64 if far == 64 else 0.5), left + (64 if far == 64 else 1)
    return result


@inlined
def _times(factor: float, value: complex) -> complex:
    """A real multiple, part by part: zero times infinity is not met."""
    return complex(factor * value.real, factor * value.imag)


@inlined
def _rotation(a: complex, b: complex) -> tuple[complex, complex]:
    """(c, s): the unitary matrix [[c*, s*], [-s, c]] takes (a, b) to a multiple of (1, 0)."""
    larger = max(_size(a), _size(b))
    if larger == 0.0:
        return 1.0 + 0j, 0j
    first, second = _size(a) / larger, _size(b) / larger
    length = larger * math.sqrt(first * first + second * second)
    return complex(a.real / length, a.imag / length), complex(b.real / length, b.imag / length)


@inlined
def _rows(a: Any, r: int, k: int, first: int, c: complex, s: complex) -> None:
    """Rotate rows k and k + 1 of a factor, from a column on."""
    above, below = k * r, (k + 1) * r
    for j in range(first, r):
        x, y = a[above + j], a[below + j]
        a[above + j] = c.conjugate() * x + s.conjugate() * y
        a[below + j] = c * y - s * x


@inlined
def _columns(a: Any, r: int, k: int, end: int, c: complex, s: complex) -> None:
    """Undo the rotation in columns k and k + 1 of a factor, in its first rows."""
    for i in range(end):
        x, y = a[i * r + k], a[i * r + k + 1]
        a[i * r + k] = c * x + s * y
        a[i * r + k + 1] = c.conjugate() * y - s.conjugate() * x


@inlined
def _passed_on(chain: int, m: int, r: int, k: int, end: int, c: complex, s: complex) -> None:
    """Undo a rotation of rows k and k + 1 of the last factor by rotations of all, which stay triangles.

    The last one has entries in its first `end` rows of these columns.
    """
    for i in range(m - 1):
        a = complexes(chain + 16 * i * r * r, r * r)
        _columns(a, r, k, k + 2, c, s)
        c, s = _rotation(a[k * r + k], a[(k + 1) * r + k])
        _rows(a, r, k, k, c, s)
        a[(k + 1) * r + k] = 0j
    _columns(complexes(chain + 16 * (m - 1) * r * r, r * r), r, k, end, c, s)


@inlined
def _triangles(chain: int, m: int, r: int) -> None:
    """All factors but the last become triangles, one after the other."""
    for i in range(m - 1):
        a = complexes(chain + 16 * i * r * r, r * r)
        following = complexes(chain + 16 * (i + 1) * r * r, r * r)
        total = 0.0
        for j in range(r * r):
            total = max(total, _size(a[j]))
        for column in range(r - 1):
            for k in range(r - 2, column - 1, -1):
                if a[(k + 1) * r + column] != 0j:
                    c, s = _rotation(a[k * r + column], a[(k + 1) * r + column])
                    _rows(a, r, k, column, c, s)
                    a[(k + 1) * r + column] = 0j
                    _columns(following, r, k, r, c, s)
        for k in range(r):
            if a[k * r + k] == 0j:
                a[k * r + k] = complex(NO_ZERO * total, 0.0)


@inlined
def _hessenberg(chain: int, m: int, r: int) -> None:
    """The last factor becomes one of Hessenberg's form, and the others stay triangles."""
    last = complexes(chain + 16 * (m - 1) * r * r, r * r)
    for column in range(r - 2):
        for k in range(r - 2, column, -1):
            if last[(k + 1) * r + column] != 0j:
                c, s = _rotation(last[k * r + column], last[(k + 1) * r + column])
                _rows(last, r, k, column, c, s)
                last[(k + 1) * r + column] = 0j
                _passed_on(chain, m, r, k, r, c, s)


@inlined
def _shift(chain: int, m: int, r: int, high: int, exceptional: bool) -> tuple[complex, int]:
    """The eigenvalue of the trailing block of the product that is nearest to its corner: a number and the
    power of two that it is multiplied by, since the block may lie beyond the range of doubles.
    """
    p, q, u, v, exponent = 1.0 + 0j, 0j, 0j, 1.0 + 0j, 0  # the block's rows (p, q) and (u, v)
    for i in range(m):
        a = complexes(chain + 16 * i * r * r, r * r)
        above, below = (high - 1) * r + high - 1, high * r + high - 1
        p, u = a[above] * p + a[above + 1] * u, a[below] * p + a[below + 1] * u
        q, v = a[above] * q + a[above + 1] * v, a[below] * q + a[below + 1] * v
        power = max(_power(max(max(_size(p), _size(q)), max(_size(u), _size(v)))), -FARTHEST)
        scale = _two_to(-power)
        p, q, u, v = _times(scale, p), _times(scale, q), _times(scale, u), _times(scale, v)
        exponent += power
    if exceptional:
        return complex(_size(u) + _size(v), 0.0), exponent
    middle, apart = _times(0.5, p + v), _root(_times(0.25, (p - v) * (p - v)) + q * u)
    one, other = middle + apart, middle - apart
    # The smaller of two graded eigenvalues is mostly rounding of the product; shifted by the larger
    # one a sweep carries nothing of the smaller to the corner. Without a shift they separate by themselves,
    # as fast as they are graded.
    if min(_size(one), _size(other)) <= GRADED * max(_size(one), _size(other)):
        return 0j, 0
    return (one if _size(one - v) <= _size(other - v) else other), exponent


@inlined
def _begun(chain: int, m: int, r: int, low: int, shift: complex, exponent: int) -> tuple[complex, complex]:
    """The first column of the shifted product, in rows low and low + 1."""
    last = complexes(chain + 16 * (m - 1) * r * r, r * r)
    a, b = last[low * r + low], last[(low + 1) * r + low]
    if shift == 0j:
        return a, b
    product, own = 1.0 + 0j, 0
    for i in range(m - 1):
        product = product * complexes(chain + 16 * i * r * r, r * r)[low * r + low]
        power = _power(_size(product))
        product, own = _times(_two_to(-power), product), own + power
    # Whichever is larger is left as it is, so that nothing overflows.
    ahead = own - exponent
    factor = _times(_two_to(max(min(ahead, 0), -FARTHEST)), product)
    return a * factor - _times(_two_to(max(min(-ahead, 0), -FARTHEST)), shift), b * factor


@inlined
def _sweep(chain: int, m: int, r: int, low: int, high: int, a: complex, b: complex) -> None:
    """One QR sweep on rows and columns low..high: a bulge is chased through all factors."""
    last = complexes(chain + 16 * (m - 1) * r * r, r * r)
    for k in range(low, high):
        if k > low:
            a, b = last[k * r + k - 1], last[(k + 1) * r + k - 1]
        c, s = _rotation(a, b)
        _rows(last, r, k, max(k - 1, 0), c, s)
        if k > low:
            last[(k + 1) * r + k - 1] = 0j
        _passed_on(chain, m, r, k, min(k + 3, r), c, s)  # Hessenberg's form, and the bulge


@inlined
def _deflated(last: Any, r: int) -> None:
    """Entries below the diagonal that are nothing beside their neighbours become zero."""
    largest = 0.0
    for j in range(r * r):
        largest = max(largest, _size(last[j]))
    for k in range(r - 1):
        near = _size(last[k * r + k]) + _size(last[(k + 1) * r + k + 1])
        if near == 0.0:  # where both neighbours vanish, the whole factor is the measure
            near = largest
        if _size(last[(k + 1) * r + k]) <= EPSILON * near:
            last[(k + 1) * r + k] = 0j


@inlined
def _schur(chain: int, m: int, r: int) -> int:
    """Bring m factors to triangles; how many sweeps that took, or `NOT_CONVERGED`."""
    last = complexes(chain + 16 * (m - 1) * r * r, r * r)
    _triangles(chain, m, r)
    _hessenberg(chain, m, r)
    high, sweeps, all_sweeps = r - 1, 0, 0
    while high > 0:
        _deflated(last, r)
        if last[high * r + high - 1] == 0j:
            high, sweeps = high - 1, 0
            continue
        low = high - 1
        while low > 0 and last[low * r + low - 1] != 0j:
            low -= 1
        if sweeps >= MOST_SWEEPS:
            return NOT_CONVERGED
        sweeps, all_sweeps = sweeps + 1, all_sweeps + 1
        shift, exponent = _shift(chain, m, r, high, sweeps % EXCEPTIONAL == EXCEPTIONAL - 1)
        a, b = _begun(chain, m, r, low, shift, exponent)
        _sweep(chain, m, r, low, high, a, b)
    return all_sweeps


def eigenvalues(chain: int, m: int, r: int, values: int) -> int:
    """Bring m factors to triangles, and multiply their diagonals; how many sweeps that took, or
    `NOT_CONVERGED`.

    Partial products may lie far beyond the range of doubles where the whole lies in it: powers of two are
    taken out on the way, and change no digit.
    """
    sweeps, found = _schur(chain, m, r), complexes(values, r)
    for k in range(r):
        product, exponent = 1.0 + 0j, 0
        for i in range(m):
            product = product * complexes(chain + 16 * i * r * r, r * r)[k * r + k]
            power = _power(_size(product))
            product, exponent = _times(_two_to(-power), product), exponent + power
        while exponent != 0:  # twice what `_two_to` reaches is beyond what a double holds
            power = min(max(exponent, -FARTHEST), FARTHEST)
            product, exponent = _times(_two_to(power), product), exponent - power
        found[k] = product
    return sweeps
