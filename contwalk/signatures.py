"""Long lists of events in a few words."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

LONG = 4  # events that are listed one by one
# The event that is a step of a map: no other transition has this name.
ITERATE = "iterate"


def told_problem(problem: str) -> str:
    """A problem's name as words."""
    return problem.replace("_", " ")


def is_iterated(signature: Sequence[str] | None) -> bool:
    """Whether orbits of these events are cycles of a map."""
    return bool(signature) and set(signature or ()) == {ITERATE}


def folded(events: Sequence[str]) -> str:
    """Events in their order: `a b` as it is, `32 x a` and `16 x (a b)` where they repeat themselves."""
    events = list(events)
    if len(events) <= LONG:
        return " ".join(events)
    for length in range(1, len(events) // 2 + 1):
        times, rest = divmod(len(events), length)
        if not rest and events == events[:length] * times:
            return _times(times, events[:length])
    runs = [(name, len(list(run))) for name, run in groupby(events)]
    return " ".join(_times(count, [name]) if count > 2 else " ".join([name] * count) for name, count in runs)


def _times(times: int, block: Sequence[str]) -> str:
    """A block so many times; the block itself is folded where it is long."""
    inner = folded(block)
    return f"{times} x {inner}" if len(block) == 1 else f"{times} x ({inner})"
