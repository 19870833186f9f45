"""Factors of a closure between the quotients by what is left out of them: the flow's direction and others."""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.entry_points import Entry

QUOTIENTS = Entry("contwalk.problems.orbit.quotient_loops", "quotients", "q", "qqqqqqq")


def warmup() -> None:
    """Compile the loops, or find them compiled."""
    _ = QUOTIENTS.address


def between(
    factors: np.ndarray, begin: np.ndarray, end: np.ndarray, carried: int
) -> tuple[np.ndarray, np.ndarray | None]:
    """Each factor between the quotient spaces at its ends, in orthonormal bases of those at the starts.

    Parameters
    ----------
    factors : ndarray, shape (m, n, n)
    begin, end : ndarray, shape (m, n, k)
        What is left out where each segment begins, and where it ends.
    carried : int
        How many of these the factors carry along.

    Returns
    -------
    found : ndarray, shape (m, n - k, n - k)
    others : ndarray or None, shape (m, n - k, n - k)
        The same if, where each segment ends, what is carried along is left out; None where nothing is, or
        where that is zero.
    """
    m, n, k = begin.shape
    shape = m, n - k, n - k
    found, others = np.empty(shape), np.empty(shape)
    sizes = np.array([m, n, k, carried], dtype=np.int64)
    # Bases of all segments; of one, another basis, what is moved and carried, and a vector.
    work = np.empty((m + 4) * n * n + n)
    given = [np.ascontiguousarray(each, dtype=float) for each in (factors, begin, end)]
    fine = QUOTIENTS(*map(address, (*given, sizes, found, others, work)))
    return found, others if carried and fine else None
