"""What a branch begins with."""

from __future__ import annotations

from dataclasses import dataclass

from contwalk.continuation.state import ContinuationState
from contwalk.problems.problem import Problem


@dataclass(frozen=True)
class Opening:
    """A problem and its first solution. `message` reports a neutral direction that nobody declared.

    `one_sided` says that only one direction leads away from it.
    """

    problem: Problem
    state: ContinuationState
    message: str = ""
    one_sided: bool = False
