"""The line of a plugin at which an orbit through events has no value: a field, a guard or a reset there."""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.functions_without_value import functions_of
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Margins
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.kink import Undefined
from contwalk.problems.orbit import without_value
from contwalk.problems.orbit.undefined import refusal
from contwalk.python_functions import line_of
from contwalk.system import Transition


def refuse_guards(problem: LimitedOrbit, z: np.ndarray, margins: Margins) -> None:
    """Raise for an orbit on which a guard out of a leg's mode has no value, whether it ends the leg or not.

    Nothing tells then whether its event happens. Conditions, at which nothing happens, are told otherwise.

    z has the shape (N + 1,).

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
        transition = problem.system.transition(limit.name, problem.itinerary.legs[limit.leg].mode)
        sentence = _of_guard(view, transition)
        if sentence:
            raise refusal(sentence)


def conditions(problem: LimitedOrbit, z: np.ndarray) -> tuple[Undefined, ...]:
    """The conditions at soft transitions of an orbit z, shape (N + 1,), that are not a number there.

    Which soft transitions an orbit meets is not stored, as that of hard ones is: nothing tells later whether
    a condition has no value, or no event.
    """
    soft = {transition.name for transition in problem.system.acting if transition.role == "soft"}
    asked = [condition for condition in problem.system.conditions if condition.at in soft]
    if not asked:
        return ()
    margins = problem.margins(z)
    lacking = {margins.limits[k].name for k in np.flatnonzero(np.isnan(margins.values)).tolist()}
    return tuple(
        Undefined(0, line_of(condition.function).removesuffix(": "), f"condition '{condition.name}'")
        for condition in asked
        if condition.name in lacking
    )


def _of_guard(view: GuardedView, transition: Transition) -> str:
    """Where a guard, or its rate along the motion, has no value on a leg."""
    times, found, rates = view.guard(transition)
    without = np.flatnonzero(~np.isfinite(found))
    name = f"guard of transition '{transition.name}'"
    if len(without):
        share, passage = times[without[:1]], view.piece.passage
        own = {name: functions_of(passage.system, passage.leg.mode)[name]}
        values = view.piece.values(view.scalars)
        return without_value.at(passage, values, float(share[0]), view.at(share)[0], own) or (
            f"{line_of(transition.guard)}the {name} has no value."
        )
    if np.isfinite(rates).all():
        return ""
    return f"{line_of(transition.guard)}the {name} has no finite derivative by the time along an orbit."
