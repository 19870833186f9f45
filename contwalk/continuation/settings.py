"""What steers a walk along a branch."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from contwalk.labels import AT_LIMITS


@dataclass(frozen=True)
class Mark:
    """A user's mark: points where `name`, of the parameter or an observable, has a value or is extreme."""

    name: str
    values: tuple[float, ...] = ()
    extremum: bool = False


@dataclass(frozen=True)
class Settings:
    """Settings of one walk. Steps are arclengths in the metric of typical magnitudes.

    Parameters
    ----------
    range : tuple of float
        Values of the free parameter at which the branch ends.
    second_range : tuple of float, optional
        The same of a second free parameter.
    max_points : int
        Points of each direction of a branch, the start among them.
    step, min_step, max_step : float
        First, smallest and largest step.
    max_angle : float
        Largest turn of the tangent in one step, degrees; half of it is aimed at.
    max_share : float
        Largest part of the range that one step moves the parameter by.
    newton_iterations : int
        Corrector iterations before a step counts as failed.
    marks : tuple of Mark
    stop_at : mapping of str to tuple of float
        Values of the free parameter or of observables that end the branch.
    events : mapping of str to str
        What is done at a limit of each label: `stop`, `ignore` or `switch`.
    mirror_images : str
        Whether the half of a branch that is the image of the other one is `known`, or `walked` like it.
    neutral_saddles : str
        Whether curves of Hopf points `follow` on as neutral saddles, or `stop`.
    """

    range: tuple[float, float] = (-math.inf, math.inf)
    max_points: int = 1000
    step: float = 0.02
    min_step: float = 1e-12
    max_step: float = 0.1
    max_angle: float = 20.0
    max_share: float = 1.0 / 64.0
    newton_iterations: int = 8
    marks: tuple[Mark, ...] = ()
    stop_at: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    events: Mapping[str, str] = field(default_factory=lambda: dict(AT_LIMITS))
    mirror_images: str = "known"
    neutral_saddles: str = "follow"
    second_range: tuple[float, float] | None = None

    @cached_property
    def sought(self) -> tuple[Mark, ...]:
        """All marks that a walk looks for: those asked for, and of `stop_at` what is not among them."""
        known = {(mark.name, value) for mark in self.marks for value in mark.values}
        stops = (
            Mark(name, tuple(value for value in values if (name, value) not in known))
            for name, values in self.stop_at.items()
        )
        return (*self.marks, *stops)

    @cached_property
    def bounds(self) -> dict[int, tuple[float, float]]:
        """The range of each free parameter, by its place in z."""
        return {-1: self.range} if self.second_range is None else {-1: self.range, -2: self.second_range}

    @property
    def width(self) -> float:
        """Width of the range; infinite where it is open."""
        return self.range[1] - self.range[0]
