"""How a walk can end, each a reason code with a sentence and a remedy."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import ContwalkError
from contwalk.problems.problem import LimitType

# What cannot be computed is said by these: it ends one point, one direction or one branch, never a run.
BREAKDOWNS = (ContwalkError, np.linalg.LinAlgError)


def bound(name: str, value: float) -> Outcome:
    """The free parameter reached an end of its range."""
    return Outcome(
        "complete", "bound", f"Reached the end of the range, {name} = {value:.10g}. Widen `range` to go on."
    )


def bound_but_for(name: str, value: float, last: float) -> Outcome:
    """The free parameter is as near to an end of its range as steps go, and no solution was found there."""
    return Outcome(
        "complete",
        "bound",
        f"Reached the end of the range, {name} = {value:.10g}, but for {abs(value - last):.1e}: no solution "
        "was found at the end itself, where the equations may have none. Nothing to do.",
    )


def stays_at_bound(name: str, value: float) -> Outcome:
    """The free parameter stands still at an end of its range, and the branch goes on along it."""
    words = f"The branch stays at the end of the range, {name} = {value:.10g}, to what it is known to."
    return Outcome("complete", "bound", f"{words} Widen `range` to follow it.")


def closed() -> Outcome:
    """The branch came back to its start."""
    return Outcome("complete", "closed", "The branch is closed: it came back to its start. Nothing to do.")


def returned_to_parent() -> Outcome:
    """The orbit became one that repeats itself, or is its own image: its parent's again, or another's."""
    return Outcome(
        "complete",
        "rejoined",
        "The orbit has become one that repeats itself, or is its own image: the branch ends on the branch of "
        "those. Nothing to do.",
    )


def slid_onto_parent(name: str, value: float) -> Outcome:
    """The walk came to lie along the branch that its own one left, without passing it."""
    return Outcome(
        "failed",
        "no_convergence",
        f"Before {name} = {value:.10g} the walk has come onto the branch of solutions that repeat "
        "themselves, or are their own images, from which its own one leaves: its last points are not "
        "its own. A finer `accuracy`, or more `engine: {segments}` of orbits, tell the two apart.",
    )


def stop_at(what: str) -> Outcome:
    """A value of `stop_at` was met."""
    return Outcome("stopped", "stop_at", f"Stopped at {what}, as asked. Remove it from `stop_at` to go on.")


def neutral_saddles() -> Outcome:
    """A curve of Hopf points would go on as neutral saddles."""
    return Outcome(
        "stopped",
        "stop_at",
        "Stopped where the frequency vanishes, as asked: the curve goes on as neutral saddles with --set "
        "engine.neutral_saddles=follow.",
    )


def limit(point: LimitType, final: bool, asked: str, words: str) -> Outcome:
    """The orbits beyond are not the machine's, or have another itinerary; `final`: none of them is ever."""
    reason, label = point.reason, point.like or point.label
    if asked == "switch":
        return Outcome("complete", reason, words)
    if final:
        words += (
            " What solves the equations beyond it passes that guard earlier: no orbit of this signature "
            "is the machine's."
        )
    ways = [] if final else [f"--set events.{label}=ignore goes on past it"]
    # A limit that is told under another label is one of a curve: no other curve is begun at it.
    if not (point.declared or point.like):
        ways.append(f"--set events.{label}=switch goes on to {point.beyond}")
    return Outcome("stopped", reason, " ".join([words, *(f"{way}." for way in ways)]))


def max_points(number: int, growth: str = "") -> Outcome:
    """The limit of points was reached; `growth` is a sentence on what has made steps short."""
    words = f"Reached max_points = {number}. Raise it and continue from the last point."
    return Outcome("stopped", "max_points", f"{words} {growth}".rstrip())


def effort() -> Outcome:
    """A direction has cost what it may."""
    return Outcome(
        "stopped",
        "effort",
        "Left for later: it has cost as many right-hand sides as `diagram.effort` allows. With --resume "
        "--set diagram.effort=none it goes on from here.",
    )


def stuck(reason: str, sentence: str, step: float, name: str, value: float, known: str = "") -> Outcome:
    """No step of any length succeeded; `known` is what the problem knows to be in the way, and what helps."""
    if reason in ("not_finite", "plugin_error"):
        return given_up(reason, sentence, name, value, known)
    other = "The branch may end there, or the field may not be smooth; look at it with `contwalk show`."
    where = f"at {name} = {value:.10g}"
    return Outcome(
        "failed",
        "step_too_small",
        f"No step succeeds {where}, down to {step:.1e}: {sentence} {known or other}",
    )


def noise(which: str, error: float, name: str, value: float) -> Outcome:
    """Points, `which` ones in words, lie nearer to each other than solutions are known to."""
    return Outcome(
        "failed",
        "step_too_small",
        f"At {name} = {value:.10g} {which} lie nearer to each other than solutions there are known to "
        f"({error:.1e} in the metric of the branch): what the walk tells from there on is rounding. End the "
        "range before it; or fix the parameter there and continue over another one.",
    )


def given_up(reason: str, sentence: str, name: str, value: float, known: str = "") -> Outcome:
    """Something beside a point could not be computed, for this reason; `known` as of `stuck`."""
    where = f"The last good point is at {name} = {value:.10g}"
    if reason == "plugin_error":
        return Outcome("failed", reason, f"{sentence} {where}.")
    return Outcome(
        "failed", reason, " ".join(f"{sentence} {known} {where}; end the range before it.".split())
    )


def reason_of(error: ContwalkError | np.linalg.LinAlgError) -> str:
    """The reason code of what ends with an error: that of its class; singular equations have no solution."""
    return error.reason if isinstance(error, ContwalkError) else "no_convergence"


def singular(error: np.linalg.LinAlgError) -> str:
    """What linear algebra stumbles over, in a sentence."""
    return f"The equations there are singular: more than one solution, or none, is near ({error})."
