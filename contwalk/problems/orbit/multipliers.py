"""Floquet multipliers: eigenvalues of the closure's derivative without the flow's own and the pinned ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.numerics import krein
from contwalk.numerics.spectrum import complement
from contwalk.problems.orbit.periodic_schur import conjugates, product, product_eigenvalues
from contwalk.problems.orbit.quotients import between

Matrices = np.ndarray | Sequence[np.ndarray]

# Relative rounding error of a derivative of the flow: some hundred steps of one rounding each.
ROUNDING = 1e-14
REAL = 1e-11
# How much of the local errors reaches the monodromy matrix, in units of the tolerance: step control is on
# the safe side.
GLOBAL = 0.3
# An error that is a larger part of a multiplier than this leaves it unknown.
UNKNOWN = 0.3
# Two ways to leave the flow out that differ by less in all segments are one.
LITTLE = 1e-6
# Two multipliers whose product is one but for this are a pair; where errors leave more, nothing tells them.
PAIRED, TELLING = 1e-7, 1e-2
# No size is smaller.
LEAST = 1e-300


@dataclass(frozen=True)
class Multipliers:
    """Multipliers by descending modulus.

    Parameters
    ----------
    values : ndarray of complex, shape (r,)
    errors : ndarray, shape (r,)
        What rounding does to them: on its own steps, a branch's multipliers are smooth beyond that.
    accuracy : float
        Estimated absolute error of the first one against the flow itself, that of the steps included.
    paired : ndarray of bool, shape (r,), optional
        Those that come in pairs mu, 1/mu: see `reciprocal`. Their errors are those of their measures.
    bordering : ndarray of bool, shape (r,), optional
        Those of a symplectic map that stay on the unit circle; None of other maps.
    accuracies : ndarray, shape (r,), optional
        As `accuracy`, of each: beside a large one, a small one is known better than that. None where no
        more is known than the first one's.
    of_sums : float, optional
        What the steps do to their sum: where two meet it is known better than they are.
    own : ndarray of bool, shape (r,), optional
        The one that is a family's own beside pairs: it tells no stability, and comes last.
    along : bool
        Whether one is the family's own along which the parameter stands still: it is one for that reason.
    """

    values: np.ndarray
    errors: np.ndarray
    accuracy: float
    paired: np.ndarray | None = None
    bordering: np.ndarray | None = None
    accuracies: np.ndarray | None = None
    of_sums: float | None = None
    own: np.ndarray | None = None
    along: bool = False

    @property
    def measures(self) -> np.ndarray:
        """Modulus minus one: negative for stability.

        Of a pair on the unit circle it would be noise. Its measure is |mu + 1/mu| / 2 - 1: negative there,
        positive of a real pair, and smooth where one becomes the other.

        Shape (m,).
        """
        found = np.abs(self.values) - 1.0
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            half = 0.5 * np.abs((self.values + 1.0 / self.values).real) - 1.0
        if self.paired is not None:
            found = np.where(self.paired & (np.abs(self.values) >= self._within), half, found)
        if self.own is not None:
            found = np.where(self.own, -1.0, found)
        return found if self.bordering is None else np.where(self.bordering, half, found)

    @property
    def _within(self) -> np.ndarray:
        """The modulus from which on one of a pair has the pair's measure: not the smaller one of two real
        ones.
        """
        return np.where(self.values.imag != 0.0, 0.0, 1.0)

    def doubted(self, error: float | np.ndarray) -> Multipliers:
        """The same, none known better than to an absolute error, of all or of each, shape (r,)."""
        each = None if self.accuracies is None else np.maximum(self.accuracies, error)
        errors, first = np.maximum(self.errors, error), float(np.max(np.ravel(error)[:1], initial=0.0))
        return replace(self, errors=errors, accuracy=max(self.accuracy, first), accuracies=each)

    def standing(self, trivial: float) -> Multipliers:
        """The same on a family along which the parameter stands still, as far as orbits are known.

        There one multiplier is 1, the family's own: what it differs by is errors of the steps. It counts as
        at the neighbouring point. The flow's own one differs from 1 by `trivial`.
        """
        off, trivial = np.abs(self.values - 1.0), 2.0 * float(np.nan_to_num(trivial, posinf=0.0))
        known = np.maximum(self.accuracy if self.accuracies is None else self.accuracies, trivial)
        own = (off <= known) & (self.values.imag == 0.0)
        errors = np.where(own, np.maximum(self.errors, np.maximum(known, off)), self.errors)
        # It is one: by what it differs from that, others may be wrong as well.
        worst = float(np.max(off[own], initial=self.accuracy))
        found = replace(self, errors=errors, accuracy=worst, along=bool(np.any(own)))
        return found._in_pairs(int(np.argmin(np.where(own, off, np.inf)))) if np.any(own) else found

    def _in_pairs(self, own: int) -> Multipliers:
        """The same with all but the family's own one as pairs mu, 1/mu, if that is what they are.

        A machine that conserves something at a single value of the parameter does not turn off the unit
        circle there: moduli of such pairs are errors of the steps, which would be told as crossings.
        """
        rest = np.arange(len(self.values)) != own
        if self.of_sums is None or rest.sum() < 2 or rest.sum() % 2:
            return self
        others = Multipliers(self.values[rest], self.errors[rest], self.accuracy)
        paired = reciprocal(others, self.of_sums).paired
        if paired is None or not paired.all() or _pairs_within(others.values, self.of_sums) > TELLING:
            return self
        errors = np.where(rest, self.of_sums, self.errors)
        told = replace(self, errors=errors, paired=rest, own=~rest)
        moduli = np.where(rest, np.where(self.values.imag != 0.0, 1.0, np.abs(self.values)), 0.0)
        order = np.lexsort((-self.values.imag, -told.measures, -moduli))
        each = None if self.accuracies is None else self.accuracies[order]
        paired, values = rest[order], self.values[order]
        return replace(told, values=values, errors=errors[order], accuracies=each, paired=paired, own=~paired)

    def unstable(self, before: int | None) -> int:
        """Number of multipliers outside the unit circle.

        As many of the doubtful ones count as there were at the neighbouring point; of a pair mu, 1/mu one at
        the most, and none that stays on the circle.
        """
        measures = self.measures
        certain = int(np.count_nonzero(measures > self.errors))
        doubtful = ~(np.abs(measures) > self.errors)
        paired = np.zeros(len(measures), dtype=bool) if self.paired is None else self.paired
        outer = np.where(self.values.imag != 0.0, self.values.imag > 0.0, np.abs(self.values) >= 1.0)
        doubtful &= ~paired | outer
        if self.bordering is not None:
            doubtful &= ~self.bordering
        if before is None:
            return certain
        counted = int(np.clip(before - certain, 0, doubtful.sum()))
        # Both conjugates are unstable, or neither is: as where they have come out of two real ones that met.
        conjugates = not np.any(doubtful & (paired | (self.values.imag == 0.0)))
        return certain + counted - (counted % 2 if conjugates else 0)


def multipliers(
    factors: Matrices,
    neutral: Matrices,
    magnitudes: np.ndarray,
    tolerance: float,
    arriving: Matrices | None = None,
    gradients: int = 0,
    positive: bool = False,
    volumes: bool = False,
) -> Multipliers:
    """Multipliers of the product of the segments' derivatives.

    Parameters
    ----------
    factors : ndarray, shape (m, n, n), or sequence of ndarray
        Derivative of each segment's end by its start, the closure applied to the last one.
    neutral : ndarray, shape (m, n, k), or sequence of ndarray
        At the start of each segment, the directions that are carried into each other: the flow's own (of an
        autonomous system) and pinned generators. They are left out by going over to the quotient space.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states; the quotient is orthogonal in their units.
    tolerance : float
        Of the integration.
    arriving : ndarray, shape (m, n, k), or sequence of ndarray, optional
        The same directions at the end of each segment, which is the next one's start but for the gap that a
        solution has left. Where deviations grow, what has grown lies along the flow there, and what is left
        of it beside the flow is a small part: at the state that it has arrived at, not at that next to it.
    gradients : int
        So many of the last directions are gradients of conserved quantities (`conserving.raised`): what is at
        a right angle to them stays so, and they themselves are carried elsewhere. Moduli of one are common
        then: no multiplier counts as better known than the steps allow.
    positive : bool
        Whether what is left, if it is one, is positive: so it is of a flow, which turns nothing over. Steps
        that let deviations decay fast have any sign.
    volumes : bool
        Whether the map keeps volumes: then two are mu and 1/mu.
    """
    scaled = np.asarray(factors) / magnitudes[:, None] * magnitudes
    sizes = np.maximum(np.linalg.norm(scaled, 2, axis=(1, 2)), LEAST)
    begin = np.asarray(neutral) / magnitudes[:, None]
    end = np.roll(begin, -1, axis=0) if arriving is None else np.asarray(arriving) / magnitudes[:, None]
    n, k = begin.shape[1:]
    if n == k:
        return Multipliers(np.zeros(0, dtype=complex), np.zeros(0), 0.0)
    carried = 0 if arriving is None else k - gradients
    quotients, others = between(scaled, begin, end, carried) if k else (scaled, None)
    values, errors = _eigenvalues(quotients, sizes)
    if positive and len(values) == 1:
        values = np.abs(values).astype(complex)
    coarser = 1.0 + GLOBAL * tolerance / ROUNDING
    leak = np.zeros(len(values)) if others is None else _leak(quotients, others, values)
    lost = leak > UNKNOWN * np.abs(values)
    each = np.maximum(errors * coarser, leak)
    doubted = np.where(lost, np.maximum(errors, leak / UNKNOWN), errors)
    found = Multipliers(values, doubted, float(each[0]), accuracies=each)
    two = volumes and len(values) == 2
    if not (gradients or two) and len(values) < 3:
        return found
    whole = product(scaled)
    error = ROUNDING * coarser * max(1.0, *sizes, float(np.linalg.norm(np.nan_to_num(whole), 2)))
    found = replace(found, of_sums=error)
    # Where the growth is shared among segments, a pair near one is not known as badly as the largest one.
    of_pairs = np.full(len(values), error) if len(scaled) == 1 else np.minimum(error, 2.0 * each)
    return _bordering(reciprocal(found, error, of_pairs) if gradients or two else found)


def of_sections(
    factors: Sequence[np.ndarray],
    magnitudes: Sequence[np.ndarray],
    left_out: Sequence[np.ndarray],
    tolerance: float,
) -> Multipliers:
    """Multipliers of a product of factors between spaces whose dimensions differ.

    As `multipliers`, with magnitudes of its own where each factor begins, and each between the quotients by
    what is left out at its ends. An orthonormal basis of what comes out of the first space is carried along:
    in these bases all factors are square. The first quotient is the smallest.
    """
    m = len(factors)
    bases = [complement(some / own[:, None]) for some, own in zip(left_out, magnitudes, strict=True)]
    if not bases[0].shape[1]:
        return Multipliers(np.zeros(0, dtype=complex), np.zeros(0), 0.0)
    squares, sizes, carried = [], [], np.eye(bases[0].shape[1])
    for i, factor in enumerate(factors):
        there = (i + 1) % m
        scaled = factor / magnitudes[there][:, None] * magnitudes[i]
        sizes.append(max(float(np.linalg.norm(scaled, 2)), LEAST))
        moved = bases[there].T @ (scaled @ (bases[i] @ carried))
        if there:
            carried, moved = np.linalg.qr(moved)
        squares.append(moved)
    values, errors = _eigenvalues(squares, sizes)
    with np.errstate(over="ignore"):  # of one near 1e308 nothing is known
        each = errors * (1.0 + GLOBAL * tolerance / ROUNDING)
    return Multipliers(values, errors, float(each[0]), accuracies=each)


def _bordering(found: Multipliers) -> Multipliers:
    """The same with the pairs of a symplectic map on the unit circle, where they stay until two meet.

    There their moduli are known to half the digits, and their signs tell no stability.
    """
    if not krein.symplectic(found.values):
        return found
    on_circle = krein.bordering(found.values, found.values + 1.0 / found.values)
    told = replace(found, bordering=on_circle)
    errors = np.where(on_circle, np.minimum(found.errors, 0.01 * np.abs(told.measures)), found.errors)
    moduli = np.where(on_circle, 1.0, np.abs(found.values))
    order = np.lexsort((-found.values.imag, -told.measures, -moduli))
    paired = None if found.paired is None else found.paired[order]
    return Multipliers(found.values[order], errors[order], found.accuracy, paired, on_circle[order])


def reciprocal(found: Multipliers, error: float, of_pairs: np.ndarray | None = None) -> Multipliers:
    """Multipliers of a motion that conserves something, which may come in pairs mu, 1/mu, by moduli.

    Of a Hamiltonian or a reversible machine they do: as complex pairs on the unit circle and as real ones.
    `error` is that of any sum of them, `of_pairs` that of the sum of the pair that each belongs to, (r,).
    """
    values, paired = found.values.copy(), np.zeros(len(found.values), dtype=bool)
    near = _pairs_within(values, error)
    for i, value in enumerate(values):
        if paired[i]:
            continue
        others = [j for j in range(len(values)) if j != i and not paired[j]]
        if value.imag != 0.0:
            others = [j for j in others if values[j] == np.conj(value)]
        else:
            others = [j for j in others if values[j].imag == 0.0]
        partner = min(others, key=lambda j: abs(values[i] * values[j] - 1.0), default=None)
        if partner is not None and abs(value * values[partner] - 1.0) <= near:
            paired[[i, partner]] = True
    if not paired.any():
        return found
    errors = np.where(paired, error if of_pairs is None else of_pairs, found.errors)
    told = replace(found, errors=errors, paired=paired)
    circle = paired & (values.imag != 0.0)
    order = np.lexsort((-values.imag, -told.measures, -np.where(circle, 1.0, np.abs(values))))
    return Multipliers(values[order], errors[order], found.accuracy, paired[order])


def _pairs_within(values: np.ndarray, error: float) -> float:
    """How far from one products of pairs may be, of values (r,) whose sums have this error."""
    return max(PAIRED, 30.0 * error * float(np.max(np.abs(values), initial=1.0)))


def _eigenvalues(quotients: Matrices, sizes: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of the product by descending modulus, and what rounding does to them."""
    values, errors = _single(quotients[0], sizes[0]) if len(quotients) == 1 else _product(quotients, sizes)
    order = np.lexsort((-values.imag, -np.abs(values)))
    return values[order], errors[order]


