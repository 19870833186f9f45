"""Where a walk stands, and where it begins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contwalk.continuation.correction import Correction
from contwalk.continuation.metric import (
    UNKNOWN,
    crowded,
    initial_magnitudes,
    later_magnitudes,
    parameter_weight,
    updated,
)
from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Settings
from contwalk.errors import NotFinite
from contwalk.numerics.linear import EPSILON, kernel_direction, norm_in
from contwalk.problems.problem import Problem, Sample, equations_at

# A magnitude this many times an unknown's size and how far it moves is none.
FAR = 100.0


@dataclass(frozen=True)
class ContinuationState:
    """What is needed to go on from a point of a branch, and nothing else.

    `s` is the signed arclength, `step` the length of the next step. The sample's tangent points the way to
    go.
    """

    sample: Sample
    s: float
    step: float


def begin(
    problem: Problem,
    z: np.ndarray,
    settings: Settings,
    toward: np.ndarray | None = None,
    reach: Callable[[float], np.ndarray] | None = None,
) -> ContinuationState | Correction:
    """The first solution of a branch near z, with the tangent towards growing parameter (or along `toward`).

    With `toward`, z is taken as a solution already (a branch point) and `toward` as the tangent there;
    `reach` then stands in for magnitudes that z does not tell. z, `toward` and what `reach` returns for the
    parameter's weight have the shape (N + 1,).
    Returns the failed `Correction` where there is no solution.

    Raises
    ------
    NotFinite
        If no discretisation of the equations reaches a z that is taken as a solution.
    """
    value = float(z[-1])
    if toward is None:
        across, known = _across(problem, z), problem.beginnings(z)
        # Curves begin near their solution, and derivatives of values are known along it alone: what is left
        # across makes the next correction larger than damping allows, and full steps get there.
        correction = None if problem.line.second is None else correct(problem, z, across, known)
        if correction is None or not correction.ok:
            correction = correct(problem, z, across, known, iterations=60, damped=True)
        if not correction.ok:
            return correction
        problem, z = correction.problem, correction.z
        if problem.line.second is None:
            z = np.append(z[:-1], value)
    problem, linearization = equations_at(problem, z)
    if not linearization.finite:
        raise NotFinite(f"The equations have no finite value there: {problem.diagnosis.explain(z)}.", "")
    magnitudes = linearization.magnitudes
    span = parameter_weight(magnitudes[-1], settings.range, value)
    if toward is None and problem.meshed is None:
        magnitudes = initial_magnitudes(problem, z, linearization, span)
    if reach is not None:
        moved = reach(span)
        magnitudes = np.where(np.isfinite(magnitudes) | ~(moved > 0.0), magnitudes, moved)
        # Where equations are singular, what they tell of an unknown may be far more than it ever moves by.
        size = np.maximum(np.abs(z), moved)
        magnitudes = np.where((moved > 0.0) & (magnitudes > FAR * size), size, magnitudes)
    weights = updated(None, crowded(problem, magnitudes), settings, np.abs(z), z)
    tangent = toward if toward is not None else first_tangent(linearization.jacobian, weights)
    sample = problem.examine(z, tangent, weights, linearization, None)
    if toward is not None:
        sample = replace(sample, orientation=0.0)  # not defined at a branch point
    return ContinuationState(sample, 0.0, settings.step)


def _across(problem: Problem, z: np.ndarray) -> np.ndarray:
    """The normal of the first corrections: a start keeps its parameter; with two, none."""
    if problem.line.second is not None:
        jacobian, weights = problem.linearize(z).jacobian, problem.beginnings(z)
        if np.all(np.isfinite(jacobian)):
            return kernel_direction(jacobian, weights) / weights**2
    return np.append(np.zeros(len(z) - 1), 1.0)


def first_tangent(jacobian: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Unit tangent at a start, shape (N + 1,), towards growing parameter where the parameter moves at all.

    The Jacobian has the shape (N, N + 1), the weights of the metric (N + 1,).
    """
    tangent = kernel_direction(jacobian, weights)
    tangent = np.where(np.abs(tangent) < EPSILON * weights, 0.0, tangent)  # of a unit vector that is rounding
    lead = tangent[-1] / weights[-1]
    if abs(lead) < 1e-12:
        lead = (tangent / weights)[int(np.argmax(np.abs(tangent / weights)))]
    return tangent * np.sign(lead)


def turned(state: ContinuationState) -> ContinuationState:
    """The same place, facing the other way."""
    sample = state.sample
    back = replace(
        sample, tangent=-sample.tangent, orientation=-sample.orientation, rates=sample.rates.scaled(-1.0)
    )
    return replace(state, sample=back)


def adapted(problem: Problem, sample: Sample) -> tuple[Problem, Sample]:
    """The problem discretised anew for the next step, and the sample on it, with the count that it had.

    A count that changed here would change between two steps, where nothing looks for a special point.
    """
    there, again = (problem, sample) if problem.anchored is None else problem.anchored.adapted(sample)
    return there, again.counted(sample.unstable)


def grown(
    problem: Problem, sample: Sample, state: ContinuationState, settings: Settings, origin: Sample
) -> Sample:
    """A new sample in the metric that its own size adds to, and how far it is from where its walk began."""
    known, magnitudes = state.sample.weights, sample.magnitudes
    own = np.abs(sample.z) if problem.meshed is None else problem.meshed.sizes_since(sample, origin)
    sizes = crowded(problem, own)
    # What nothing tells yet, as drifts never, need not be asked for again, nor a declared scale of one.
    new = (known == UNKNOWN) & np.isfinite(magnitudes) & (magnitudes != UNKNOWN)
    if problem.meshed is None and np.any(new[:-1]):
        magnitudes = later_magnitudes(problem, sample, known, origin)
    weights = updated(known, crowded(problem, magnitudes), settings, sizes, sample.z)
    factor = norm_in(sample.tangent, weights)
    rates = sample.rates.scaled(1.0 / factor)
    return sample.varied(weights=weights, tangent=sample.tangent / factor, rates=rates)
