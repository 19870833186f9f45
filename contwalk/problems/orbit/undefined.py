"""The plugin's line where an orbit of a smooth system has no value."""

from __future__ import annotations

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.problems.orbit import without_value
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import PLAIN

REMEDY = "Let it have a value wherever orbits of the range go."


def where(orbit: DiscretizedOrbit, z: np.ndarray) -> str:
    """`The field of mode 'NAME': file, line n: what.` on the way of z; empty if it has values everywhere.

    z has the shape (N + 1,).
    """
    if not np.isfinite(z).all():
        return ""
    passage, values, method = orbit.passages[0], orbit.given(z), orbit.mesh.method
    field = passage.field(PLAIN)
    c = field.constants(values)
    for steps, x in zip(orbit.mesh.steps, orbit.starts(z), strict=True):
        nodes = flow.along(field, c, steps, x, method)
        if found := without_value.along(passage, values, steps, nodes, method):
            return found
    return ""


def refusal(line: str) -> NotFinite:
    """Why an orbit is none on a part of whose way something has no value."""
    return NotFinite(line or "The motion is not finite everywhere between its steps.", REMEDY)
