"""Eigenvalues between the points of a branch: curves, not corners.

A simple eigenvalue is a smooth function of the arclength; between two points it is a cubic with Akima's
slopes. Two that meet and part again are not, but their sum and their product are: so a pair, and what becomes
of it on the real axis, is interpolated by these. Where a cubic would run off, farther than the values change
nearby, a segment stays straight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.plotting.smooth_curves import FARTHEST, akima

PROBED, DENSE = 8, 512  # samples of a segment that tell whether it is bent; among which its points are chosen
FLAT = 1e-3  # how far off its chord a curve is still straight, in parts of its size
STEP, MOST = 0.08, 80  # from point to point of a curve, in parts of its size; points of a segment
LEAST = 0.02  # size of an eigenvalue that passes zero, in parts of the sizes at its ends
RATIO = 1e3  # of real ones that still count as a pair: sums of others have lost the smaller one's digits


@dataclass(frozen=True, eq=False)
class Loci:
    """Eigenvalues along a branch, finer than its rows.

    Parameters
    ----------
    values : array of shape (k, m), complex
        A column for each eigenvalue.
    across : array of shape (k,)
        What they are drawn over.
    rows : array of shape (k,), int
        The row of the branch that each lies on or comes after.
    """

    values: np.ndarray
    across: np.ndarray
    rows: np.ndarray


def smooth_loci(s: np.ndarray, tracked: np.ndarray, across: np.ndarray, slope: np.ndarray) -> Loci:
    """Tracked spectra, shape (k, m), as smooth functions of the arclength; so is `across`, with its slope."""
    if len(s) < 2:
        return Loci(tracked, across, np.arange(len(s)))
    with np.errstate(all="ignore"):  # what is not finite is not drawn
        spectra, line = _Spectra(s, tracked), _Cubics(s, across, slope)
        probes, dense = (np.linspace(0.0, 1.0, number + 1) for number in (PROBED, DENSE))
        finite = across[np.isfinite(across)]
        width = float(np.ptp(finite)) if len(finite) else 0.0
        values, places, rows = [], [], []
        for row in range(len(s)):
            values.append(tracked[row : row + 1])
            places.append(across[row : row + 1])
            rows.append(row)
            if row + 1 == len(s) or not _bent(spectra.at(row, probes), line.at(row, probes), width):
                continue
            many, wide = spectra.at(row, dense), line.at(row, dense)
            inner = _spread(many, wide, width)
            values.append(many[inner])
            places.append(wide[inner])
            rows += [row] * len(inner)
    return Loci(np.concatenate(values), np.concatenate(places), np.array(rows))


class _Cubics:
    """A quantity over the arclength, with its slopes or Akima's."""

    def __init__(self, s: np.ndarray, values: np.ndarray, slopes: np.ndarray | None = None) -> None:
        self._values, self._h = values, np.diff(s)
        self._slopes = akima(s, values) if slopes is None else slopes
        change = np.abs(np.diff(values))
        self._reach = FARTHEST * np.nanmax(
            [change, np.append(change[1:], 0.0), np.append(0.0, change[:-1])], axis=0
        )

    def at(self, row: int, u: np.ndarray) -> np.ndarray:
        """Values at shares u of a segment."""
        a, b = self._values[row], self._values[row + 1]
        ma, mb = self._h[row] * self._slopes[row], self._h[row] * self._slopes[row + 1]
        d = b - a
        straight = a + u * d
        curve = a + u * (ma + u * (3.0 * d - 2.0 * ma - mb + u * (ma + mb - 2.0 * d)))
        return curve if np.abs(curve - straight).max() <= self._reach[row] else straight


