"""Are declared conserved quantities conserved, by the fields and by the transitions?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.plugin_check.events import traced_reset
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON
from contwalk.plugin_check.guards import traced_guard
from contwalk.plugin_check.modes import CheckedFields, distinct_transitions
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.states_at_event import states_at_event
from contwalk.plugin_check.traced import Traced, number_form, traced, vector_form
from contwalk.python_functions import plain
from contwalk.system import Conserved, System, Transition
from contwalk.system.declarations import ParameterValues

# Both sides are sums of rounded terms; their bounds are of first order and of single operations.
FACTOR = 100.0
# A guard is met where it is zero but for so many times its rounding.
MET = 1e3


def check_conserved(
    report: Report, quantity: Conserved, system: System, fields: CheckedFields, samples: Samples
) -> None:
    """Check grad H . f = 0 at sampled states, and that H is the same after each transition as before it."""
    what, found = f"conserved quantity '{quantity.name}'", dict[str, Traced]()
    for mode in system.modes:
        function = traced(report, what, quantity.of(mode.name), system, FORM, mode=mode.name)
        if function is None:
            return
        place = place_of(function.function)
        if system.period is None and 0 in function.depends():
            report.error(what, "It depends on t: what is conserved is a function of the state.", place)
            return
        if not function.depends() - {0}:
            sentence = f"It depends on no state in mode '{mode.name}': any motion conserves such a number."
            report.error(what, f"{sentence} Return the quantity itself, such as the energy.", place)
            return
        found[mode.name] = function
    compared = 0
    for name, function in found.items():
        if name not in fields:
            continue
        seen = _along(report, what, function, fields[name], name, _within(system, name, function, samples))
        if seen is None:
            return
        compared += seen
    for transition in distinct_transitions(system):
        if transition.role == "watched" or not fields.complete:
            continue
        seen = _across(report, what, found, transition, fields[transition.source], system, samples)
        if seen is None:
            return
        compared += seen
    place = place_of(quantity.of(system.modes[0].name))
    if compared:
        report.ok(what, f"is conserved at {compared} states.", place)
    else:
        report.ok(what, "not checked whether it is conserved: it is not finite at any state.", place)


FORM = number_form("function(t, x, p)")


def _within(system: System, mode: str, function: Traced, samples: Samples) -> Samples:
    """The samples at which no transition out of a mode is past its event; all, if there are none.

    One function may serve for all modes, as `0.5 * v ** 2 + 0.5 * k * min(x, 0) ** 2` does for a ball on a
    spring: in flight it is the energy above the spring only.
    """
    p = ParameterValues(**samples.parameters, **system.mode(mode).constants)

    def past(transition: Transition, t: float, x: np.ndarray) -> bool:
        try:
            with np.errstate(all="ignore"):
                value = float(plain(transition.guard)(t, function.given(x), p))
        except (Exception, SystemExit):  # told where the guard itself is checked
            return False
        return {"falling": value < 0.0, "rising": value > 0.0}.get(transition.direction, False)

    acting = [each for each in system.leaving(mode) if each.role != "watched"]
    rows = [
        row
        for row, (t, x) in enumerate(zip(samples.times, samples.states, strict=True))
        if not any(past(each, float(t), x) for each in acting)
    ]
    return replace(samples, states=samples.states[rows], times=samples.times[rows]) if rows else samples


def _along(
    report: Report, what: str, function: Traced, field: Traced, mode: str, samples: Samples
) -> int | None:
    """At how many states motions of a mode keep a quantity; None, and a finding, where one does not."""
    compared = 0
    for t, x in zip(samples.times, samples.states, strict=True):
        gradient = function.slopes(t, x, samples.values)[0, 1:]
        rates = field.values(t, x, samples.values)
        terms = np.abs(gradient * rates)
        rounded = field.roundings(t, x, samples.values) + np.abs(rates)
        bound = float(np.abs(gradient) @ rounded + terms.sum())
        rate = float(gradient @ rates)
        if not (np.isfinite(rate) and np.isfinite(bound)):
            continue
        compared += 1
        if abs(rate) > FACTOR * EPSILON * bound:
            report.error(
                what,
                f"It is not conserved in mode '{mode}': it changes at a rate of {rate:.6g}, with terms up to "
                f"{float(terms.max()):.6g}. Correct its function or the field, or remove it.",
                place_of(function.function),
            )
            return None
    return compared


def _across(
    report: Report,
    what: str,
    functions: dict[str, Traced],
    transition: Transition,
    field: Traced,
    system: System,
    samples: Samples,
) -> int | None:
    """At how many states a transition keeps a quantity; None, and a finding, where it does not at one."""
    silent, compared = Report(), 0
    guard = traced_guard(silent, "guard", transition, system)
    reset = traced_reset(silent, transition, system)
    if guard is None or (transition.reset is not None and reset is None):
        return 0
    relabel = None
    if transition.relabel is not None:
        symmetry = system.symmetry(transition.relabel)
        relabel = traced(silent, "map", symmetry.map, system, vector_form(system, "map", "x_image"))
    before, after = functions[transition.source], functions[transition.target]
    for t, x in states_at_event(transition, guard, field, samples):
        landed = x if reset is None else reset.values(t, x, samples.values)
        slope = np.eye(len(x)) if reset is None else np.abs(reset.slopes(t, x, samples.values)[:, 1:])
        if relabel is not None:
            slope = np.abs(relabel.slopes(t, landed, samples.values)[:, 1:]) @ slope
            landed = relabel.values(t, landed, samples.values)
        one, other = before.values(t, x, samples.values)[0], after.values(t, landed, samples.values)[0]
        bound = before.roundings(t, x, samples.values)[0] + after.roundings(t, landed, samples.values)[0]
        left, right = before.slopes(t, x, samples.values), after.slopes(t, landed, samples.values)
        bound += MET * float((np.abs(left[0, 1:]) + np.abs(right[0, 1:]) @ slope) @ np.abs(x))
        if not (np.isfinite(one) and np.isfinite(other) and np.isfinite(bound)):
            continue
        compared += 1
        if abs(one - other) > FACTOR * EPSILON * bound:
            report.error(
                what,
                f"Transition '{transition.name}' does not keep it: it is {one:.8g} before and {other:.8g} "
                "after. Correct its function or the reset, or remove it.",
                place_of(transition.reset or transition.guard),
            )
            return None
    return compared
