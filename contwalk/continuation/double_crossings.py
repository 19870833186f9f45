"""Crossings that come in pairs: extrema of stability measures between two solutions that reach past zero.

A multiplier that goes from beyond 1 to beyond -1 passes both, and the count is the same again: near
homoclinic orbits of saddle-foci each fold has its period doubling that near. Between both the count differs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk.continuation.eigenvalues_between import peaks
from contwalk.continuation.hidden_pairs import decided, held, reached, undecided
from contwalk.continuation.kinds import crossed, kind_of_test, turning_or_pair
from contwalk.continuation.locating import (
    KNOWN,
    Disagreement,
    Found,
    accepted,
    locate_multiple,
    on_finest_steps,
)
from contwalk.continuation.marks import FINER
from contwalk.continuation.segment import LostBranch, Placed, Segment
from contwalk.numerics import cubic
from contwalk.numerics.bracketing import narrow
from contwalk.problems.problem import Sample, Test

# Nearer to zero than this, against the ends, an extremum is looked at on the finest steps.
CLOSE = 1e-4
# How narrow a bracket says where a multiplier changes its sign, in parts of the segment.
NARROW = 1e-6


def knots_of(segment: Segment, branch_points: list[Found]) -> tuple[list[float], list[Found]]:
    """Ends of the segment and positions between which every change shows, and points that only touch zero.

    The positions are extrema of stability measures at which a sign changes unseen by the ends. A branch point
    splits the search: there a measure may touch zero without passing it. Elsewhere one that touches zero
    belongs to a point where several eigenvalues vanish, some passing up and as many down.
    """
    ends: list[Placed] = [(0.0, segment.a), *[(f.theta, f.sample) for f in branch_points], (1.0, segment.b)]
    knots: list[float] = [0.0, 1.0]
    touching: list[Found] = []
    for low, high, which in _dips(segment, ends, knots):
        theta, passes = _extremum(segment, which, low, high)
        if any(abs(theta - f.theta) < 1e-3 for f in touching):  # both of a pair have one extremum
            continue
        together = locate_multiple(segment, theta) if not passes and _touches(segment, which, theta) else None
        pair = [together] if together is not None else _close_pair(segment, which, theta)
        if pair is not None:
            touching += pair
        elif passes:
            knots.append(theta)
    if (between := _between_one_and_minus_one(segment)) is not None:
        knots.append(between)
    return sorted(set(knots)), touching


def _dips(segment: Segment, ends: list[Placed], knots: list[float]) -> Iterator[tuple[Placed, Placed, int]]:
    """Solutions between which a measure of a number may have an extremum beyond zero; `knots` gets peaks.

    Where two eigenvalues meet, their measures are smooth from there on: what is looked at there is as well.
    """
    for begin, end in pairwise(ends):
        known = set(segment.places)
        knots += peaks(segment, begin, end)
        inside = [(theta, segment.at(theta)) for theta in segment.places if theta not in known]
        for low, high in pairwise((begin, *(there for there in inside if not there[1].undecided), end)):
            for which in _suspects(low[1], high[1], (high[0] - low[0]) * segment.length):
                yield low, high, which


def _between_one_and_minus_one(segment: Segment) -> float | None:
    """Where a multiplier that goes from beyond 1 to beyond -1, or back, is between: the count differs there.

    Raises
    ------
    Disagreement
        If it goes by zero, and the count is that of the ends all the way: with where it is zero.
    """
    a, b = segment.a, segment.b
    which = None if segment.problem.meshed is None else _changes_sides(a, b)
    if which is None:
        return None
    ends = float(a.eigenvalues[which].real), float(b.eigenvalues[which].real)
    largest = place = 0.0

    def value(theta: float) -> float:
        return float(segment.at(theta).eigenvalues[which].real)

    def attempt(theta: float, left: float, right: float) -> float | None:
        nonlocal largest, place
        largest, place = max(largest, abs(value(theta))), theta
        return theta if segment.at(theta).unstable != a.unstable else None

    try:
        found = narrow(value, 0.0, 1.0, *ends, attempt, width=NARROW)
    except LostBranch:
        if segment.problem.limited is None:
            raise
        return None  # a limit may lie there, which is looked for by itself
    # Of an orbit with events it changes sides by a pole as well, where one is grazed: it passes neither then.
    by_a_pole = segment.problem.limited is not None and largest > max(abs(end) for end in ends)
    if found is None and not by_a_pole:
        sentence = "A multiplier goes from beyond 1 to beyond -1, and neither is seen."
        raise Disagreement(turning_or_pair(segment.problem), sentence, (place, which))
    return found


def _changes_sides(a: Sample, b: Sample) -> int | None:
    """The real multiplier that is beyond 1 at one end and beyond -1 at the other; as many are unstable.

    Two that meet may go round zero together: then as many of them are beyond 1 as before, or two more.
    """
    if a.unstable != b.unstable or (_beyond_one(a) - _beyond_one(b)) % 2 == 0:
        return None
    for which in range(a.unstable):
        values = [s.eigenvalues[which] for s in (a, b)]
        known = all(abs(s.eigenvalues[which]) > max(s.errors[which], s.spectrum_error or 0.0) for s in (a, b))
        if known and values[0].imag == values[1].imag == 0.0 and values[0].real * values[1].real < 0.0:
            return which
    return None


def _beyond_one(sample: Sample) -> int:
    """How many of the real multipliers that are counted as unstable are larger than one."""
    counted = sample.eigenvalues[: sample.unstable]
    return int(np.count_nonzero((counted.imag == 0.0) & (counted.real > 1.0)))


def _close_pair(segment: Segment, which: int, theta: float) -> list[Found] | None:
    """Two crossings so near to each other that errors may hide or make them.

    They are looked for on the finest steps, or by more digits; None where the extremum is not that near to
    zero.
    """
    sample = segment.at(theta)
    if segment.problem.meshed is None:
        near = abs(reached(segment, sample, which)) <= KNOWN * sample.errors[which]
        return decided(segment, which, theta) if near and not held(segment.a, which) else None
    ends = max(abs(segment.a.measures[which]), abs(segment.b.measures[which]))
    if abs(sample.measures[which]) > max(CLOSE * ends, sample.spectrum_error or 0.0):
        return None
    finer = on_finest_steps(segment, theta, which)
    if finer is None:
        return None
    part = finer.part
    if any(end.measures[which] * segment.a.measures[which] < 0.0 for end in (part.a, part.b)):
        return None  # beyond zero on the finest steps, too, and for longer than these look
    middle, passes = _extremum(part, which, (0.0, part.a), (1.0, part.b))
    there = part.at(middle)
    kind = crossed(part.problem, there, which) or kind_of_test(part.problem, Test.ORIENTATION)
    # What is off on finer steps is a part of what these have changed.
    left = FINER * abs(reached(segment, sample, which) - reached(part, there, which))
    error = max(there.errors[which], left)

    def known(sample: Sample) -> bool:
        return abs(reached(part, sample, which)) > error

    # What is held on the border touches it where two meet, and what is flat at zero tells nothing.
    flat = any(held(end, which) or not known(end) for end in (part.a, part.b))
    if not flat and not known(there):
        return [finer.placed(undecided(part, kind, middle, known))]
    if not passes:
        return []
    found = []

    def value(theta: float) -> float:
        return float(part.at(theta).measures[which])

    def attempt(theta: float, left: float, right: float) -> Found | None:
        own = crossed(part.problem, part.at(theta), which)
        return None if own is None else accepted(part, own, part.at(theta), which, left, right)

    outside = part.a.unstable
    passing = 1 if part.a.eigenvalues[which].imag == 0.0 else 2
    inside = outside + (passing if part.a.measures[which] < 0.0 else -passing)
    for low, high, before, after in ((0.0, middle, outside, inside), (middle, 1.0, inside, outside)):
        point = narrow(value, low, high, value(low), value(high), attempt)
        if point is None:
            raise Disagreement(kind, "Of two near crossings one is lost.")
        found.append(replace(finer.placed(point), before=before, after=after, counted=True))
    return found


def _touches(segment: Segment, which: int, theta: float) -> bool:
    """Whether a real eigenvalue is zero at its extremum, against what it is at the ends."""
    sample = segment.at(theta)
    ends = min(abs(segment.a.measures[which]), abs(segment.b.measures[which]))
    return sample.eigenvalues[which].imag == 0.0 and abs(sample.measures[which]) < 1e-5 * ends


def _suspects(a: Sample, b: Sample, length: float) -> Iterable[int]:
    """Measures with the same sign at both ends whose cubic interpolation comes near zero in between."""
    ma, mb = a.measures, b.measures
    certain = (np.abs(ma) > a.errors) & (np.abs(mb) > b.errors)
    for which in np.flatnonzero(certain & (np.sign(ma) == np.sign(mb))).tolist():
        sign = float(np.sign(ma[which]))
        ends = a.eigenvalues[which], b.eigenvalues[which]
        if ends[0].imag == ends[1].imag == 0.0 and np.sign(ends[0].real) * np.sign(ends[1].real) < 0.0:
            continue  # it passes both 1 and -1, or zero: see `_between_one_and_minus_one`
        # Towards zero at the one end, away from it at the other: an extremum lies between. A rate has a
        # price, so the end is asked first at which it is less likely; and a comparison with one that is not
        # known is false.
        asked = ((a, -sign), (b, sign))
        if abs(mb[which]) < abs(ma[which]):
            asked = asked[::-1]
        if not all(sample.rates[which] * way > 0.0 for sample, way in asked):
            continue
        values, rates = ((sign * float(at[which]) for at in each) for each in ((ma, mb), (a.rates, b.rates)))
        # There may be a corner, where eigenvalues change roles.
        if cubic.dip([*values], [length * rate for rate in rates], corner=True) is not None:
            yield which


def _extremum(
    segment: Segment, which: int, low: tuple[float, Sample], high: tuple[float, Sample]
) -> tuple[float, bool]:
    """Position of an extremum of measure `which`, and whether its sign differs from that at the ends."""
    sign = np.sign(low[1].measures[which])
    least, place = sign * reached(segment, low[1], which), low[0]

    def rate(sample: Sample) -> float:
        return float(np.nan_to_num(sample.rates[which], posinf=0.0, neginf=0.0))

    def attempt(theta: float, left: float, right: float) -> float | None:
        nonlocal least, place
        sample = segment.at(theta)
        value = sign * reached(segment, sample, which)
        if value < least:
            least, place = value, theta
        return theta if value < -sample.errors[which] else None

    ends = low[0], high[0], rate(low[1]), rate(high[1])
    found = narrow(lambda t: rate(segment.at(t)), *ends, attempt, width=1e-9)
    return (found, True) if found is not None else (place, False)
