"""Checks that every function of a plugin passes: its form, its values, its derivatives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.errors import PluginError
from contwalk.plugin_check.findings import Report, place_of, place_of_error
from contwalk.plugin_check.guards import traced_guard
from contwalk.plugin_check.samples import Samples, where_not_finite
from contwalk.plugin_check.traced import AGAIN, OTHERWISE, Form, Traced, traced, vector_form
from contwalk.system import Mode, System, Transition

EPSILON = float(np.finfo(float).eps)
# A trace may sum in another order than the plugin does; both are within their rounding bounds.
SAME = 16.0
# A central difference errs least for steps of about the cube root of the machine epsilon.
STEP = EPSILON ** (1.0 / 3.0)


def check_field(report: Report, what: str, mode: Mode, system: System, samples: Samples) -> Traced | None:
    """Check a mode's field; None where it cannot be used."""
    function, form = mode.field, field_form(mode, system)
    found = traced_field(report, what, mode, system)
    if found is None or not check_values(report, what, found, samples):
        return None
    check_derivatives(report, what, found, samples)
    check_clock(report, what, found, system, function)
    report.ok(what, f"writes {_count(form, system)} and can be differentiated.", place_of(function))
    return found


def check_clock(
    report: Report, what: str, field: Traced, system: System, function: Callable[..., Any]
) -> None:
    """Check that a field that depends on the time belongs to a system with a period."""
    if system.period is None and 0 in field.depends():
        report.error(
            what,
            "It depends on t, but the system declares no period. Declare period=function of p, as "
            "period=lambda p: 2 * math.pi / p.omega.",
            place_of(function),
        )


def traced_field(report: Report, what: str, mode: Mode, system: System) -> Traced | None:
    """A mode's field; None, and a finding, where it cannot be used."""
    return traced(report, what, mode.field, system, field_form(mode, system), mode=mode.name)


def field_form(mode: Mode, system: System) -> Form:
    """What a mode's field must write."""
    existing = None if mode.states is None else system.states_of(mode.name)
    return vector_form(system, "field", "dx", existing)


def _count(form: Form, system: System) -> str:
    """How many components are written, in words."""
    if form.needed is None:
        return f"all {len(system.states)} components"
    return f"the {len(form.needed)} components that exist there"


def check_guard(
    report: Report, what: str, transition: Transition, system: System, samples: Samples
) -> Traced | None:
    """Check a transition's guard; None where it cannot be used."""
    found = traced_guard(report, what, transition, system)
    if found is None or not check_values(report, what, found, samples):
        return None
    check_derivatives(report, what, found, samples)
    report.ok(what, "returns a finite number.", place_of(transition.guard))
    return found


def check_map(
    report: Report,
    what: str,
    function: Callable[..., Any],
    system: System,
    samples: Samples,
    form: Form,
    mode: str | None = None,
) -> Traced | None:
    """Check a reset, a symmetry's map or a neutral generator; None where it cannot be used."""
    found = traced(report, what, function, system, form, mode=mode)
    if found is None or not check_values(report, what, found, samples):
        return None
    check_derivatives(report, what, found, samples)
    report.ok(what, f"writes {_count(form, system)}.", place_of(function))
    return found


def check_values(report: Report, what: str, found: Traced, samples: Samples) -> bool:
    """Finite at the samples, and the same as when the function is called with plain numbers."""
    values = np.array([samples.evaluate(found, row) for row in range(len(samples.states))])
    finite = np.isfinite(values).all(axis=1)
    if not finite.all():
        row = int(np.argmin(finite))
        where, what_arises = where_not_finite(
            found, samples.times[row], samples.states[row], samples.parameters
        )
        at = f"at the default parameters and the state {_shown(found.system, samples.states[row])}"
        if not finite.any():
            report.error(what, f"It is not finite at any state that was tried: {what_arises}, {at}.", where)
            return False
        report.warning(
            what,
            f"It is not finite at {np.sum(~finite)} of {len(finite)} states that were tried: {what_arises}, "
            f"{at}. A run that gets there ends.",
            where,
        )
    for row in map(int, np.flatnonzero(finite)):
        t, x = samples.times[row], samples.states[row]
        try:
            own = found.plainly(t, x, samples.parameters)
        except PluginError as error:
            report.error(what, str(error), place_of_error(error.__cause__ or error, found.function))
            return False
        bound = SAME * EPSILON * (found.roundings(t, x, samples.values) + np.abs(values[row]))
        bound[np.isnan(bound)] = np.inf  # at a root of zero any rounding moves its value
        if not (np.abs(own - values[row]) <= bound).all():
            report.error(
                what,
                f"{_otherwise(found, own, values[row], bound, t, x, samples)} Seen at the state "
                f"{_shown(found.system, x)}.",
                place_of(found.function),
            )
            return False
    return True


