"""What is cheap to check of events before every run: guards, resets, conditions."""

from __future__ import annotations

from contwalk.plugin_check.at_events import traced_at_event
from contwalk.plugin_check.declarations import check_repeats
from contwalk.plugin_check.event_kinks import check_on_a_jump, chooses
from contwalk.plugin_check.events import check_soft, check_states, happening, traced_reset
from contwalk.plugin_check.findings import Report
from contwalk.plugin_check.functions import check_never_finite
from contwalk.plugin_check.guards import check_twins, traced_guard
from contwalk.plugin_check.keeping import check_keeping
from contwalk.plugin_check.modes import CheckedFields, distinct_transitions
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced
from contwalk.system import System


def check_events(
    report: Report, system: System, fields: CheckedFields, samples: Samples, period: float | None
) -> None:
    """Check all transitions and conditions of a system."""
    guards = dict[str, Traced]()
    for transition in distinct_transitions(system):
        what = f"guard of transition '{transition.name}'"
        guard, reset = (
            traced_guard(report, what, transition, system),
            traced_reset(report, transition, system),
        )
        for name, function in ((what, guard), (f"reset of transition '{transition.name}'", reset)):
            if function is None or not check_never_finite(report, name, function, samples):
                continue
            if period is not None:
                turned = function is guard and transition.direction == "both"
                check_repeats(report, name, function, samples, period, turned)
        if guard is not None:
            guards[transition.name] = guard
        apart = not check_states(report, transition, system)
        if transition.role == "soft" and not apart and guard is not None:
            check_soft(report, transition, guard, reset, system, fields, samples)
        if guard is not None and transition.source in fields and chooses(guard, reset):
            met = happening(transition, guard, fields[transition.source], samples)
            check_on_a_jump(report, met, reset, system, samples)
        if guard is not None and reset is not None and transition.source in fields:
            check_keeping(report, transition, guard, reset, fields[transition.source], samples)
    check_twins(report, system, guards)
    for entry in system.conditions:
        traced_at_event(report, entry, system)
