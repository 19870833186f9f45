"""Do declared symmetries take motions to motions?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON, check_map
from contwalk.plugin_check.modes import CheckedFields
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced, vector_form
from contwalk.system import Symmetry, System

# Both sides are sums of rounded terms; their bounds are of first order and of single operations.
FACTOR = 100.0


def check_symmetry(
    report: Report,
    symmetry: Symmetry,
    system: System,
    fields: CheckedFields,
    samples: Samples,
    period: float | None,
) -> None:
    """Check f(S x) = dS/dt + DS f(x), with the exact DS, at sampled states.

    A symmetry may take one mode to another, and with a forced system it may hold half a period later. Of one
    by which a transition relabels, the field knows nothing: it is written for the names as they are. There
    S S x = x is checked.
    """
    what, form = f"symmetry '{symmetry.name}'", vector_form(system, "map", "x_image")
    image = check_map(report, what, symmetry.map, system, samples, form)
    if image is not None and fields.complete:
        compare_symmetry(report, symmetry, image, system, fields, samples, period)


def compare_symmetry(
    report: Report,
    symmetry: Symmetry,
    image: Traced,
    system: System,
    fields: CheckedFields,
    samples: Samples,
    period: float | None,
) -> None:
    """As `check_symmetry`, of a map whose form is right."""
    what, place = f"symmetry '{symmetry.name}'", place_of(symmetry.map)
    if any(transition.relabel == symmetry.name for transition in system.transitions):
        _check_names_return(report, what, image, samples)
        return
    shifts = [0.0] if period is None else [0.0, 0.5 * period]
    compared = 0
    for name, field in fields.items():
        declared = symmetry.modes.get(name)
        others = [field, *[other for mode, other in fields.items() if mode != name]]
        others = others if declared is None else [fields[declared]]
        found = [_compare(image, field, other, samples, shift) for other in others for shift in shifts]
        best = min((c for c in found if c.states), key=lambda c: c.excess, default=None)
        if best is not None and best.excess > 1.0:
            report.error(
                what,
                f"It does not hold in mode '{name}': {best.sentence}. "
                "Correct the map or the field, or remove the symmetry.",
                place,
            )
            return
        compared += 0 if best is None else best.states
    if compared:
        report.ok(what, f"f(S x) = DS f(x) holds at {compared} states.", place)
    else:
        report.ok(what, "not checked whether it holds: no state and its image are both finite.", place)


def _check_names_return(report: Report, what: str, image: Traced, samples: Samples) -> None:
    """Names that are swapped twice are the old ones."""
    place = place_of(image.function)
    for t, x in zip(samples.times, samples.states, strict=True):
        once = image.values(t, x, samples.values)
        twice = image.values(t, once, samples.values)
        inherited = np.abs(image.slopes(t, once, samples.values)[:, 1:]) @ np.abs(once)
        bound = FACTOR * EPSILON * (image.roundings(t, once, samples.values) + inherited + np.abs(x))
        wrong = np.abs(twice - x) > bound
        if wrong.any():
            i = int(np.argmax(wrong))
            report.error(
                what,
                f"Applied twice it does not give the state back: {image.form.names[i]} is {x[i]:.6g} before "
                f"and {twice[i]:.6g} after. A relabelling swaps names; correct the map.",
                place,
            )
            return
    report.ok(what, "applied twice it gives the state back: it swaps names.", place)


@dataclass(frozen=True)
class Comparison:
    """How far both sides differ at most, in units of what rounding allows, where, and at how many states."""

    excess: float
    sentence: str
    states: int


def _compare(image: Traced, before: Traced, after: Traced, samples: Samples, shift: float) -> Comparison:
    """Compare at all samples where both sides are finite."""
    worst, sentence, states = 0.0, "", 0
    for t, x in zip(samples.times, samples.states, strict=True):
        slope = image.slopes(t, x, samples.values)
        mapped = image.values(t, x, samples.values)
        left = after.values(t + shift, mapped, samples.values)
        rates = before.values(t, x, samples.values)
        right = slope[:, 0] + slope[:, 1:] @ rates
        if not (np.isfinite(left).all() and np.isfinite(right).all()):
            continue
        states += 1
        if (np.abs(left - right) <= FACTOR * EPSILON * np.abs(left)).all():
            continue  # what sums of terms that cancel may differ by need not be asked for
        inherited = np.abs(after.slopes(t + shift, mapped, samples.values)) @ np.abs([t + shift, *mapped])
        bound = after.roundings(t + shift, mapped, samples.values) + inherited
        bound += np.abs(slope[:, 1:]) @ (before.roundings(t, x, samples.values) + np.abs(rates))
        excess = np.abs(left - right) / np.maximum(FACTOR * EPSILON * bound, np.finfo(float).tiny)
        i = int(np.argmax(excess))
        if excess[i] > worst:
            worst = float(excess[i])
            sentence = (
                f"the rate of {image.form.names[i]} at the image is {left[i]:.6g}, "
                f"the image of the rate is {right[i]:.6g}"
            )
    return Comparison(worst, sentence, states)
