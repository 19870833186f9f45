"""For each row of the table of functions: how a plugin calls it, mpmath's own version, and points to try."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

from contwalk.fields.dispatch import dispatch

mp = mpmath.mp


@dataclass(frozen=True)
class Sample:
    """`plugin(*values)` as in a plugin; `truth(*values)` in mpmath; points away from kinks and poles."""

    plugin: Callable[..., Any]
    truth: Callable[..., Any]
    points: tuple[tuple[float, ...], ...]

    def of_array(self) -> Callable[..., Any]:
        """`plugin` as a function of one array."""
        plugin = self.plugin
        return lambda x: plugin(*x)


_ANY = ((0.7,), (-1.3,), (2.9,))
_POSITIVE = ((0.3,), (1.7,), (40.0,))
_UNIT = ((0.31,), (-0.77,), (0.05,))
_GAMMA = ((0.3,), (-1.7,), (6.4,))
_PAIRS = ((0.7, 1.9), (-1.3, 0.4), (2.1, -0.6))

SAMPLES: dict[str, Sample] = {
    "sin": Sample(math.sin, mp.sin, _ANY),
    "cos": Sample(math.cos, mp.cos, _ANY),
    "tan": Sample(math.tan, mp.tan, _ANY),
    "asin": Sample(math.asin, mp.asin, _UNIT),
    "acos": Sample(math.acos, mp.acos, _UNIT),
    "atan": Sample(math.atan, mp.atan, _ANY),
    "atan2": Sample(math.atan2, mp.atan2, _PAIRS),
    "sinh": Sample(math.sinh, mp.sinh, _ANY),
    "cosh": Sample(math.cosh, mp.cosh, _ANY),
    "tanh": Sample(math.tanh, mp.tanh, _ANY),
    "asinh": Sample(math.asinh, mp.asinh, _ANY),
    "acosh": Sample(math.acosh, mp.acosh, ((1.2,), (3.0,), (25.0,))),
    "atanh": Sample(math.atanh, mp.atanh, _UNIT),
    "exp": Sample(math.exp, mp.exp, _ANY),
    "expm1": Sample(math.expm1, mp.expm1, _ANY),
    "log": Sample(math.log, mp.log, _POSITIVE),
    "log1p": Sample(math.log1p, mp.log1p, ((0.3,), (-0.4,), (5.0,))),
    "log2": Sample(math.log2, lambda x: mp.log(x) / mp.log(2), _POSITIVE),
    "log10": Sample(math.log10, mp.log10, _POSITIVE),
    "sqrt": Sample(math.sqrt, mp.sqrt, _POSITIVE),
    "cbrt": Sample(math.cbrt, mp.cbrt, _POSITIVE),
    "pow": Sample(math.pow, lambda a, b: mp.exp(b * mp.log(a)), ((0.7, 1.9), (3.0, -0.5), (1.4, 2.0))),
    "hypot": Sample(math.hypot, lambda a, b: mp.sqrt(a * a + b * b), _PAIRS),
    "erf": Sample(math.erf, mp.erf, _ANY),
    "erfc": Sample(math.erfc, mp.erfc, _ANY),
    "gamma": Sample(math.gamma, mp.gamma, _GAMMA),
    "lgamma": Sample(math.lgamma, lambda x: mp.log(abs(mp.gamma(x))), _GAMMA),
    "polygamma": Sample(lambda x: dispatch("polygamma", (1.0, x)), lambda x: mp.psi(1, x), _GAMMA),
    "abs": Sample(abs, lambda x: x if x > 0 else -x, _ANY),
    "sign": Sample(np.sign, lambda x: mp.mpf(1 if x > 0 else -1), _ANY),
    "floor": Sample(np.floor, mp.floor, ((0.7,), (-1.3,), (2.4,))),
    "fmod": Sample(
        math.fmod, lambda a, b: a - b * (mp.floor(a / b) if a / b > 0 else mp.ceil(a / b)), _PAIRS
    ),
    "trunc": Sample(np.trunc, lambda x: mp.floor(x) if x > 0 else mp.ceil(x), ((0.7,), (-1.3,), (2.4,))),
    "min": Sample(min, lambda a, b: a if a <= b else b, _PAIRS),
    "max": Sample(max, lambda a, b: a if a >= b else b, _PAIRS),
}
