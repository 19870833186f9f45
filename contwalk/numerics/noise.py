"""Noise in the last bits, to see which decisions hang on them: off unless `CONTWALK_NOISE` names a seed.

On another processor the same program rounds otherwise: libraries choose other kernels. With a seed, what
NumPy's linear algebra gives and what compiled vector fields give is multiplied by 1 + k eps, with a whole
number k from -2 to 2. It is drawn from the seed and from the bits of the number itself: what is computed
twice comes out alike twice, zeros stay zeros, and numbers of one size have the same noise, whatever their
sign. So mirror images stay images and conjugates stay conjugates, as they do on any processor.

What an operation gives exactly (a state that is handed on as it is, a constant) stays as it is.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.numerics.linear import EPSILON

VARIABLE = "CONTWALK_NOISE"
# Largest k.
MOST = 2
# Multiplying by an odd number mixes bits upwards (D. Knuth, The Art of Computer Programming 3, 6.4: 2^64 over
# the golden ratio); the uppermost choose k.
MIXER = 0x9E3779B97F4A7C15
_WORD, _SIZE, _UPPER = (1 << 64) - 1, (1 << 63) - 1, 32
_NAMES = ("solve", "inv", "pinv", "lstsq", "eig", "eigh", "eigvals", "eigvalsh", "svd", "qr")


def _seed() -> int | None:
    """The seed that the environment names; None without noise."""
    given = os.environ.get(VARIABLE, "")
    if not given:
        return None
    if not (given.isascii() and given.isdecimal()):
        raise ContwalkError(
            f"The environment's {VARIABLE} is '{given}', and a seed of noise is a whole number from 0 on.",
            f"Write {VARIABLE}=1, or leave it out to compute without noise.",
        )
    return int(given)


SEED = _seed()


def drawn(bits: int, seed: int) -> int:
    """k of a float, of which the bits are given without its sign."""
    return (((bits + 2 * seed + 1) * MIXER & _WORD) >> _UPPER) % (2 * MOST + 1) - MOST


def noisy(value: Any) -> Any:
    """One number, real or complex, or another object as it is, with the noise of the seed that is set."""
    if SEED is None:
        return value
    if isinstance(value, complex):
        return complex(noisy(value.real), noisy(value.imag))
    if not isinstance(value, float):
        return value
    (bits,) = struct.unpack("<Q", struct.pack("<d", value))
    return value * (1.0 + drawn(bits & _SIZE, SEED) * EPSILON)


def noisy_array(array: np.ndarray, seed: int) -> np.ndarray:
    """An array of floats or of complex numbers, of any shape, with noise; others as they are."""
    if array.dtype == np.complex128:
        parts = noisy_array(np.ascontiguousarray(array).reshape(-1).view(float), seed)
        return parts.view(complex).reshape(array.shape)
    if array.dtype != np.float64:
        return array
    bits = np.ascontiguousarray(array).view(np.uint64) & np.uint64(_SIZE)
    mixed = (bits + np.uint64(2 * seed + 1)) * np.uint64(MIXER)
    k = (mixed >> np.uint64(_UPPER)).astype(np.int64) % (2 * MOST + 1) - MOST
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(array * (1.0 + k * EPSILON))


def _with_noise(function: Callable[..., Any], seed: int) -> Callable[..., Any]:
    """One of NumPy's functions whose results have noise."""

    @wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        found = function(*arguments, **options)
        if isinstance(found, tuple):
            parts = [noisy_array(part, seed) if isinstance(part, np.ndarray) else part for part in found]
            return type(found)(*parts) if hasattr(found, "_fields") else tuple(parts)
        return noisy_array(found, seed) if isinstance(found, np.ndarray) else noisy(found)

    return call


def _begin() -> None:
    """Give NumPy's linear algebra the noise of the seed, whoever asks it from now on."""
    if SEED is not None:
        for name in _NAMES:
            setattr(np.linalg, name, _with_noise(getattr(np.linalg, name), SEED))


def rounding_code(name: str) -> str:
    """LLVM IR of a function `double name(double)` that multiplies by the noise of the seed."""
    first, modulus = 2 * (SEED or 0) + 1, 2 * MOST + 1
    factor = f"0x{struct.unpack('<Q', struct.pack('<d', EPSILON))[0]:016X}"
    return f"""\
define internal double @{name}(double %v) #0 {{
  %bits = bitcast double %v to i64
  %size = and i64 %bits, {_SIZE}
  %other = add i64 %size, {first}
  %mixed = mul i64 %other, {MIXER - (1 << 64)}
  %upper = lshr i64 %mixed, {_UPPER}
  %rest = urem i64 %upper, {modulus}
  %k = sub i64 %rest, {MOST}
  %whole = sitofp i64 %k to double
  %part = fmul double %whole, {factor}
  %all = fadd double 1.0, %part
  %result = fmul double %v, %all
  ret double %result
}}
"""


_begin()
