"""Stored branches beside a problem's own: whether they are of the same, and in which unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.problems.restoring import problem_of


def of_the_same(stored: Mapping[str, Any], own: Mapping[str, Any]) -> bool:
    """Whether the settings of two curves are of special points of one kind, of one limit or marked value."""
    same = all(stored.get(name) == own.get(name) for name in ("of", "of_problem", "curve"))
    return same and _limit(stored) == _limit(own)


def _limit(settings: Mapping[str, Any]) -> Any:
    """The limit that a curve holds, with its leg by what follows it: orbits may begin with another one, and
    of one that was doubled either half may be where it is.
    """
    limit, legs = settings.get("limit"), settings.get("legs")
    if not limit or not legs or limit.get("leg") is None:
        return limit
    leg = int(limit["leg"])
    return {**limit, "leg": [list(each) for each in (*legs[leg:], *legs[:leg])]}


def stored_like(problem: Any, branch: Branch, guess: np.ndarray) -> Any:
    """The problem whose unknowns a branch stores, near a guess of them, shape (N + 1,).

    That of one with events may begin with another leg, or hold its limit on another one.
    """
    legs = branch.info.settings.get("legs")
    own = problem.branch_facts()["settings"]
    if not legs or (legs == own.get("legs") and branch.info.settings.get("limit") == own.get("limit")):
        return problem
    first = legs[0][0]
    state, places = np.zeros(problem.states), list(problem.system.states_of(first))
    state[places] = guess[: len(places)]
    return problem_of(problem.system, branch.info, state, problem.discretization)
