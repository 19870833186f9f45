"""What defines a special point, as functions that vanish there: of eigenvalues, and of singular equations.

Which eigenvalues are meant is what the record itself says: those of its own spectrum that are critical.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.finding import CannotTell, Contradiction
from contwalk.verification.passage import TIGHT
from contwalk.verification.solving import Condition, Sheet

# Where the critical multipliers are, by label: one value, or both of a pair.
_THIRD = complex(-0.5, np.sqrt(0.75))
RESONANCES = {"R1": 1.0 + 0j, "R2": -1.0 + 0j, "R3": _THIRD, "R4": 1j}
# Labels of two at once, and of what.
BOTH = {
    "LPPD": ("LP", "PD"),
    "LPNS": ("LP", "NS"),
    "PDNS": ("PD", "NS"),
    "NSNS": ("NS", "NS"),
    "ZH": ("LP", "HB"),
    "HH": ("HB", "HB"),
}


# Labels of one condition of eigenvalues or of singular equations.
SPECTRAL = ("LP", "PD", "NS", "HB")


def spectral(label: str, spectrum: Sequence[complex], equations: Equations, sheet: Sheet) -> list[Condition]:
    """The conditions of a label that eigenvalues or the equations themselves define, if it is one."""
    values, taken = np.array(spectrum, dtype=complex), list[int]()
    if label in BOTH:
        return [each for part in BOTH[label] for each in _one(part, values, taken, equations, sheet)]
    if label in RESONANCES:
        pair = _Pair(values, _closest(values, [RESONANCES[label], np.conj(RESONANCES[label])]))
        total = 2.0 * RESONANCES[label].real
        return [lambda at: pair.product(at) - 1.0, lambda at: pair.sum(at) - total]
    if label == "BT":
        zeros = _Pair(values, _closest(values, [0j, 0j]))
        return [zeros.sum, zeros.product]
    if label == "CP":
        return _cusp(sheet)
    return _one(label, values, taken, equations, sheet)


def _one(
    label: str, values: np.ndarray, taken: list[int], equations: Equations, sheet: Sheet
) -> list[Condition]:
    if label == "LP":
        return [singular(sheet)]
    if label == "PD":
        single = _Single(values, _closest(values, [-1.0 + 0j], taken)[0])
        return [lambda at: single.value(at) + 1.0]
    if label in ("NS", "HB"):
        pair = _Pair(values, _critical_pair(values, taken, equations.unit))
        return [(lambda at: pair.product(at) - 1.0) if equations.unit else pair.sum]
    return []


def singular(sheet: Sheet) -> Condition:
    """Zero where the equations' derivatives by the unknowns are singular: a bordered matrix tells it."""
    matrix = sheet.square(sheet.begin) * sheet.equations.sizes[: sheet.equations.size]
    left, _, right = np.linalg.svd(matrix)
    column, row, n = left[:, -1:], right[-1:], len(matrix)
    sizes = sheet.equations.sizes[:n]

    def condition(at: Evaluation) -> float:
        whole = np.block([[sheet.square(at) * sizes, column], [row, np.zeros((1, 1))]])
        return float(np.linalg.solve(whole, np.append(np.zeros(n), 1.0))[-1])

    return condition


def _cusp(sheet: Sheet) -> list[Condition]:
    """A fold of the sheet over the plane of parameters, along which the fold's own direction is tangent."""
    fold, equations, n = singular(sheet), sheet.equations, sheet.equations.size
    if sheet.along.shape[1] != 2:
        raise CannotTell("The curve is not one of a sheet of solutions there.")

    def bend(at: Evaluation) -> float:
        matrix = np.linalg.pinv(sheet.along)
        _, _, right = np.linalg.svd((sheet.left @ at.jacobian) * equations.sizes)
        own = equations.sizes[:, None] * right[n:].T
        own = own @ np.linalg.inv(matrix @ own)  # the same basis at each place
        shares = own[n:]
        null = np.linalg.svd(shares / equations.sizes[n:, None])[2][-1]
        if null @ start < 0.0:
            null = -null
        along = own @ null
        step = (1e-4 if at.relative <= TIGHT else 2e-4) / float(np.max(np.abs(along / equations.sizes)))
        ahead, behind = (fold(equations.at(at.z + s * along, 0.0)) for s in (step, -step))
        return (ahead - behind) / (2.0 * step)

    start = np.linalg.svd(sheet.along[n:] / equations.sizes[n:, None])[2][-1]
    return [fold, bend]


class _Single:
    """One real eigenvalue, followed from what is stored of it."""

    def __init__(self, values: np.ndarray, place: int) -> None:
        self.target = values[place]

    def value(self, at: Evaluation) -> float:
        found = at.spectrum
        return float(found[int(np.argmin(np.abs(found - self.target)))].real)


class _Pair:
    """Two eigenvalues, whose sum and product are smooth where they meet as well."""

    def __init__(self, values: np.ndarray, places: Sequence[int]) -> None:
        self.targets = values[list(places)]

    def both(self, at: Evaluation) -> tuple[complex, complex]:
        """The two of a spectrum that are nearest."""
        found = at.spectrum
        first = int(np.argmin(np.abs(found - self.targets[0])))
        rest = np.delete(found, first)
        return complex(found[first]), complex(rest[int(np.argmin(np.abs(rest - self.targets[1])))])

    def sum(self, at: Evaluation) -> float:
        first, second = self.both(at)
        return (first + second).real

    def product(self, at: Evaluation) -> float:
        first, second = self.both(at)
        return (first * second).real


def _closest(values: np.ndarray, wanted: Sequence[complex], taken: list[int] | None = None) -> list[int]:
    """Numbers of the stored eigenvalues that are nearest to some values, each taken once."""
    taken = [] if taken is None else taken
    found = []
    for value in wanted:
        rest = [k for k in range(len(values)) if k not in taken]
        if not rest:
            raise CannotTell("The record has no eigenvalue that could be critical.")
        found.append(min(rest, key=lambda k: abs(values[k] - value)))
        taken.append(found[-1])
    return found


def _critical_pair(values: np.ndarray, taken: list[int], unit: bool) -> list[int]:
    """Numbers of the stored pair that is at the border: by its sum, or its product."""
    rest = [k for k in range(len(values)) if k not in taken and np.isfinite(values[k])]
    pairs = [
        (i, j)
        for i in rest
        for j in rest
        if i < j and abs((values[i] * values[j]).imag) <= 1e-6 * abs(values[i] * values[j]) + 1e-12
    ]
    if not pairs:
        wrong = Contradiction if np.isfinite(values).all() else CannotTell
        raise wrong("The record has no pair of eigenvalues.")

    def away(pair: tuple[int, int]) -> float:
        a, b = values[pair[0]], values[pair[1]]
        return abs(a * b - 1.0) if unit else abs(a + b) / max(abs(a), abs(b), 1e-300)

    best: tuple[int, int] = min(pairs, key=lambda pair: (away(pair), -abs(values[pair[0]].imag)))
    taken += best
    return list(best)
