"""Straight lines through the space of parameters: along each of them a problem has one free parameter."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import StartError, SystemDefinitionError
from contwalk.system import System

# All parameters where a path begins, at 0, and where it ends, at 1.
Ends = tuple[Mapping[str, float], Mapping[str, float]]
# How far from a coordinate another one is, in sizes of the coordinate.
ELSEWHERE = 0.1


def in_words(name: str, value: float, error: float | None, digits: int = 10) -> str:
    """A number that has a name, with its error where one is given."""
    return f"{name} = {value:.{digits}g}" + ("" if error is None else f" +- {error:.1e}")


@dataclass(frozen=True)
class ParameterLine:
    """A line through the space of parameters, and the coordinate lambda along it.

    Either one parameter moves, and is the coordinate itself; or all move from one set of values, at
    lambda = 0, to another, at lambda = 1: a path.

    Parameters
    ----------
    free : str
        Name of the coordinate: of the parameter, or of the path.
    parameters : dict
        All parameters at a point of the line; their order is the order of `base` and `direction`.
    ends : tuple of two mappings, optional
        All parameters at both ends of a path.
    second : str, optional
        A second free parameter: the line is one of those through a plane, which its solutions tell apart.
    """

    free: str
    parameters: dict[str, float]
    ends: Ends | None = None
    second: str | None = None

    @classmethod
    def of(
        cls,
        system: System,
        parameters: Mapping[str, float],
        free: str,
        ends: Ends | None = None,
        second: str | None = None,
    ) -> ParameterLine:
        """The line of a system's parameters, each with a value.

        Raises
        ------
        SystemDefinitionError
            If a value is missing, or no number; if a path is not two sets of values.
        UnknownNameError
            If there is no such parameter.
        """
        if ends is None:
            system.require_parameter(free)
        else:
            _check_ends(ends)
        if second is not None:
            system.require_parameter(second)
        whole = None if ends is None else (system.all_parameters(ends[0]), system.all_parameters(ends[1]))
        return cls(free, system.all_parameters(parameters), whole, second)

    def usual(self, system: System) -> float:
        """The size of the coordinate as the system declares it, in its default; one where that is zero, or of
        a path. Of what is conserved it is what the line began with: no value of it is declared.
        """
        if self.ends is not None:
            return 1.0
        declared = next((p.default for p in system.parameters if p.name == self.free), 0.0)
        known = declared if math.isfinite(declared) else self.parameters.get(self.free, 0.0)
        return abs(known) or 1.0

    def elsewhere(self, system: System, at: float) -> float:
        """Another coordinate: what holds at one may hold there alone, as where a force has no amplitude."""
        return at + ELSEWHERE * max(abs(at), self.usual(system))

    @property
    def names(self) -> tuple[str, ...]:
        """The free parameters; of a vector z, the first one is last and the second one before it."""
        return (self.free,) if self.second is None else (self.free, self.second)

    @property
    def own(self) -> str | None:
        """The parameter that is the coordinate itself; None on a path."""
        return self.free if self.ends is None else None

    @cached_property
    def base(self) -> np.ndarray:
        """All parameters where a path begins; along a parameter, with its place taken by the coordinate."""
        begin = self.parameters if self.ends is None else self.ends[0]
        return np.array([float(begin[name]) for name in self.parameters])

    @cached_property
    def direction(self) -> np.ndarray:
        """How fast each parameter changes along a path; zeros along a parameter.

        What nobody gives of a conserved quantity is the solution's own: NaN, which does not move.
        """
        if self.ends is None:
            return np.zeros(len(self.parameters))
        end = np.array([float(self.ends[1][name]) for name in self.parameters])
        return np.asarray(np.nan_to_num(end - self.base))

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """Numbers of the parameters that change along a path."""
        return tuple(np.flatnonzero(self.direction).tolist())

    @cached_property
    def moving_names(self) -> tuple[str, ...]:
        """Names of the parameters that change along the line, or with it."""
        names = list(self.parameters)
        along = tuple(names[k] for k in self.moving) if self.own is None else (self.own,)
        return along if self.second is None else (*along, self.second)

    @cached_property
    def constants(self) -> np.ndarray:
        """Base and direction in one array, as compiled functions take them."""
        return np.concatenate([self.base, self.direction])

    def at(self, coordinate: float) -> dict[str, float]:
        """All parameters at a place on the line, by name."""
        if self.own is not None:
            return {**self.parameters, self.own: coordinate}
        each = zip(self.parameters, self.base.tolist(), self.direction.tolist(), strict=True)
        return {name: begin + coordinate * change for name, begin, change in each}

    def described(self, coordinate: float, error: float | None = None, digits: int = 10) -> str:
        """A place on the line in words, with its error: `a = 0.5 +- 1e-9`, or how far along a path."""
        return in_words(self.free, coordinate, error, digits)

    def place(self, at: float | None) -> float:
        """The coordinate of a start: as given, or of the point that the line was made from."""
        if at is not None:
            return float(at)
        return 0.0 if self.own is None else float(self.parameters[self.own])

    def value(self, name: str, coordinate: float) -> float | None:
        """What changes along the line under a name, at a place on it; None if nothing does."""
        if name == self.free:
            return coordinate
        if name not in self.moving_names or name == self.second:
            return None
        k = list(self.parameters).index(name)
        return float(self.base[k] + coordinate * self.direction[k])

    def slope(self, name: str) -> float:
        """How fast a parameter changes with the coordinate."""
        if self.own is not None:
            return float(name == self.own)
        return float(self.direction[list(self.parameters).index(name)])

    def coordinate(self, name: str, level: float) -> float | None:
        """Where what changes under a name has a value; None if nothing does."""
        if name == self.free:
            return level
        if name not in self.moving_names or name == self.second:
            return None
        k = list(self.parameters).index(name)
        return float((level - self.base[k]) / self.direction[k])

    def filled(self, values: Mapping[str, float]) -> ParameterLine:
        """The same line with values where it has none: NaN at a point or an end of it."""

        def with_values(given: Mapping[str, float]) -> dict[str, float]:
            return {name: values.get(name, v) if np.isnan(v) else v for name, v in given.items()}

        ends = None if self.ends is None else (with_values(self.ends[0]), with_values(self.ends[1]))
        return replace(self, parameters=with_values(self.parameters), ends=ends)

    def range(self, system: System) -> tuple[float, float]:
        """From where to where it goes: a path's ends, or the parameter's declared bounds.

        Raises
        ------
        StartError
            If there are none.
        """
        if self.own is None:
            return 0.0, 1.0
        low, high = next(p.bounds for p in system.parameters if p.name == self.own)
        if low is None or high is None:
            raise StartError(
                f"No range is given, and '{system.name}' declares no bounds for {self.free}: the branch may "
                "go on for ever.",
                "Give range=(low, high); an end may be math.inf where max_points is to end it.",
            )
        return low, high


def _check_ends(ends: Any) -> None:
    """Raise for a path that is not two sets of values, as where another argument stands in its place.

    Raises
    ------
    SystemDefinitionError
    """
    if isinstance(ends, Sequence) and len(ends) == 2 and all(isinstance(end, Mapping) for end in ends):
        return
    raise SystemDefinitionError(
        f"A path leads from values of parameters to others, and this is a {type(ends).__name__}.",
        "Give `path` two mappings from names to values, or None; what follows it is given by name "
        "(`discretization=...`).",
    )
