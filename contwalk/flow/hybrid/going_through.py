"""Events after which their guards go on through zero, more slowly than they came.

They are pushes against a motion, or stops whose reset has the wrong sign.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from contwalk.flow.hybrid.guard_status import BEYOND, PASSED, guard_statuses
from contwalk.flow.hybrid.machine import HybridMachine, landed
from contwalk.python_functions import line_aside
from contwalk.system import Transition

# A transition with time and state of full length right before it.
Happened = tuple[Transition, float, np.ndarray]


def going_through(machine: HybridMachine, events: Iterable[Happened]) -> str:
    """A sentence on the first such event of each transition; empty if there is none."""
    met: dict[tuple[str, str], Happened] = {}
    for event in events:
        met.setdefault((event[0].name, event[0].source), event)
    found = {each[0].name: each[0] for each in met.values() if _goes_through(machine, *each)}
    return " ".join(_sentence(transition) for transition in found.values())


def _sentence(transition: Transition) -> str:
    return (
        f"After '{transition.name}' its guard goes on through zero, more slowly than it came"
        f"{line_aside(transition.reset)}: it happens again only where it has been back. That is right for "
        "a push against the motion; a stop whose reset has the wrong sign looks like that."
    )


def _goes_through(machine: HybridMachine, transition: Transition, t: float, x: np.ndarray) -> bool:
    if transition.role == "soft" or transition.reset is None:
        return False
    flow, source = machine.mode(transition.target), machine.mode(transition.source)
    own = [i for i, each in enumerate(flow.transitions) if each.name == transition.name]
    own = [i for i in own if flow.transitions[i].guard is transition.guard]
    after, noise = landed(machine, transition, t, x)
    if not own or flow.guards[own[0]].code.of_time_alone or not np.isfinite(after).all():
        return False
    weights = np.maximum(np.abs(x), np.abs(after))
    given = after[flow.states], noise[flow.states], weights[flow.states]
    names = flow.left_at_zero(transition.name)
    stands = guard_statuses(flow, t, *given, names, flow.passed(transition.name))[own[0]]
    came = float(source.guards[source.transitions.index(transition)](t, x[source.states], source.p)[1])
    return stands.kind == BEYOND or (stands.kind == PASSED and abs(stands.rate) < abs(came))
