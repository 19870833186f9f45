"""Events that change nothing: in their own mode, with a reset that leaves the state as it is.

Without a reset such an event is refused, and a reset that is the state itself (`x_plus[:] = x`) says that it
is meant. One that says something else, and comes to the same wherever its guard is zero (a coordinate set to
the value that the guard gives it), was meant to do something.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.fields.switching import choices_of
from contwalk.plugin_check.events import happening
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.states_at_event import FACTOR
from contwalk.plugin_check.traced import Traced
from contwalk.system import System, Transition

# By how much parameters are moved to see whether a reset changes something for others.
MOVED = 0.37


def check_keeping(
    report: Report, transition: Transition, guard: Traced, reset: Traced, field: Traced, samples: Samples
) -> None:
    """Tell of a reset that keeps every state of its own event, for whatever parameters."""
    own = transition.source == transition.target and transition.relabel is None
    if not own or transition.role != "hard" or reset.is_identity():
        return
    # What is chosen may be another thing elsewhere, and so may what a mode's constants decide.
    if choices_of(reset.program) or guard.system.mode(transition.source).constants:
        return
    kept = [
        _keeps(transition, guard, reset, field, given) for given in (samples, _moved(guard.system, samples))
    ]
    if not all(kept):
        return
    report.error(
        f"reset of transition '{transition.name}'",
        "It changes nothing: wherever its guard is zero, what it writes is the state there, to rounding. "
        "Correct the reset, if something is meant to change; if the event is only to be told, give it "
        "role='watched', or a reset that says so (x_plus[:] = x).",
        place_of(transition.reset),
    )


def _keeps(transition: Transition, guard: Traced, reset: Traced, field: Traced, samples: Samples) -> bool:
    """Whether the state is kept at all states of the event that are tried; False where there are none."""
    before = happening(transition, guard, field, samples).before
    states = [int(i) for i in np.flatnonzero(reset.form.wanted) if i in reset.existing]
    return bool(before) and all(_same(reset, t, x, states, samples) for t, x in before)


def _same(reset: Traced, t: float, x: np.ndarray, states: list[int], samples: Samples) -> bool:
    jump = np.abs(reset.values(t, x, samples.values) - x)[states]
    level = reset.roundings(t, x, samples.values)[states] + np.abs(x).max()
    return bool(np.all(jump <= FACTOR * EPSILON * level))


def _moved(system: System, samples: Samples) -> Samples:
    """The same states with other parameters, within their bounds."""
    values = {}
    for k, parameter in enumerate(system.parameters):
        low, high = (np.nan if bound is None else bound for bound in parameter.bounds)
        value = samples.parameters[parameter.name]
        other = value * (1.0 + MOVED / (k + 1.0)) or MOVED
        values[parameter.name] = float(np.fmin(np.fmax(other, low), high))
    return replace(samples, parameters=values, values=list(values.values()))
