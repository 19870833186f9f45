"""What a motion comes to that sets out from a pushed state: a pure function of the study and the push."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.threads import one_thread
from contwalk.studies.margins.survival import SURVIVED
from contwalk.workflow.margin_rays import Study, survival_of

# What a motion comes to that is none of the known solutions.
UNKNOWN = "unknown"


@dataclass(frozen=True, eq=False)
class Attractors:
    """The solutions that are recognised, by their names, each with its course, shape (k, n)."""

    courses: dict[str, np.ndarray]
    nearness: float

    def nearest(self, study: Study, state: np.ndarray) -> str:
        """The one that a state, shape (n,), is near to, or `UNKNOWN`."""
        survival = survival_of(study)
        apart = {name: survival.distance(state, course) for name, course in self.courses.items()}
        name = min(apart, key=apart.__getitem__)
        return name if apart[name] <= self.nearness else UNKNOWN

    @property
    def hashes(self) -> dict[str, str]:
        """Of the courses, by their names: they tell sets of solutions apart."""
        return {name: hashlib.sha256(c.tobytes()).hexdigest() for name, c in self.courses.items()}


@dataclass(frozen=True, eq=False)
class BasinStudy:
    """What all points of a basin share; it can be sent to another process."""

    study: Study
    attractors: Attractors
    instant: int


def reached(basin: BasinStudy, push: tuple[float, ...]) -> dict[str, Any]:
    """The label of what a push, of all n states, comes to; and the end, where that is not known."""
    with one_thread():
        survival = survival_of(basin.study)
        instant = basin.study.solution.instants[basin.instant]
        ended, _ = survival.followed(instant, np.array(push))
        if ended != SURVIVED:
            return {"label": ended}
        end = survival.end
        label = basin.attractors.nearest(basin.study, end.state)
    if label != UNKNOWN:
        return {"label": label}
    return {"label": label, "time": end.time, "mode": end.mode, "state": end.state.tolist()}
