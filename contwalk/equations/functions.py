"""The functions that expressions may call: how many arguments, their values, and what a plugin calls them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple


class Known(NamedTuple):
    """A function: the numbers of its arguments, its value of floats, and what is written for it in Python."""

    arguments: tuple[int, ...]
    of_float: Callable[..., float]
    written: str


def _heaviside(x: float) -> float:
    return 1.0 if x >= 0.0 else 0.0


def _sign(x: float) -> float:
    return math.copysign(1.0, x) if x else 0.0


def _np(written: str, of_float: Callable[..., float], arguments: int = 1) -> Known:
    holes = ", ".join(["{}"] * arguments)
    return Known((arguments,), of_float, f"np.{written}({holes})")


def _math(written: str, of_float: Callable[..., float]) -> Known:
    return Known((1,), of_float, f"math.{written}({{}})")


_SAME = "sin cos tan sinh cosh tanh exp expm1 log1p log2 log10 sqrt cbrt floor ceil trunc degrees radians"
_ARCS = "sin cos tan sinh cosh tanh"

FUNCTIONS: dict[str, Known] = {
    **{name: _np(name, getattr(math, name)) for name in _SAME.split()},
    "fabs": Known((1,), abs, "np.abs({})"),
    **{f"a{name}": _np(f"arc{name}", getattr(math, f"a{name}")) for name in _ARCS.split()},
    **{name: _math(name, getattr(math, name)) for name in ("erf", "erfc", "gamma", "lgamma")},
    "log": Known((1, 2), math.log, "np.log({})"),
    "ln": _np("log", math.log),
    "atan2": _np("arctan2", math.atan2, 2),
    "hypot": _np("hypot", math.hypot, 2),
    "fmod": _np("fmod", math.fmod, 2),
    "copysign": _np("copysign", math.copysign, 2),
    "pow": Known((2,), math.pow, "{} ** {}"),
    "abs": _np("abs", abs),
    "sign": _np("sign", _sign),
    "heav": Known((1,), _heaviside, "np.heaviside({}, 1.0)"),
    "min": _np("minimum", min, 2),
    "max": _np("maximum", max, 2),
    "mod": Known((2,), lambda a, b: a - b * math.floor(a / b), "{} % {}"),
}
CONSTANTS = {"pi": math.pi}
# Those that take one number at a time.
NUMBERS_ALONE = ("erf", "erfc", "gamma", "lgamma")
