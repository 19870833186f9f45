"""Where the equations change their piece within a step: what ends a branch, and what is only told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.continuation.segment import Segment
from contwalk.continuation.state import ContinuationState
from contwalk.problems.kink import Met
from contwalk.problems.problem import Problem


def between(problem: Problem, state: ContinuationState, z: np.ndarray) -> Sequence[Met]:
    """Where the equations change their piece on the way to another place z, shape (N + 1,)."""
    return problem.diagnosis.passed(state.sample.z, z)


def _what(problem: Problem) -> str:
    """What a branch is one of."""
    return "equilibria" if problem.meshed is None else "orbits"


def refusal(problem: Problem, met: Met) -> str:
    """In a sentence, why no branch goes on beyond what is passed."""
    return met.kink.refusal(_what(problem)).sentence


def sentence(problem: Problem, passed: Sequence[Met]) -> str:
    """In a sentence, what the last step that was tried has passed; empty if nothing."""
    return next((met.kink.sentence(_what(problem)) for met in passed), "")


def jump(passed: Sequence[Met]) -> Met | None:
    """The first of what is passed beyond which no branch goes on."""
    return next((met for met in passed if met.kink.refused), None)


def reach(jump: Met, length: float) -> float:
    """How long a step, one of a length having passed a jump, may be before it is none any more.

    Where a slope has no bound what is solved for beside it is rounding: its own distance counts there.
    """
    return length * jump.share if jump.kink.order else length


def with_kinks(segment: Segment, passed: Sequence[Met]) -> Segment:
    """A segment whose end tells of what is passed on the way to it."""
    if not passed:
        return segment
    kinks = (*segment.b.kinks, *(met.kink for met in passed))
    return Segment(segment.problem, segment.a, replace(segment.b, kinks=tuple(dict.fromkeys(kinks))))
