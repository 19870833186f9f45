"""Numbers and texts as a page carries them: small, and the same for the same numbers.

Neighbouring orbits and neighbouring instants differ by little. A table of whole numbers is written as what
its entry differs from what the entries before it in time, and of the orbit before it, let one expect; these
small numbers take a byte each, and what repeats itself among the bytes is taken out (RFC 1950 and 1951).
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np


def predicted(values: np.ndarray, before: np.ndarray | None) -> np.ndarray:
    """What entries (k, c) differ from their prediction by the entry before, and by both of an earlier table.

    Parameters
    ----------
    values : ndarray of int, shape (k, c)
        In the order of time.
    before : ndarray of int, shape (j, c), optional
        The same columns of the orbit before.
    """
    steps = np.diff(values, axis=0, prepend=np.zeros((1, values.shape[1]), dtype=values.dtype))
    if before is None:
        return steps
    both = min(len(values), len(before))
    expected = np.diff(before[:both], axis=0, prepend=np.zeros((1, values.shape[1]), dtype=values.dtype))
    steps[:both] -= expected
    return steps


def varints(values: Sequence[int] | np.ndarray) -> bytes:
    """Whole numbers of either sign, of any shape (..., c), seven bits a byte, the lowest first."""
    numbers = np.asarray(values, dtype=np.int64).ravel()
    folded = np.where(numbers < 0, -2 * numbers - 1, 2 * numbers).astype(np.uint64)
    if not len(folded) or folded.max() < 128:
        return folded.astype(np.uint8).tobytes()
    out = bytearray()
    for number in folded.tolist():
        while number > 127:
            out.append(number & 127 | 128)
            number >>= 7
        out.append(number)
    return bytes(out)


def packed(header: Any, body: bytes = b"") -> str:
    """A header of plain JSON values and bytes as a text of letters, digits, `+`, `/` and `=`."""
    text = json.dumps(header, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode("utf-8")
    whole = len(text).to_bytes(4, "little") + text + body
    return base64.b64encode(zlib.compress(whole, 9)).decode("ascii")


def short(values: np.ndarray) -> list[float | None]:
    """Numbers, shape (k,), to nine digits, as a screen needs them; None for what is not finite."""
    return [float(f"{value:.9g}") if np.isfinite(value) else None for value in values.tolist()]
