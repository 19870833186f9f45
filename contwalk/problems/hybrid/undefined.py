"""The line of a plugin at which an orbit through events has no value: a field, a guard or a reset there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.flow.hybrid.blaming import functions_of, line_without_value
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.margins import Margins
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.python_functions import line_of
from contwalk.system import Transition

BREAKDOWNS = (NotFinite, PluginError, np.linalg.LinAlgError)


def where(problem: DiscretizedOrbit, z: np.ndarray) -> str:
    """`The NAME: file, line n: what` of the first function without a value on the way of z; empty if all have
    one.
    """
    if not np.isfinite(z).all():
        return ""
    try:
        views = problem.view(z)
    except BREAKDOWNS:
        return ""
    return next((found for view in views if (found := _on_leg(problem, view, float(z[-1])))), "")


def refuse_guards(problem: DiscretizedOrbit, z: np.ndarray, margins: Margins) -> None:
    """Raise for an orbit on which a guard out of a leg's mode has no value, whether it ends the leg or not.

    Nothing tells then whether its event happens. Conditions, at which nothing happens, are told otherwise.

    Raises
    ------
    NotFinite
    """
    lacking = np.isnan(margins.relative)
    if not lacking.any():
        return
    views = problem.view(z)
    for k in np.flatnonzero(lacking).tolist():
        limit = margins.limits[k]
        if limit.test in ("duration", "condition"):
            continue
        view = views[limit.leg]
        transition = problem.system.transition(limit.name, problem.word.legs[limit.leg].mode)
        sentence = _of_guard(problem, view, transition, float(z[-1]))
        if sentence:
            raise NotFinite(sentence, "Let it have a value wherever orbits of the range go.")


def _of_guard(problem: DiscretizedOrbit, view: LegView, transition: Transition, free: float) -> str:
    """Where a guard, or its rate along the motion, has no value on a leg."""
    times, values, rates = view.guard(transition)
    without = np.flatnonzero(~np.isfinite(values))
    name = f"guard of transition '{transition.name}'"
    if len(without):
        share = times[without[:1]]
        own = {name: functions_of(problem.system, view.piece.passage.leg.mode)[name]}
        return _told(problem, view, free, float(share[0]), view.at(share)[0], own) or (
            f"{line_of(transition.guard)}the {name} has no value."
        )
    if np.isfinite(rates).all():
        return ""
    return f"{line_of(transition.guard)}the {name} has no finite derivative by the time along an orbit."


def _on_leg(problem: DiscretizedOrbit, view: LegView, free: float) -> str:
    """What has no value at the steps of a leg, beyond the last of them, or where it ends."""
    leg = view.piece.passage.leg
    functions = functions_of(problem.system, leg.mode)
    for share, x in _places(view):
        if found := _told(problem, view, free, share, x, functions):
            return found
    if leg.transition is None or leg.transition.reset is None or not np.isfinite(view.end).all():
        return ""
    reset = {f"reset of transition '{leg.name}'": leg.transition.reset}
    return _told(problem, view, free, 1.0, view.end, reset)


def _places(view: LegView) -> Iterator[tuple[float, np.ndarray]]:
    """Instants 0..1 and states at steps of a leg; where it has none, the last one and its rate lead on."""
    steps, nodes = view.piece.steps, view.nodes
    for k, x in enumerate(nodes):
        if np.isfinite(x).all():
            yield float(steps[k]), x
            continue
        if k:
            rate = view.piece.passage.field(PLAIN).along(steps[k - 1 : k], nodes[k - 1 : k], view.constants)[
                0
            ]
            yield float(steps[k]), nodes[k - 1] + (steps[k] - steps[k - 1]) * rate
        return


def _told(
    problem: DiscretizedOrbit,
    view: LegView,
    free: float,
    share: float,
    x: np.ndarray,
    functions: dict,
) -> str:
    """As `line_without_value`, at an instant 0..1 of a leg; sentence without the blank before it."""
    if not np.isfinite(x).all():
        return ""
    t = view.start + share * view.duration if problem.forced else 0.0
    mode = view.piece.passage.leg.mode
    return line_without_value(problem.system, mode, functions, t, view.full(x), problem.line.at(free)).strip()
