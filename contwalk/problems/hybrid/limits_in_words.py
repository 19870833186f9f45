"""Limits in words: where one passes zero, and why orbits beyond are not the machine's."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margin_values import ZERO
from contwalk.problems.hybrid.margins import TOUCH_ENDS, TOUCH_STARTS, Limit
from contwalk.problems.problem import Located

# A touch this soon after the event before, in parts of the closure, is at its instant: less is rounding.
AT_ONCE = 1e-12


def place_of(problem: LimitedOrbit, limit: Limit, located: Located[float]) -> str:
    """Where in the cycle a limit is met, so many seconds after its leg begins."""
    leg = problem.itinerary.legs[limit.leg]
    event = problem.itinerary.leading_in(problem.system, limit.leg)
    begins = "the start of the period" if problem.forced else "the orbit's start"
    before = f"'{event}'" if event else begins
    after = problem.system.lasting(located.data, ".10g")
    if limit.test == "duration":
        return f"'{limit.name}' follows {before} at once: between them mode {leg.mode} lasts no time"
    if limit.test == "condition":
        return f"'{limit.name}' is zero at '{leg.name}'"
    if limit.test == "rate":
        return (
            f"'{limit.name}' arrives with no rate, {after} after {before}, in mode {leg.mode}: "
            "multipliers that grow beyond all bounds do so as the inverse of its rate"
        )
    if limit.test == "past":
        return (
            f"'{limit.name}' follows {before} at once up to here: its guard is zero where "
            f"mode {leg.mode} begins"
        )
    if limit.test in (TOUCH_STARTS, TOUCH_ENDS):
        other = event if limit.test == TOUCH_STARTS else leg.name
        if other == limit.name:
            return (
                f"'{limit.name}' happens where it is touched: its guard has no rate and no second derivative"
            )
        return f"'{limit.name}' is touched at the instant of '{other}': beyond it not in mode {leg.mode}"
    if limit.test == "leaving":
        return f"'{limit.name}' is not left again: right after it, in mode {leg.mode}, its guard has no rate"
    if abs(located.data) <= AT_ONCE * problem.duration(located.z):
        return f"'{limit.name}' is touched at the instant of {before}, in mode {leg.mode}"
    return f"'{limit.name}' is touched {after} after {before}, in mode {leg.mode}"


def sentence(problem: LimitedOrbit, located: Located[float]) -> str:
    """What fails beyond a limit, and what is nearest to it."""
    there = located.problem if located.problem is not None else problem
    limit = located.among(problem.limits)
    found = there.margins(located.z)
    others = [
        (float(r), o, float(v))
        for k, (r, o, v) in enumerate(zip(found.relative, found.limits, found.values, strict=True))
        if k != located.limit and np.isfinite(v) and o.test != "duration"
    ]
    text = f"At {problem.free} = {float(located.z[-1]):.12g} {place_of(there, limit, located)}."
    violated = dict.fromkeys(o.name for r, o, _ in others if r < -ZERO)
    if violated:
        text += f" Not admissible before: {', '.join(violated)}."
    kept = [entry for entry in others if entry[0] > ZERO and entry[1].name != limit.name]  # zero: met as well
    if kept:
        _, nearest, value = min(kept, key=lambda entry: entry[0])
        text += f" Nearest beside it: '{nearest.name}' ({nearest.test}) with a margin of {value:.4g}."
    return text
