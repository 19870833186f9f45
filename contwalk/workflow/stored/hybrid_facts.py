"""Segments and margins of a stored hybrid orbit: what happens on it, and how far it is from its limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.system import System

# Parts of the scale of a margin: zero at the point that is located there, and below zero beyond doubt.
ZERO, BELOW = 1e-6, -1e-9


@dataclass(frozen=True)
class SegmentFact:
    """A segment: the mode it is in, how long it lasts in seconds, and the event that ends it."""

    mode: str
    duration: float
    event: str


@dataclass(frozen=True)
class MarginFact:
    """The least value under one name of what must be positive.

    Parameters
    ----------
    name, unit : str
        The unit is empty where it is not known.
    value : float
    share : float
        In parts of the largest value: along the branch where that is stored, else on the orbit.
    what : str
        What it is a margin of, in words.
    label : str
        Of the special point at which it is zero.
    """

    name: str
    value: float
    unit: str
    share: float
    what: str
    label: str


@dataclass(frozen=True)
class HybridFacts:
    """Segments in their order; margins, the least one first."""

    segments: tuple[SegmentFact, ...]
    margins: tuple[MarginFact, ...]

    @property
    def violated(self) -> list[str]:
        """Names of the margins that are negative."""
        return [margin.name for margin in self.margins if margin.share < BELOW]

    def nearest(self, label: str) -> MarginFact | None:
        """The margin that is zero at a point of a label."""
        own = [margin for margin in self.margins if margin.label == label]
        return min(own, key=lambda margin: abs(margin.share), default=None)


def facts_of(
    system: System, branch: Branch, point: SpecialPoint | int, solved: tuple[Any, Any] | None = None
) -> HybridFacts:
    """What is known of the orbit of a stored point; `solved` is what `reopened` gives of it, where known.

    Raises
    ------
    ContwalkError
        If the system is not that of the branch, or the orbit cannot be integrated.
    """
    from contwalk.diagram.reopening import reopened
    from contwalk.problems.hybrid.margins import DERIVED
    from contwalk.workflow.stored.orbits import PICTURE

    problem: Any
    problem, sample = solved or reopened(system, branch, point, PICTURE)
    z = sample.z
    segments = tuple(
        SegmentFact(mode, float(duration), event)
        for (mode, event, *_), duration in zip(
            branch.info.settings["legs"],
            np.diff(problem.starting_times(z)),
            strict=True,
        )
    )
    stored = dict(point.margin) if isinstance(point, SpecialPoint) else {}
    found: dict[str, MarginFact] = {}
    margins = problem.margins(z)
    for limit, value, scale in zip(margins.limits, margins.values, margins.scales, strict=True):
        if not np.isfinite(value):
            continue
        derived = limit.test in DERIVED
        name = f"{limit.name}_{limit.test}" if derived else limit.name
        if name in branch.info.observables:
            column = np.abs(branch[name])
            scale = float(np.max(column[np.isfinite(column)], initial=0.0)) or scale
            if not isinstance(point, SpecialPoint):
                stored[name] = float(branch[name][point])
        stored_value = float(stored.get(name, value))
        fact = MarginFact(
            name,
            stored_value,
            _unit(system, name),
            stored_value / float(scale),
            _what(limit, segments),
            limit.label,
        )
        if name not in found or (name not in stored and fact.share < found[name].share):
            found[name] = fact
    return HybridFacts(segments, tuple(sorted(found.values(), key=lambda margin: margin.share)))


def _unit(system: System, name: str) -> str:
    if name.endswith("_duration"):
        return system.time_unit
    return next((c.unit for c in system.conditions if c.name == name), "")


def _what(limit: object, segments: tuple[SegmentFact, ...]) -> str:
    """What a limit is about, in a few words."""
    from contwalk.problems.hybrid.margins import Limit

    assert isinstance(limit, Limit)
    segment = segments[limit.leg]
    if limit.test == "duration":
        return f"how long {segment.mode} lasts"
    if limit.test == "rate":
        return "rate at which the guard arrives"
    if limit.test == "leaving":
        return "how the guard goes on that its own event left without rate"
    if limit.test == "condition":
        return f"condition at {segment.event}"
    return f"guard on the way, in {segment.mode}"
