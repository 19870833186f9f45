"""Do declared symmetries take motions to motions?"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.system import Symmetry, System
from contwalk.workflow.check_findings import Report, place_of
from contwalk.workflow.check_functions import EPSILON, check_map
from contwalk.workflow.check_samples import Samples
from contwalk.workflow.check_traced import Traced, vector_form

# Both sides are sums of rounded terms; their bounds are of first order and of single operations.
FACTOR = 100.0


def check_symmetry(
    report: Report,
    symmetry: Symmetry,
    system: System,
    fields: Mapping[str, Traced],
    samples: Samples,
    period: float | None,
) -> None:
    """Check f(S x) = dS/dt + DS f(x), with the exact DS, at sampled states.

    A symmetry may take one mode to another, and with a forced system it may hold half a period later.
    """
    what, place = f"symmetry '{symmetry.name}'", place_of(symmetry.map)
    image = check_map(report, what, symmetry.map, system, samples, vector_form(system, "map", "x_image"))
    if image is None or not fields:
        return
    shifts = [0.0] if period is None else [0.0, 0.5 * period]
    for name, field in fields.items():
        best: tuple[float, str] | None = None
        for other in (name, *[mode for mode in fields if mode != name]):
            for shift in shifts:
                excess, sentence = _violation(image, field, fields[other], samples, shift)
                if best is None or excess < best[0]:
                    best = excess, sentence
        if best is not None and best[0] > 1.0:
            report.error(
                what,
                f"It does not hold in mode '{name}': {best[1]}. "
                "Correct the map or the field, or remove the symmetry.",
                place,
            )
            return
    report.ok(what, f"f(S x) = DS f(x) holds at {len(samples.states)} states.", place)


def _violation(
    image: Traced, before: Traced, after: Traced, samples: Samples, shift: float
) -> tuple[float, str]:
    """How far the two sides differ, in units of what rounding allows, and where most."""
    worst, sentence = 0.0, ""
    for t, x in zip(samples.times, samples.states, strict=True):
        slope = image.slopes(t, x, samples.values)
        mapped = image.values(t, x, samples.values)
        left = after.values(t + shift, mapped, samples.values)
        rates = before.values(t, x, samples.values)
        right = slope[:, 0] + slope[:, 1:] @ rates
        if not (np.isfinite(left).all() and np.isfinite(right).all()):
            continue
        inherited = np.abs(after.slopes(t + shift, mapped, samples.values)) @ np.abs([t + shift, *mapped])
        bound = after.roundings(t + shift, mapped, samples.values) + inherited
        bound += np.abs(slope[:, 1:]) @ (before.roundings(t, x, samples.values) + np.abs(rates))
        difference = np.abs(left - right)
        excess = difference / np.maximum(FACTOR * EPSILON * bound, np.finfo(float).tiny)
        i = int(np.argmax(excess))
        if excess[i] > worst:
            name = image.form.names[i]
            worst = float(excess[i])
            sentence = (
                f"the rate of {name} at the image is {left[i]:.6g}, the image of the rate is {right[i]:.6g}"
            )
    return worst, sentence
