"""A curve's orbits discretised anew for what follows a solution."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.errors import NotFinite, StartError
from contwalk.numerics.linear import unit_in
from contwalk.problems.locus.curve_of_orbits import KNOWN
from contwalk.problems.orbit import remesh
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.transport import closed
from contwalk.problems.sample import Sample
from contwalk.problems.solving import newton_on

# How much deviations may grow over a segment of equal duration: what a curve holds has second derivatives of
# the flow in its slopes, which grow by the square of that.
AT_EASE = 1e3
# What steps that do not fit end in.
FAILURES = (StartError, NotFinite, np.linalg.LinAlgError)


def adapted(curve: Any, sample: Sample) -> tuple[Any, Sample]:
    """A curve with steps and borders made for what follows a solution, and its sample on it.

    Where the orbit begins elsewhere, or in other segments, it is solved for again by the curve's equations:
    those of the orbit alone are singular at a fold. Where deviations grow so much that steps of the walk's
    tolerance tell nothing, as towards a homoclinic orbit, they are finer, and the orbit is solved for on
    them. All of it follows from the solution alone, so that a walk that is taken up again does the same.
    Legs between events have finer steps where deviations grow, whoever asks for them.
    """
    if not curve.orbit.in_closure:
        return _on_new_steps(curve, sample, closed).examined(sample)
    if curve.orbit.discretization.share < 1.0:
        curve = _of_share(curve, sample, 1.0).at_stored(sample.z, sample.weights)
    usual: _Place | None = None
    try:
        usual = _on_new_steps(curve, sample, _as_moved)
        error = usual.error
    except FAILURES:
        error = _error_on_new_steps(curve, sample)
    if KNOWN < error < np.inf and sample.orientation != 0.0:
        share = max(KNOWN / error, FINEST / curve.orbit.discretization.walking)
        try:
            finer = _of_share(curve, sample, share)
            return _on_new_steps(finer, sample, _as_moved, again=True).examined(sample)
        except FAILURES:
            pass
    if usual is not None:
        try:
            return usual.examined(sample)
        except FAILURES:
            pass
    return _on_new_steps(curve, sample, closed).examined(sample)


@dataclass(frozen=True)
class _Place:
    """A solution on new steps, with the curve on them; z, tangent and weights have the shape (N + k + 2,)."""

    curve: Any
    z: np.ndarray
    tangent: np.ndarray
    weights: np.ndarray

    @property
    def error(self) -> float:
        """What errors of the steps do to it."""
        unit, errors = unit_in(self.tangent, self.weights), self.curve.errors_at(self.z)
        found: float = self.curve.linearize(self.z).orientation_and_error(unit, self.weights, errors)[1]
        return found

    def examined(self, sample: Sample) -> tuple[Any, Sample]:
        """The curve, and what is watched at the solution; what was told of it before is told again."""
        lin = self.curve.linearize(self.z)
        again: Sample = self.curve.examine(self.z, self.tangent, self.weights, lin, sample.unstable, sample)
        return self.curve, replace(
            again,
            orientation=0.0 if sample.orientation == 0.0 else again.orientation,
            seconds=sample.seconds,
            evaluations=sample.evaluations,
            iterations=sample.iterations,
        )


def _of_share(curve: Any, sample: Sample, share: float) -> Any:
    """The same curve, of orbits whose next steps are made for a part of the walk's tolerance."""
    discretization = replace(curve.orbit.discretization, share=share)
    return curve.on(curve.orbit.varied(discretization=discretization), sample.z, sample.weights)


def _error_on_new_steps(curve: Any, sample: Sample) -> float:
    """What errors of steps of the walk's tolerance do to a solution of finer ones."""
    z, weights = sample.z, sample.weights
    there = curve.adapted_to(z, weights)
    error: float = there.linearize(z).orientation_and_error(sample.tangent, weights, there.errors_at(z))[1]
    return error


def _on_new_steps(curve: Any, sample: Sample, closing: remesh.Closing[Any], again: bool = False) -> _Place:
    """As `adapted`, on steps of the curve's tolerance; solved for in any case if it is to be so `again`."""
    orbit, own = curve.on_tangent(sample.z, sample.tangent, sample.weights)
    given = replace(
        sample,
        z=own.z,
        tangent=own.tangent,
        weights=own.weights,
        observables=sample.observables[: curve.own_observables],
        orientation=1.0,  # where curves cross the orbits of one of them are no branch point themselves
    )
    orbit, seen = remesh.adapted(orbit, given, closing, AT_EASE, watched=False)
    ahead = float(seen.z[-1]) * sample.tangent[-2:]
    z = curve.joined(seen.z[:-1], sample.z)
    z[-2:] += ahead
    weights = curve.joined(seen.weights[:-1], sample.weights)
    lead = float(seen.tangent[-1])
    tangent = curve.joined(seen.tangent[:-1] / (lead or 1.0), sample.tangent)
    there = curve.on(orbit, z, weights)
    if np.array_equal(z, sample.z) and not again:
        return _Place(there, z, tangent, weights)
    z, tangent = _solved(there, z, tangent, weights, curve.way(sample.z, sample.tangent, sample.weights))
    return _Place(curve.on(orbit, z, weights), z, tangent, weights)


def _solved(
    there: Any, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The solution nearest to z across the curve, and the tangent there that goes the same way.

    z, tangent and weights have the shape (N + k + 2,), the way (3,).
    """
    normal = tangent / weights**2
    z = newton_on(there, z, weights, normal)
    tangent = there.linearize(z).tangent(normal, weights)
    return z, tangent * (np.sign(there.way(z, tangent, weights) @ way) or 1.0)


def _as_moved(orbit: Any, rough: Sample) -> tuple[Any, Sample] | None:
    """An orbit in other segments as it is, to be solved for by others; None where it has no value."""
    return (orbit, rough) if orbit.linearize(rough.z).finite else None