def _leak(quotients: np.ndarray, others: np.ndarray, values: np.ndarray) -> np.ndarray:
    """By how much moduli change if the directions that the factors carry along are left out instead.

    Both are the same but for the errors of the steps. What has grown comes to lie along these directions;
    where far more has decayed beside them, what is left there is these errors.
    """
    changes = np.linalg.norm(quotients - others, axis=(1, 2))
    total = float(np.sum(changes / np.maximum(np.linalg.norm(quotients, axis=(1, 2)), LEAST)))
    if len(others) > 1 and total < LITTLE:
        return total * np.abs(values)
    # Of one factor without vectors, which take longer than the eigenvalues.
    found = product_eigenvalues(others) if len(others) == 1 else _product(others, np.ones(len(others)))[0]
    return np.abs(np.abs(values) - np.sort(np.abs(found))[::-1])


def _single(matrix: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of one matrix; their errors from the rounding of what it is a part of, and their
    conditions.
    """
    values, right = np.linalg.eig(matrix)
    try:
        left = np.linalg.inv(right)
        with np.errstate(over="ignore"):  # eigenvectors that are one but for the least numbers there are
            condition = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
    except np.linalg.LinAlgError:
        condition = np.full(len(values), np.inf)
    # Errors of the last steps are relative to the motion, however much has decayed before.
    size = max(size, 1.0)
    # Where eigenvalues meet, first-order conditions are infinite; the root of the noise bounds them.
    return values.astype(complex), np.minimum(condition * ROUNDING * size, size * np.sqrt(ROUNDING))


def _product(factors: Matrices, sizes: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of an unformed product, with errors relative to their own size."""
    try:
        values = product_eigenvalues(factors)
    except np.linalg.LinAlgError:
        return _single(product(factors), float(np.prod(sizes)))
    # The factors are real: what is left of an imaginary part by the complex arithmetic is rounding.
    values = np.where(np.abs(values.imag) <= REAL * np.abs(values), values.real, values).astype(complex)
    values = conjugates(values)
    # A factor is wrong by the rounding of its norm; what that does to an eigenvalue depends on how far its
    # own growth is from the largest, segment by segment.
    m = len(factors)
    largest = float(np.prod(np.asarray(sizes) ** (1.0 / m)))
    own = np.maximum(np.abs(values), LEAST) ** (1.0 / m)
    return values, np.abs(values) * m * ROUNDING * np.maximum(largest / own, 1.0)
