"""The line of a plugin at which an orbit has no value: a field, a guard or a reset there."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.flow.hybrid.functions_without_value import functions_of
from contwalk.problems.orbit import without_value
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.view import LegView

REMEDY = "Let it have a value wherever orbits of the range go."
BREAKDOWNS = (NotFinite, PluginError, np.linalg.LinAlgError)


def where(orbit: DiscretizedOrbit, z: np.ndarray) -> str:
    """`The NAME: file, line n: what` of the first function without a value on the way of z; empty if all have
    one.

    z has the shape (N + 1,).
    """
    if not np.isfinite(z).all():
        return ""
    try:
        views = orbit.view(z)
    except BREAKDOWNS:
        return ""
    return next((found for view in views if (found := _on_leg(view))), "")


def _on_leg(view: LegView) -> str:
    """What has no value at the steps of a leg, within one of them, or where it ends."""
    piece, leg = view.piece, view.piece.passage.leg
    values, functions = piece.values(view.scalars), functions_of(piece.passage.system, leg.mode)
    if found := without_value.along(piece.passage, values, piece.steps, view.nodes, piece.method, functions):
        return found
    if leg.transition is None or leg.transition.reset is None:
        return ""
    reset = {f"reset of transition '{leg.name}'": leg.transition.reset}
    return without_value.at(piece.passage, values, 1.0, view.end, reset)


def refusal(line: str) -> NotFinite:
    """Why an orbit is none on a part of whose way something has no value."""
    return NotFinite(line or "The motion is not finite everywhere between its steps.", REMEDY)
