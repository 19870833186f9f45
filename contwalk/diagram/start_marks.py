"""Marks that the start of a branch has itself: which, to what they are known, and their records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.marks import BEYOND, STILL, Observer, observer_of
from contwalk.continuation.newton import correct
from contwalk.continuation.records import counted
from contwalk.continuation.settings import Mark
from contwalk.continuation.state import ContinuationState
from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.linear import parameter_held
from contwalk.problems.problem import Located, Problem, Sample, Test, refined

# What a value is met to, in parts of what is added up in it, and how much an estimate of that may fall short.
MET, ESTIMATED = 4e-16, 4.0
TINY = 1e-300


def marks_at(
    problem: Problem, sample: Sample, marks: tuple[Mark, ...], observer: Observer
) -> list[tuple[str, tuple[str, float | None]]]:
    """Kind, name and value of the marks that a solution has itself, as the start of a branch may.

    The value of an extremum is None.
    """
    found: list[tuple[str, tuple[str, float | None]]] = []
    for mark in marks:
        value = observer.value(mark.name, sample)
        for level in mark.values:
            met = abs(value - level) <= MET * abs(level)
            # A curve of what is marked has it everywhere.
            if met and not (problem.line.second is not None and _stands_still(problem, mark.name, sample)):
                found.append((observer.kind(mark.name), (mark.name, level)))
        if mark.extremum and np.isfinite(value) and _extreme_at(problem, sample, mark.name, value):
            found.append(("extremum", (mark.name, None)))
    return found


def start_refined(problem: Problem, sample: Sample) -> tuple[Problem, Sample]:
    """The start of a branch on the finer steps of located points, its parameter held, with their problem.

    It stays as it is where it is not discretised, at a branch point, where equations are singular, on curves
    in two parameters, and where it is not found on those steps.
    """
    if problem.meshed is None or problem.line.second is not None or sample.orientation == 0.0:
        return problem, sample
    try:
        finer = refined(problem, sample.z, sample.weights)
        found = correct(finer, sample.z, parameter_held(sample.weights), sample.weights)
        tangent = found.tangent(sample.tangent / sample.weights**2, sample.weights)
        if tangent is None:
            return problem, sample
        z = np.append(found.z[:-1], sample.parameter)
        lin = found.problem.linearize(z)
        return found.problem, found.problem.examine(z, tangent, sample.weights, lin, sample.unstable)
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return problem, sample


def _extreme_at(problem: Problem, sample: Sample, name: str, value: float) -> bool:
    """Whether an observable is largest or smallest exactly at a solution; beside it segments tell.

    Rates beside it that are rounding of its value are those of one that stands still.
    """
    if problem.observed.rate(name, sample) != 0.0:
        return False
    before, after = _rates_beside(problem, sample, name)
    return before * after < 0.0 and min(abs(before), abs(after)) > STILL * abs(value)


def _rates_beside(problem: Problem, sample: Sample, name: str) -> tuple[float, float]:
    """Rates of an observable before and after a solution; NaN where no solution is found."""
    normal, sides = sample.tangent / sample.weights**2, []
    for step in (-BEYOND, BEYOND):
        beside = correct(problem, sample.z + step * sample.tangent, normal, sample.weights)
        if not beside.ok or beside.linearization is None:
            return float("nan"), float("nan")
        there, tangent = beside.problem, beside.linearization.tangent(normal, sample.weights)
        seen = there.examine(beside.z, tangent, sample.weights, beside.linearization, sample.unstable)
        sides.append(there.observed.rate(name, seen))
    return sides[0], sides[1]


def place_error(problem: Problem, sample: Sample, mark: tuple[str, float | None]) -> float:
    """Estimated error of the parameter at a solution that has a marked value, or is an extremum.

    Where an observable only touches its value, the parameter is known to the root of what the value is known
    to.
    """
    name, level = mark
    known = float(np.spacing(abs(sample.parameter)))
    observer = observer_of(problem)
    if level is None or observer.kind(name) == "parameter":
        return known
    rate = float(np.nan_to_num(abs(problem.observed.rate(name, sample))))
    before, after = _rates_beside(problem, sample, name)
    bend = float(np.nan_to_num(abs(after - before) / (2.0 * BEYOND)))
    if rate == 0.0 and bend == 0.0:  # it stands still, or nothing is known of how it moves
        return known
    relative = MET + float(np.nan_to_num(sample.error, posinf=0.0))
    noise = relative * (abs(level) + rate + bend)
    # Where rate * d + bend * d^2 / 2 is the noise.
    away = 2.0 * noise / (rate + float(np.sqrt(rate * rate + 2.0 * bend * noise)))
    return known + ESTIMATED * away * abs(float(sample.tangent[-1]))


def _stands_still(problem: Problem, name: str, sample: Sample) -> bool:
    """Whether a free parameter or an observable stands still along a curve in two parameters, to rounding."""
    rate, value = problem.observed.rate(name, sample), observer_of(problem).value(name, sample)
    return abs(rate) <= STILL * max(abs(value), TINY)


def start_record(
    problem: Problem, state: ContinuationState, kind: str, mark: tuple[str, float | None], error: float
) -> SpecialPoint:
    """The record of a mark, name and value, that the start of a branch has; the parameter's `error`."""
    located: Located = Located(state.sample.z, error)
    record = kind_of_test(problem, Test.MARK).describe(problem, located, state.sample, state.s)
    count = counted(state.sample)
    marked = {"name": mark[0], "value": mark[1]}
    return replace(record, kind=kind, mark=marked, unstable_before=count, unstable_after=count)
