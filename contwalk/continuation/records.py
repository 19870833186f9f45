"""Records of special points and of end points, counted in the order of growing arclength."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.locating import SAME_POINT, Found
from contwalk.continuation.state import ContinuationState
from contwalk.errors import NotFinite
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Located, Problem, Sample, Test


def found_record(
    problem: Problem, found: Found, s: float, sign: float, known: tuple[bool, bool] = (True, True)
) -> SpecialPoint:
    """The record of a found point; counts are in the order of growing arclength.

    `known`: whether stability is, before it and behind it along the walk.
    """
    held = found.type.held_beside(problem, found.sample)
    sides = zip((found.before, found.after), held, known, strict=True)
    counts = [own + beside if sure else None for own, beside, sure in sides]
    before, after = counts if sign > 0 else counts[::-1]
    if found.kind == "unlocated":
        record = kind_of_test(problem, Test.MARK).describe(problem, found.located, found.sample, s)
        # Nothing tells how far it is from the sample that stands for it: the parameter may have turned.
        record = replace(record, label=found.label, status="unlocated", error=None, errors={}, note=None)
    else:
        record = _described(problem, found, s)
        if found.kind is not None:
            record = replace(record, kind=found.kind)
        if found.mark is not None:
            name, value = found.mark
            record = replace(record, mark={"name": name, "value": value})
    if found.note:
        record = replace(record, note="; ".join(each for each in (record.note, found.note) if each))
    tangent = tuple(sign * t for t in record.tangent)  # stored towards growing arclength
    admissible = record.admissible and not found.sample.forbidden
    return replace(
        record, tangent=tangent, unstable_before=before, unstable_after=after, admissible=admissible
    )


def _described(problem: Problem, found: Found, s: float) -> SpecialPoint:
    """The record of a located point; where its normal form cannot be computed, it is a point without one."""
    if found.turned:
        note = "located where the parameter turns: multipliers are not known to one there"
    else:
        try:
            return found.type.describe(problem, found.located, found.sample, s)
        except (NotFinite, np.linalg.LinAlgError) as error:
            why = error.sentence if isinstance(error, NotFinite) else str(error)
            note = f"located, but its normal form cannot be computed: {why}"
    record = kind_of_test(problem, Test.MARK).describe(problem, found.located, found.sample, s)
    return replace(record, label=found.label, kind=None, note=note)


def end_record(
    problem: Problem,
    state: ContinuationState,
    outcome: Outcome,
    sign: float,
    *,
    point: SpecialPoint | None = None,
    bound: tuple[str, float] | None = None,
) -> SpecialPoint:
    """The record of an end point; its note keeps the outcome's sentence.

    `point` is the special point that ends the branch: its errors are the end's, and its margins, which at a
    limit are nothing where that was located and of any sign on the branch's own steps. Elsewhere the
    parameter is what it is. Of a curve in two parameters that holds of neither: where it meets an end of the
    range, the parameter `bound` with its value, it is located; elsewhere nothing tells its errors.
    """
    error = 0.0 if outcome.reason == "bound" else float(np.spacing(abs(state.sample.parameter)))
    known = problem.line.second is None
    met = None if known or bound is None else _at_bound(problem, state.sample, *bound)
    located, known = met or Located(state.sample.z, error), known or met is not None
    record = kind_of_test(problem, Test.END).describe(problem, located, state.sample, state.s)
    if point is not None:
        record = replace(
            record, error=point.error, errors=point.errors, admissible=point.admissible, margin=point.margin
        )
    elif not known:
        record = replace(record, error=None, errors={})
    count = counted(state.sample)
    if point is not None:
        count = point.unstable_after if sign > 0 else point.unstable_before
    return replace(
        record,
        kind=outcome.reason,
        tangent=tuple(sign * t for t in record.tangent),
        unstable_before=count,
        unstable_after=count,
        admissible=record.admissible and not state.sample.forbidden,
        note=outcome.message,
    )


def counted(sample: Sample) -> int | None:
    """How many directions are unstable at a sample; None where it is not known."""
    return None if sample.undecided else sample.unstable + sample.held_unstable


def _at_bound(problem: Problem, sample: Sample, name: str, value: float) -> Located | None:
    """The point beside a sample at which a parameter has a value; None where it is not found."""
    found = problem.observed.locate_mark(name, value, sample)
    settled = None if found is None else found.settled()
    if settled is None or norm_in(settled.z - sample.z, sample.weights) > SAME_POINT:
        return None
    z = settled.z.copy()
    z[-1 - problem.line.names.index(name)] = value
    return replace(settled, z=z)
