"""Between a walk's place and the row that is stored of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import NOT_KNOWN, BranchInfo, SpecialPoint
from contwalk.continuation.state import ContinuationState, adapted
from contwalk.problems.problem import Problem, at_stored


def to_row(
    info: BranchInfo, problem: Problem, state: ContinuationState, sign: float, special: SpecialPoint | None
) -> np.ndarray:
    """The stored row, shape (1,), of dtype `info.point_dtype()`; its tangent points towards growing s."""
    sample = state.sample
    born = info.parent is not None and state.s == 0.0
    # There equations are singular, and tell no error; the point has been located by others.
    singular = born or (special is not None and special.status == "located" and _singular(problem, special))
    row = np.zeros(1, dtype=info.point_dtype())
    eigenvalues = np.full(info.spectrum, np.nan + 0j)
    eigenvalues[: len(sample.spectrum)] = sample.spectrum
    row["s"] = state.s
    row["free"] = sample.z[::-1][: len(info.free)]
    row["state"] = problem.observed.reported(sample.z) if sample.reported is None else sample.reported
    row["observables"] = sample.observables
    row["period"] = sample.period
    row["trivial_error"] = sample.trivial_error
    row["spectrum"] = eigenvalues
    own = sample.errors[sample.leading] if len(sample.errors) else 0.0
    known = sample.spectrum_accuracy if singular else None
    known = sample.spectrum_error if known is None else known
    row["spectrum_error"] = own if known is None else known
    row["unstable"] = sample.unstable + sample.held_unstable
    # At a bifurcation what is critical is so for a reason; its two sides are known.
    bifurcation = born or (
        special is not None and special.status == "located" and _critical(problem, special)
    )
    row["undecided"] = 0 if bifurcation else sample.undecided
    stable = row["unstable"] == 0 if bifurcation else sample.stable
    row["stable"] = NOT_KNOWN if stable is None else stable
    row["admissible"] = sample.admissible
    row["special"] = special is not None
    for column, values in (
        ("unknowns", sample.z[:-1]),
        ("tangent", sign * sample.tangent),
        ("weights", sample.weights),
    ):
        row[column] = np.nan
        row[column][0, : len(values)] = values
    row["step"] = state.step
    row["error"] = np.nan if singular else sample.error
    row["residual"] = sample.excess
    row["iterations"] = sample.iterations
    row["rhs"] = sample.evaluations
    row["seconds"] = sample.seconds
    return row


def _critical(problem: Problem, point: SpecialPoint) -> bool:
    """Whether an eigenvalue is critical at points that are stored like this one."""
    return any(any(kind.changes) for kind in problem.point_types if kind.label == point.label)


def _singular(problem: Problem, point: SpecialPoint) -> bool:
    """Whether equations are singular at points that are stored like this one."""
    return any(kind.singular for kind in problem.point_types if kind.label == point.label)


def from_row(problem: Problem, row: np.void, sign: float, born: bool) -> tuple[Problem, ContinuationState]:
    """The place that a stored row was made from, facing along the walk, and the problem discretised for it.

    `born` is whether the branch begins at a branch point.
    """
    size = int(np.sum(np.isfinite(row["unknowns"])))
    z = np.append(row["unknowns"][:size], row["free"][0])
    weights, tangent = np.array(row["weights"][: size + 1]), sign * np.array(row["tangent"][: size + 1])
    problem = at_stored(problem, z, weights)
    sample = problem.examine(z, tangent, weights, problem.linearize(z), int(row["unstable"]))
    count = int(row["unstable"]) - sample.held_unstable
    if sample.held_unstable:
        sample = problem.examine(z, tangent, weights, problem.linearize(z), count)
    # What was told of it then is told again: the walk goes on with the same numbers, to the last bit.
    sample = replace(
        sample,
        observables=np.array(row["observables"]),
        reported=None if sample.reported is None else np.array(row["state"]),
    ).counted(count)
    if born and row["s"] == 0.0:
        sample = replace(sample, orientation=0.0)  # not defined at a branch point
    problem, sample = adapted(problem, sample)
    return problem, ContinuationState(sample, float(row["s"]), float(row["step"]))
