"""Guards that cannot be one, told by their expressions: they keep their sign, or are another one again."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations

from contwalk.fields.ranges import Interval, ranges
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.traced import Traced, number_form, traced
from contwalk.system import System, Transition

FORM = number_form("guard(t, x, p)")


def traced_guard(report: Report, what: str, transition: Transition, system: System) -> Traced | None:
    """A transition's guard; None, and a finding, where it cannot be used."""
    found = traced(report, what, transition.guard, system, FORM, mode=transition.source)
    if found is None:
        return None
    wrong = _cannot_pass(found, transition) or _cannot_be_level(found, transition)
    if not wrong:
        return found
    report.error(what, wrong, place_of(transition.guard))
    return None


def _cannot_pass(guard: Traced, transition: Transition) -> str:
    """Why its sign never changes; empty where it may."""
    if not guard.depends():
        return "It depends neither on the state nor on t, so it never passes zero."
    if transition.role == "watched":
        return ""
    low, high = _interval(guard)
    if low < 0.0 < high:
        return ""
    sign, turned = ("negative", "positive") if low >= 0.0 else ("positive", "negative")
    return (
        f"It is never {sign}, whatever the state is, and so it never passes zero: a square, an absolute "
        f"value, a root or max(..., 0) is no guard. Return a number that is {turned} on one side of the "
        f"event and {sign} on the other, such as the distance itself."
    )


def _interval(guard: Traced) -> Interval:
    """In which its values lie, for parameters within their bounds."""
    bounds = parameter_bounds(guard.system)
    found = [ranges(guard.program.graph, leaf.nodes, bounds)[0] for leaf in guard.outputs()]
    return min(low for low, _ in found), max(high for _, high in found)


def parameter_bounds(system: System) -> dict[tuple[str, int], Interval]:
    """In which intervals the inputs lie that are parameters."""
    bounds: dict[tuple[str, int], Interval] = {}
    for k, parameter in enumerate(system.parameters):
        low, high = parameter.bounds
        bounds["p", k] = (-math.inf if low is None else low, math.inf if high is None else high)
    return bounds


def _cannot_be_level(guard: Traced, transition: Transition) -> str:
    # Out of another mode it happens no more: friction that holds until a force exceeds it, for example.
    again = transition.target == transition.source
    if not (transition.level and again) or guard.depends() != {0}:
        return ""
    return (
        "With level=True its transition happens wherever its mode is entered while it is past zero, but it "
        "depends on time alone: it is past zero for a part of each period, and the transition would happen "
        "again at once. Leave level out: what happens at given times happens where its guard passes zero."
    )


def check_timeless(report: Report, what: str, function: Traced) -> None:
    """Check that what belongs to a transition does not depend on time, in a system that has no period."""
    if 0 in function.depends():
        report.error(
            what,
            "It depends on t, but the system declares no period: motions can be simulated, but no orbit "
            "can be found. Declare period=function of p, as period=lambda p: 2 * math.pi / p.omega.",
            place_of(function.function),
        )


def check_twins(report: Report, system: System, guards: Mapping[str, Traced]) -> None:
    """Tell of transitions out of one mode that always happen at the same instant: one of them never does.

    `guards` are those that have been traced, by the names of their transitions.
    """
    texts = {}
    if not any(mode.constants for mode in system.modes):  # the same function is another one in another mode
        texts = {id(guard.function): _text(guard) for guard in guards.values()}
    told = set[tuple[str, str]]()
    for mode in system.modes:
        acting = [each for each in system.leaving(mode.name) if each.role != "watched"]
        keys = [texts.get(id(each.guard), each.guard) for each in acting]
        if len(set(keys)) == len(keys):
            continue
        for (one, twin), (other, transition) in combinations(zip(keys, acting, strict=True), 2):
            if one != other or not _overlap(twin.direction, transition.direction):
                continue
            if (twin.name, transition.name) in told:
                continue
            told.add((twin.name, transition.name))
            report.error(
                f"guard of transition '{transition.name}'",
                f"It is the same as that of '{twin.name}', which leads out of mode '{mode.name}' too, in the "
                "same direction: both would happen at one instant, and which of them does would be left to "
                "their order. Write one transition; what depends on the state goes into its reset, or into a "
                "mode between with transitions that have level=True.",
                place_of(transition.guard),
            )


def _overlap(a: str, b: str) -> bool:
    return a == b or "both" in (a, b)


def _text(guard: Traced) -> str:
    return repr((guard.program.tree, guard.program.graph.nodes))
