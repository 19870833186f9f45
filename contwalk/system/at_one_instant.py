"""The order in which transitions act that have the same instant, as declared by `together`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from contwalk.system.modes import Transition


def before_others(transitions: Sequence[Transition]) -> dict[str, frozenset[str]]:
    """Names of the transitions that a declared order has act before one of a name, where there are any.

    A name among its own is an order that goes round in a circle.
    """
    found: dict[str, set[str]] = {}
    for transition in transitions:
        for first, later in combinations(transition.together, 2):
            found.setdefault(later, set()).add(first)
    grown = True
    while grown:
        grown = False
        for earlier in found.values():
            more = set().union(*(found.get(name, ()) for name in earlier)) - earlier
            earlier |= more
            grown = grown or bool(more)
    return {name: frozenset(earlier) for name, earlier in found.items()}


def in_declared_order(
    transitions: Sequence[Transition], before: dict[str, frozenset[str]]
) -> tuple[Transition, ...]:
    """Transitions as they are declared, but none before one that acts earlier where both have one instant."""
    left, found = list(transitions), []
    while left:
        names = {transition.name for transition in left}
        first = next(each for each in left if not before.get(each.name, frozenset()) & names - {each.name})
        left.remove(first)
        found.append(first)
    return tuple(found)
