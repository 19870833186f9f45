"""Normal forms of strong resonances and of two multipliers at once, of maps made from their normal forms.

Each map is its normal form in coordinates that are bent by shears: what does not depend on coordinates, as
ratios and signs, must come back.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from contwalk.errors import NotFinite
from contwalk.problems.orbit import normal_forms_of_codim_two as forms
from contwalk.problems.orbit.normal_forms import SectionMap


class Jet:
    """A polynomial in s, up to s^3."""

    def __init__(self, c) -> None:
        self.c = np.array(c, dtype=float)

    def __add__(self, other):
        return Jet(self.c + (other.c if isinstance(other, Jet) else np.array([other, 0.0, 0.0, 0.0])))

    def __mul__(self, other):
        return Jet(np.convolve(self.c, other.c)[:4] if isinstance(other, Jet) else self.c * other)

    def __neg__(self):
        return Jet(-self.c)

    def __sub__(self, other):
        return self + -other

    __radd__, __rmul__ = __add__, __mul__


class OfFunction(SectionMap):
    """The map of a function of coordinates, at the origin."""

    def __init__(self, step: Callable[[Sequence], Sequence], size: int) -> None:
        self._step, self._size = step, size

    @property
    def a(self) -> np.ndarray:
        return np.column_stack([self.curve(unit)[0] for unit in np.eye(self._size)])

    @property
    def by_parameter(self) -> np.ndarray:
        return np.zeros(self._size)

    def curve(self, x1, x2=None, lam=0.0, order=3):
        bend = np.zeros(self._size) if x2 is None else x2
        image = self._step([Jet([0.0, u, 0.5 * v, 0.0]) for u, v in zip(x1, bend, strict=True)])
        return [math.factorial(k) * np.array([j.c[k] for j in image]) for k in range(1, order + 1)]

    def size(self, q: np.ndarray) -> float:
        return float(np.linalg.norm(q))

    def reach(self, q: np.ndarray) -> float:
        return 1.0


def bent(form: Callable[[Sequence], Sequence], size: int) -> OfFunction:
    """A map in coordinates bent by two shears and stretched, each with its inverse."""

    def out(w):
        w = list(w)
        w[0] = w[0] + 0.3 * w[-1] * w[-1] - 0.2 * w[1] * w[-1] + 0.1 * w[1] * w[1] * w[1] + 0.4 * w[-1]
        w[-1] = 1.7 * w[-1] + 0.25 * w[0] * w[0] - 0.15 * w[0] * w[0] * w[0]
        return w

    def back(w):
        w = list(w)
        w[-1] = (w[-1] - 0.25 * w[0] * w[0] + 0.15 * w[0] * w[0] * w[0]) * (1.0 / 1.7)
        w[0] = w[0] - (0.3 * w[-1] * w[-1] - 0.2 * w[1] * w[-1] + 0.1 * w[1] * w[1] * w[1] + 0.4 * w[-1])
        return w

    return OfFunction(lambda w: out(form(back(w))), size)


def times(turn: complex, x, y):
    """turn (x + i y)."""
    return turn.real * x - turn.imag * y, turn.imag * x + turn.real * y


def spun(turn: complex, c: complex, x, y, square):
    """turn (x + i y) (1 + c square)."""
    u, v = times(c, x * square, y * square)
    return times(turn, x + u, y + v)


def test_one_to_one() -> None:
    found = forms.one_to_one(bent(lambda w: (w[0] + w[1], w[1] + 0.7 * w[0] * w[0] - 0.4 * w[0] * w[1]), 2))
    assert found["b"] / found["a"] == pytest.approx(-0.4 / 0.7, rel=1e-12)
    assert found["s"] == -1.0


def test_one_to_two() -> None:
    """Where a quadratic change of coordinates makes the cubic form, both numbers grow alike with |q|."""
    cube = lambda w: w[0] * w[0] * (0.6 * w[0] - 1.1 * w[1])  # noqa: E731
    found = forms.one_to_two(bent(lambda w: (-w[0] + w[1], -w[1] + cube(w)), 2))
    assert found["d"] / found["c"] == pytest.approx(-1.1 / 0.6, rel=1e-10)
    assert found["c"] > 0.0


def test_one_to_three() -> None:
    b, c, turn = 0.8, -0.35, np.exp(2j * np.pi / 3.0)

    def form(w):
        x, y = w
        u, v = spun(turn, c + 0.2j, x, y, x * x + y * y)
        return u + b * (x * x - y * y), v - 2.0 * b * (x * y)

    found = forms.one_to_three(bent(form, 2))
    assert found["a"] == pytest.approx(c / b**2 - 1.0, rel=1e-10)
    assert found["c"] / found["b"] ** 2 == pytest.approx(c / b**2, rel=1e-10)


def test_one_to_four() -> None:
    c, d = 0.5 - 0.9j, 0.4 + 0.3j

    def form(w):
        x, y = w
        u, v = spun(1j, c / 1j, x, y, x * x + y * y)
        cube = x * x * x - 3.0 * (x * y * y), y * y * y - 3.0 * (x * x * y)  # of the conjugate
        p, q = times(d, *cube)
        return u + p, v + q

    found = forms.one_to_four(bent(form, 2))
    ratio = -1j * c / abs(d)
    assert (found["A_real"], found["A_imag"]) == pytest.approx((ratio.real, ratio.imag), rel=1e-10)


def test_fold_and_flip() -> None:
    def form(w):
        x, y = w
        return x + 0.5 * x * x * 0.6 - 0.45 * y * y, -y - 0.8 * (x * y)

    found = forms.fold_and_flip(bent(form, 2))
    assert found["a"] / found["e"] == pytest.approx(0.6 / -0.8, rel=1e-12)
    assert np.sign(found["b"] * found["e"]) == np.sign(-0.9 * -0.8)


def test_fold_and_torus() -> None:
    def form(w):
        z, x, y = w
        u, v = spun(np.exp(0.7j), 0.3 + 0.2j, x, y, z)
        return z - 0.4 * (z * z) + 0.9 * (x * x + y * y), u, v

    found = forms.fold_and_torus(bent(form, 3))
    assert found["angle"] == pytest.approx(0.7, rel=1e-12)
    assert found["s"] == -1.0
    assert found["theta"] == pytest.approx(0.3 / -0.8, rel=1e-10)


def test_flip_and_torus() -> None:
    def form(w):
        z, x, y = w
        r, s = z * z, x * x + y * y
        u, v = spun(np.exp(0.7j), 1.0, x, y, -0.6 * r + 0.25 * s)
        return -1.0 * (z + z * (0.5 * r - 0.8 * s)), u, v

    found = forms.flip_and_torus(bent(form, 3))
    assert (found["theta"], found["delta"]) == pytest.approx((-0.8 / 0.25, -0.6 / 0.5), rel=1e-10)
    assert found["p11"] > 0.0
    assert found["p22"] > 0.0


def test_two_tori() -> None:
    def form(w):
        x, y, z, t = w
        r, s = x * x + y * y, z * z + t * t
        first = spun(np.exp(2.1j), 1.0, x, y, 0.4 * r - 0.7 * s)
        second = spun(np.exp(0.9j), 1.0, z, t, 0.3 * r - 0.2 * s)
        return *first, *second

    found = forms.two_tori(bent(form, 4))
    assert (found["angle_1"], found["angle_2"]) == pytest.approx((2.1, 0.9), rel=1e-12)
    assert (found["theta"], found["delta"]) == pytest.approx((-0.7 / -0.2, 0.3 / 0.4), rel=1e-10)
    assert found["p11"] > 0.0 > found["p22"]


def test_a_double_multiplier_with_two_directions_has_no_form() -> None:
    with pytest.raises((NotFinite, np.linalg.LinAlgError)):
        forms.one_to_two(OfFunction(lambda w: (-w[0] + w[0] * w[0], -w[1] + w[0] * w[1]), 2))
