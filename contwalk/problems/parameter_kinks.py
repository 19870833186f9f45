"""Values of the free parameter at which a field changes at whatever states: between two solutions.

No motion crosses such a place, so that nothing of one solution tells of it. Where the field jumps, solutions
beyond are not near to those before.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from contwalk.fields.parameter_switching import ParameterSwitching
from contwalk.fields.switching import Inputs, Switching
from contwalk.problems.kink import Met, ParameterKink
from contwalk.problems.kinks import PARTS, Course, directions, jumping, located

# Groups of inputs that no solution of a branch changes: parameters that are fixed, or where a path begins.
CONSTANT = ("b", "d", "p")

Name = tuple[str, int]


# What has been found of a program, which its course along every orbit asks for.
_KNOWN: WeakKeyDictionary[Switching, dict[frozenset[Name], ParameterSwitching]] = WeakKeyDictionary()


def choices_of_parameters(switching: Switching, free: Collection[Name]) -> ParameterSwitching:
    """What changes with the free parameters alone."""
    known, names = _KNOWN.setdefault(switching, {}), frozenset(free)
    if names not in known:
        known[names] = ParameterSwitching(switching, names, CONSTANT)
    return known[names]


@dataclass(frozen=True)
class Way:
    """How the free parameters go straight from one solution to another.

    Parameters
    ----------
    begin, end : mapping
        Values of the free parameters, by their names as inputs.
    at : callable
        What the parameters are after a part of the way, in words.
    blame : callable
        The plugin's line at which two parts of the way differ, of the number of a place on the motion.
    """

    begin: Mapping[Name, float]
    end: Mapping[Name, float]
    at: Callable[[float], str]
    blame: Callable[[float, float, int], str]

    def inputs(self, shares: np.ndarray | float) -> Inputs:
        """The free parameters after parts of the way, of shape (k,) or one."""
        return {name: a + shares * (self.end[name] - a) for name, a in self.begin.items()}


def passed(course: Course, way: Way) -> tuple[Met, ...]:
    """What changes with the parameters alone on the way from a solution to another, in its order.

    `course` is the motion of the first one, or the equilibrium.
    """
    choices = choices_of_parameters(course.switching, way.begin)
    if not choices.choices:
        return ()
    straight = _straight(course, choices, way)
    found = []
    for k in np.flatnonzero(np.any(straight.changes(), axis=1)).tolist():
        low, high = located(straight, k)
        jump = _lowest(course, choices, way, low, high)
        if jump is not None:
            order, place = jump
            where = way.blame(low, high, place)
            found.append(Met(ParameterKink(order, where, course.of, way.at(high)), low))
    return tuple(found)


def _straight(course: Course, choices: ParameterSwitching, way: Way) -> Course:
    """The way itself as it is looked at for changes, its parts in place of instants."""
    constant = course.evaluate(course.times[:1], course.states[:1])
    shares = np.linspace(0.0, 1.0, PARTS + 1)

    def at(shares: np.ndarray) -> np.ndarray:
        return shares[:, None]

    def evaluate(shares: np.ndarray, _: np.ndarray) -> Inputs:
        return {**constant, **way.inputs(shares)}

    return replace(
        course, switching=choices.parameters, evaluate=evaluate, times=shares, states=at(shares), at=at
    )


def _lowest(
    course: Course, choices: ParameterSwitching, way: Way, low: float, high: float
) -> tuple[int, int] | None:
    """The lowest derivative that jumps anywhere on the motion, and at which of its places.

    None where nothing does that matters.
    """
    given = course.evaluate(course.times, course.states)
    before, after = ({**given, **way.inputs(share)} for share in (low, high))
    along = directions(course.switching, before, course.sizes)
    pieces = choices.beside(before, after, along, len(course.times))
    orders = [(jumping(pieces[:, k], course.level), k) for k in range(len(course.times))]
    return min(((order, k) for order, k in orders if order is not None), default=None)
