"""Linear algebra on one thread: the same digits whatever a machine or its user lets a library take.

A factorization that threads share is cut into other blocks, and rounds otherwise. On matrices as small as
here threads cost more than they gain as well.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any, TypeVar

import numpy as np

# How libraries are asked for their number of threads, and told: NumPy's own builds, OpenBLAS, and MKL.
_NAMES = (
    ("scipy_openblas_get_num_threads64_", "scipy_openblas_set_num_threads64_"),
    ("scipy_openblas_get_num_threads", "scipy_openblas_set_num_threads"),
    ("openblas_get_num_threads64_", "openblas_set_num_threads64_"),
    ("openblas_get_num_threads", "openblas_set_num_threads"),
    ("MKL_Get_Max_Threads", "MKL_Set_Num_Threads"),
)

# How OpenBLAS is asked for its kernels.
_CORES = (
    "scipy_openblas_get_corename64_",
    "scipy_openblas_get_corename",
    "openblas_get_corename64_",
    "openblas_get_corename",
)

Item = TypeVar("Item")


@cache
def _library() -> tuple[Callable[[], int], Callable[[int], Any]] | None:
    """What tells and sets the number of threads of NumPy's linear algebra; None of a library without any."""
    loaded = ctypes.CDLL(np.linalg._umath_linalg.__file__)
    for get, set_ in _NAMES:
        if hasattr(loaded, get) and hasattr(loaded, set_):
            return getattr(loaded, get), getattr(loaded, set_)
    return None


def count() -> int | None:
    """Threads that NumPy's linear algebra may take now; None of a library that is not known."""
    library = _library()
    return None if library is None else library[0]()


@cache
def kernel() -> str:
    """The kernels of NumPy's linear algebra, as OpenBLAS names them; '' of a library that does not."""
    loaded = ctypes.CDLL(np.linalg._umath_linalg.__file__)
    for name in _CORES:
        if hasattr(loaded, name):
            asked = getattr(loaded, name)
            asked.restype = ctypes.c_char_p
            return str((asked() or b"").decode())
    return ""


class _Holding:
    """How many computations want one thread at the moment, and how many there were before the first."""

    def __init__(self) -> None:
        self._lock, self._computations, self._before = Lock(), 0, 1

    def begin(self) -> None:
        """One more computation."""
        library = _library()
        with self._lock:
            if library is not None and self._computations == 0:
                self._before = library[0]()
                library[1](1)
            self._computations += 1

    def end(self) -> None:
        """One less; after the last there are as many threads as before."""
        library = _library()
        with self._lock:
            self._computations -= 1
            if library is not None and self._computations == 0:
                library[1](self._before)


_HOLDING = _Holding()


@contextmanager
def one_thread() -> Iterator[None]:
    """Within it, and in a function that it decorates, NumPy's linear algebra takes one thread."""
    _HOLDING.begin()
    try:
        yield
    finally:
        _HOLDING.end()


def each_on_one_thread(items: Iterator[Item]) -> Iterator[Item]:
    """The same items, each of them computed on one thread; between them there are as many as before."""
    nothing = object()
    while True:
        with one_thread():
            item = next(items, nothing)
        if item is nothing:
            return
        yield item  # type: ignore[misc]
