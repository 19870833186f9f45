"""Lines through the plane of two parameters.

An orbit has one free parameter, which may be the coordinate of any line through the space of parameters.
At a place of the plane there are three such lines: one along each parameter, on which the equations tell
their derivatives by it, and the one along the tangent of a curve, on which orbits of the curve are orbits
of one branch. All are compiled once, with both parameters moving, and the parameters have the same bits on
each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.problems.parameter_line import Ends, ParameterLine, in_words


@dataclass(frozen=True)
class LineInPlane(ParameterLine):
    """A line along which two parameters may move, whichever of them do.

    Parameters
    ----------
    rates : tuple of (str, float)
        How fast each of both changes with the coordinate.
    """

    rates: tuple[tuple[str, float], ...] = ()

    @cached_property
    def direction(self) -> np.ndarray:
        """How fast each parameter changes.

        The result has the shape (p,), a number for each parameter.
        """
        known = dict(self.rates)
        return np.array([known.get(name, 0.0) for name in self.parameters])

    def described(self, coordinate: float, error: float | None = None, digits: int = 10) -> str:
        """A place on the line in words: the values of both parameters there, with their errors."""
        values = self.at(coordinate)
        errors = {name: None if error is None else abs(rate) * error for name, rate in self.rates}
        return ", ".join(in_words(name, values[name], errors[name], digits) for name, _ in self.rates)

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """Numbers of both parameters, whether they change on this line or not."""
        names = list(self.parameters)
        return tuple(sorted(names.index(name) for name, _ in self.rates))


def along_parameter(values: Mapping[str, float], free: tuple[str, str], which: int) -> LineInPlane:
    """The line through a place of the plane along one of both parameters, which is its coordinate itself.

    `values` are all parameters at the place; `which` is 0 for the first parameter and 1 for the second one.
    """
    own = free[which]
    base = {**values, own: 0.0}
    return LineInPlane(
        own, dict(values), (base, base), None, tuple((name, float(name == own)) for name in free)
    )


def along_tangent(
    values: Mapping[str, float], free: tuple[str, str], rates: tuple[float, float]
) -> LineInPlane:
    """The line through a place of the plane, at its coordinate zero, along which both parameters change."""
    return LineInPlane("path", dict(values), (values, values), None, tuple(zip(free, rates, strict=True)))


def whole_plane(parameters: Mapping[str, float], free: tuple[str, str]) -> Ends:
    """Ends of a path along which both parameters move: what is compiled for it serves all lines."""
    return dict(parameters), {**parameters, **{name: parameters[name] + 1.0 for name in free}}