class _Spectra:
    """All eigenvalues over the arclength."""

    def __init__(self, s: np.ndarray, tracked: np.ndarray) -> None:
        self._tracked = tracked
        self._parts = [(_Cubics(s, column.real), _Cubics(s, column.imag)) for column in tracked.T]
        self._pairs: dict[int, list[tuple[int, int]]] = {}
        self._sums: dict[tuple[int, int], tuple[_Cubics, _Cubics]] = {}
        for pair, segments in _pairs(tracked).items():
            one, other = tracked[:, pair[0]], tracked[:, pair[1]]
            self._sums[pair] = _Cubics(s, (one + other).real), _Cubics(s, (one * other).real)
            for row in segments:
                self._pairs.setdefault(row, []).append(pair)

    def at(self, row: int, u: np.ndarray) -> np.ndarray:
        """All at shares u of a segment, of shape (u, m)."""
        found = np.stack([real.at(row, u) + 1j * imag.at(row, u) for real, imag in self._parts], axis=1)
        for one, other in self._pairs.get(row, []):
            total, product = self._sums[one, other]
            middle = 0.5 * total.at(row, u)
            apart = middle**2 - product.at(row, u)
            difference = (self._tracked[row : row + 2, one] - self._tracked[row : row + 2, other]).sum()
            sign = np.where(apart < 0.0, _sign(difference.imag), _sign(difference.real))
            root = sign * np.sqrt(apart.astype(complex))
            found[:, one], found[:, other] = middle + root, middle - root
        return found


def _sign(number: float) -> float:
    return -1.0 if number < 0.0 else 1.0


def _pairs(tracked: np.ndarray) -> dict[tuple[int, int], list[int]]:
    """Columns that are a complex pair at one end of a segment, or beside such; with the segments."""
    k, m = tracked.shape
    found: dict[tuple[int, int], list[int]] = {}
    for one in range(m):
        for other in range(one + 1, m):
            a, b = tracked[:, one], tracked[:, other]
            finite = np.isfinite(a) & np.isfinite(b)
            pair = finite & (a.imag != 0.0) & (a == b.conj())
            if not pair.any():
                continue
            alike = (np.abs(a) < RATIO * np.abs(b)) & (np.abs(b) < RATIO * np.abs(a))
            real = finite & (a.imag == 0.0) & (b.imag == 0.0) & alike
            meeting = (pair[:-1] & (pair | real)[1:]) | ((pair | real)[:-1] & pair[1:])
            beside = np.zeros(k - 1, dtype=bool)
            beside[1:] |= meeting[:-1] & real[1:-1] & real[2:]
            beside[:-1] |= meeting[1:] & real[:-2] & real[1:-1]
            found[one, other] = np.flatnonzero(meeting | beside).tolist()
    return found


def _bent(values: np.ndarray, across: np.ndarray, width: float) -> bool:
    """Whether a segment must be drawn as a curve, by samples of it from end to end."""
    u = np.linspace(0.0, 1.0, len(across))[:, None]
    size = np.maximum(np.abs(values[0]), np.abs(values[-1]))
    off = np.abs(values - (values[0] + u * (values[-1] - values[0]))) > FLAT * size
    line = across[:, None]
    aside = np.abs(line - (line[0] + u * (line[-1] - line[0]))) > FLAT * width
    return bool(off.any() or aside.any())


def _spread(values: np.ndarray, across: np.ndarray, width: float) -> np.ndarray:
    """Numbers of the inner samples, out of many, from one to the next of which little changes."""
    size = np.abs(values)
    size = np.maximum(np.maximum(size[:-1], size[1:]), LEAST * np.maximum(size[0], size[-1]))
    change = np.nan_to_num(np.abs(np.diff(values, axis=0)) / size, nan=0.0, posinf=0.0).max(axis=1)
    if width > 0.0:
        change = change + np.abs(np.diff(across)) / width
    way = np.append(0.0, np.cumsum(change))
    number = int(np.clip(np.ceil(way[-1] / STEP), 2, MOST))
    chosen = np.searchsorted(way, way[-1] * np.arange(1, number) / number)
    return np.unique(np.clip(chosen, 1, len(values) - 2))
