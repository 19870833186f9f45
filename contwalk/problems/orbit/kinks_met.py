"""Where fields are smooth by pieces only along the motion of an orbit, and between two of them."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NO_LINE
from contwalk.problems import kinks
from contwalk.problems.kink import Kink, Met
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.period import period_course
from contwalk.problems.parameter_kinks import Way, passed


def kinks_along(orbit: OrbitData, z: np.ndarray) -> tuple[Kink, ...]:
    """Those that the motion of z crosses, each once, and jumps that its events lie on.

    z has the shape (N + 1,).
    """
    at_events = orbit.kinks_at_events(z)
    found = (kinks.along(course) for course in orbit.courses(z))
    return tuple(dict.fromkeys(kink for part in (*found, at_events) for kink in part))


def passed_by_parameters(orbit: OrbitData, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What of the field, and of the period of what forces it, changes with the free parameter alone between
    an orbit and another solution, shape (N + 1,) each.
    """
    period = period_course(orbit.system, orbit.line)
    courses = [*([] if period is None else [period]), *orbit.courses(a)]
    met = {each.kink: each for course in courses for each in passed(course, _way(orbit, course, a, b))}
    if period is not None:  # it is a factor of rates over an orbit's own time
        met = {kink: each for kink, each in met.items() if kink.where != NO_LINE}
    return tuple(sorted(met.values(), key=lambda each: each.share))


def _way(orbit: OrbitData, course: Course, a: np.ndarray, b: np.ndarray) -> Way:
    """From the parameter of an orbit to that of another solution."""
    begin, end = float(a[-1]), float(b[-1])

    def at(share: float) -> str:
        return orbit.line.described(begin + share * (end - begin))

    def blame(low: float, high: float, place: int) -> str:
        values = tuple(orbit.line.at(begin + share * (end - begin)) for share in (low, high))
        there = float(course.times[place]), course.states[place]
        return course.where(there, there, parameters=values)

    return Way({("l", 0): begin}, {("l", 0): end}, at, blame)
