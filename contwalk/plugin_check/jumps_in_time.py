"""Guards that jump at instants of time: a jump through zero is an event that no orbit can have."""

from __future__ import annotations

import numpy as np

from contwalk.fields.blame import first_switched
from contwalk.plugin_check.events import Happening
from contwalk.plugin_check.findings import Report, split_switch
from contwalk.plugin_check.samples import Samples, as_field

# A change by less than this part of itself is no jump.
JUMPED = 1e-9


def check_jumps_in_time(report: Report, happening: Happening, samples: Samples, period: float | None) -> None:
    """Tell of jumps of a guard that acts, in the direction of its event."""
    transition, guard = happening.transition, happening.guard
    if transition.role == "watched" or period is None or not guard.program.reads("t"):
        return
    from contwalk.flow.events.jump_instants import JumpInstants, TimeChoices  # compiled flows

    choices = TimeChoices([guard.program])
    if not choices:
        return
    for jump in JumpInstants(choices, np.array(samples.values), period).within(0):
        for x in samples.states:
            ends = [(t, guard.given(x).tolist()) for t in (jump.low, jump.high)]
            if _may_happen(happening, *(float(guard.values(t, x, samples.values)[0]) for t, _ in ends)):
                given = samples.parameters | dict(guard.system.mode(transition.source).constants)
                _tell(report, transition.name, first_switched(as_field(guard), ends[0], ends[1], given))
                return


def _may_happen(happening: Happening, before: float, after: float) -> bool:
    """Whether a jump of the guard goes the way of its event; of a guard of time alone, through zero too."""
    if not abs(after - before) > JUMPED * max(abs(before), abs(after)):
        return False
    if not happening.guard.program.reads("x") and before * after > 0.0:
        return False
    ways = {"rising": after > before, "falling": after < before}
    return ways.get(happening.transition.direction, True)


def _tell(report: Report, name: str, where: str) -> None:
    place, what = split_switch(where)
    report.warning(
        f"guard of transition '{name}'",
        f"It jumps at instants of time ({what}), in the direction of its event: where it jumps "
        "through zero the event happens, and an orbit with that event is refused. Declare what jumps as a "
        "transition of its own, whose guard is of time alone, or a ramp as a state that a clock sets back.",
        place,
    )
