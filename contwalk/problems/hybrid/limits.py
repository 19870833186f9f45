"""Limits: what must stay positive for an orbit to be one that the machine can move on.

| test | what it is | label where it passes zero |
|---|---|---|
| `dip` | least value of a guard inside a leg, at an instant where its rate is zero | GR |
| `rate` | rate at which the leg's own guard arrives | GR `terminal` |
| `duration` | duration of a leg | OC |
| `start`, `end` | a guard that is not the leg's own, at its ends | OC, of a watched one AZ |
| `condition` | a declared condition at an event | AZ |
| `past` | how far the guard of a leg that lasts no time is past zero | OC |

Of a soft transition there are none but conditions: the field switches continuously there.

A grazing is `terminal` where the guard is the one that ends the leg: the leg then ends earlier. All guards
have the sign with which they are positive on an admissible orbit. Every limit that passes zero is a special
point like any other: a solution of the orbit's equations together with one or two more, exact derivatives
included.
"""

from __future__ import annotations

from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import KINDS, Limit
from contwalk.system import System, Transition

LABELS = tuple(KINDS)


def transition_of(problem: LimitedOrbit, limit: Limit) -> Transition:
    """The transition that a limit is about, out of its leg's mode."""
    return problem.system.transition(limit.name, problem.itinerary.legs[limit.leg].mode)


def limits_of(problem: LimitedOrbit) -> tuple[Limit, ...]:
    """All limits of an itinerary's orbits, in a fixed order."""
    system, itinerary, found = problem.system, problem.itinerary, []
    for i, leg in enumerate(itinerary.legs):
        if leg.collapsed:
            assert leg.transition is not None
            found += _of_collapsed(system, leg.mode, leg.transition, i)
        else:
            found += limits_of_leg(system, leg.mode, leg.transition, itinerary.leading_in(system, i), i)
    return tuple(found)


def _of_collapsed(system: System, mode: str, own: Transition, i: int) -> list[Limit]:
    """The limits of a collapsed leg: its own guard is past zero, and none that is declared before it is."""
    found = [Limit("OC", "crossing", own.name, i, "past")]
    for other in system.leaving(mode):
        if other == own:
            break
        if other.level:
            found.append(Limit("OC", "crossing", other.name, i, "start"))
    return found + conditions_at(system, own, i)


def conditions_at(system: System, own: Transition, i: int) -> list[Limit]:
    """The limits that conditions at a transition are, on leg i."""
    names = [condition.name for condition in system.conditions if condition.at == own.name]
    return [Limit("AZ", name, name, i, "condition", False) for name in names]


def limits_of_leg(system: System, mode: str, own: Transition | None, before: str, i: int) -> list[Limit]:
    """The limits of leg i, in a mode, ended by `own` or nothing, led into by the one named `before`."""
    found: list[Limit] = []
    for other in system.leaving(mode):
        if other.role == "soft":
            continue
        acts = other.role != "watched"
        found.append(Limit("GR", "terminal" if other == own else "interior", other.name, i, "dip", acts))
        if other != own and own is not None:
            label, kind = ("AZ", other.name) if other.role == "watched" else ("OC", "crossing")
            found.append(Limit(label, kind, other.name, i, "start", acts))
            found.append(Limit(label, kind, other.name, i, "end", acts))
        if other.role == "hard" and other.name == before:
            found.append(Limit("GR", "interior", other.name, i, "leaving"))
    if own is None:
        return found
    if own.role == "hard":
        found.append(Limit("GR", "terminal", own.name, i, "rate"))
        found.append(Limit("OC", "crossing", own.name, i, "duration"))
    return found + conditions_at(system, own, i)