def _otherwise(
    found: Traced,
    own: np.ndarray,
    values: np.ndarray,
    bound: np.ndarray,
    t: float,
    x: np.ndarray,
    samples: Samples,
) -> str:
    """Why its own values are not those of its trace: it does not even repeat itself, or it does."""
    if not np.array_equal(own, found.plainly(t, x, samples.parameters), equal_nan=True):
        return AGAIN
    i = int(np.argmax(~(np.abs(own - values) <= bound)))
    return OTHERWISE.format(own=own[i], value=values[i])


def check_never_finite(report: Report, what: str, found: Traced, samples: Samples) -> bool:
    """A constant NaN in a function without a value at any state makes it so at all parameters too."""
    if not found.has_nan:
        return True
    if any(np.isfinite(samples.evaluate(found, row)).all() for row in range(len(samples.states))):
        return True
    return check_values(report, what, found, samples)


def check_derivatives(report: Report, what: str, found: Traced, samples: Samples) -> None:
    """The exact Jacobian against central differences of the function itself, to the differences' own error.

    A difference D(h) with step h errs by c h^2 from truncation, of which |D(2 h) - D(h)| is three times the
    size, and by rounding of the values over h. Three times the first and twice the second are allowed.
    """
    for row in range(len(samples.states)):
        t, x = samples.times[row], samples.states[row]
        slope = found.slopes(t, x, samples.values)[:, 1:]
        rounding = EPSILON * found.roundings(t, x, samples.values)
        for j in range(len(x)):
            h = STEP * max(abs(x[j]), samples.scales[j])
            near, far = (_difference(found, t, x, j, k * h, samples.parameters) for k in (1.0, 2.0))
            allowed = 3.0 * np.abs(far - near) + 2.0 * (rounding + EPSILON * np.abs(slope[:, j] * x[j])) / h
            wrong = np.abs(near - slope[:, j]) > allowed
            if wrong.any():
                i = int(np.argmax(wrong))
                entry = found.form.entry(i) if found.form.argument else "its value"
                report.error(
                    what,
                    f"The derivative of {entry} by {found.system.state_names[j]} is {slope[i, j]:.10g}, "
                    f"but a central difference with the step {h:.2g} gives {near[i]:.10g}, which errs by at "
                    f"most {allowed[i]:.1g}, at the state {_shown(found.system, x)}. Does the function do "
                    "more than arithmetic with x, such as rounding, or remember earlier calls?",
                    place_of(found.function),
                )
                return


def _difference(
    found: Traced, t: float, x: np.ndarray, j: int, h: float, parameters: dict[str, float]
) -> np.ndarray:
    """Central difference by state j; NaN, which agrees with everything, where the function has no value."""
    right, left = x.copy(), x.copy()
    right[j] += h
    left[j] -= h
    width = right[j] - left[j]
    with np.errstate(invalid="ignore"):  # of infinities
        return (found.plainly(t, right, parameters) - found.plainly(t, left, parameters)) / width


def _shown(system: System, x: np.ndarray) -> str:
    """A state in a message: the first six entries."""
    entries = [f"{name}={value:.4g}" for name, value in zip(system.state_names, x, strict=True)]
    return ", ".join(entries[:6]) + (", ..." if len(entries) > 6 else "")
