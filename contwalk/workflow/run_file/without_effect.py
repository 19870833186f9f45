"""What a run file asks for that cannot come about: nothing is wrong with it, but the user is told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from contwalk.system import System
from contwalk.workflow.run_file.document import Key, dotted
from contwalk.workflow.run_file.problems import Problems

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import RunModel

# What each of these limits is of.
NEEDS = {
    "GR": "an event or a watched transition",
    "OC": "an event that acts",
    "AZ": "a condition, or a watched transition beside an event",
    "BE": "a transition whose guard is passed in one direction",
}


def without_effect(
    problems: Problems, model: RunModel, system: System, ranges: Mapping[str, tuple[float, float]]
) -> dict[str, str]:
    """Sentences with file, line and key, by what they are of.

    Parameters
    ----------
    ranges : mapping of str to tuple of two floats
        The parameters that are free, and from where to where.
    """
    return {
        f"without_effect {dotted(key)}": f"{problems.document.where(key)}: {sentence}"
        for key, sentence in {**_values(model, ranges), **_limits(model, system)}.items()
    }


def _values(model: RunModel, ranges: Mapping[str, tuple[float, float]]) -> dict[Key, str]:
    """Values of free parameters that are asked for outside of their ranges."""
    asked: dict[Key, tuple[object, ...]] = {
        **{("mark", name): values for name, values in model.mark.items()},
        **{("continue", "stop_at", name): values for name, values in model.continue_.stop_at.items()},
    }
    found: dict[Key, str] = {}
    for key, values in asked.items():
        name = str(key[-1])
        low, high = ranges.get(name, (-float("inf"), float("inf")))
        outside = [f"{v:.12g}" for v in values if isinstance(v, float) and not low <= v <= high]
        if outside and low < high:
            lie = "lies" if len(outside) == 1 else "lie"
            found[key] = (
                f"{', '.join(outside)} {lie} outside the range [{low:.12g}, {high:.12g}] of {name}, and no "
                "branch comes there. Widen the range, or remove the value."
            )
    return found


def _limits(model: RunModel, system: System) -> dict[Key, str]:
    """Limits at which branches are to stop or to switch, of systems that have none of the kind."""
    roles = {transition.role for transition in system.transitions}
    watched = "watched" in roles
    there = {
        "GR": watched or "hard" in roles,
        "OC": "hard" in roles,
        "AZ": bool(system.conditions) or (watched and "hard" in roles),
        "BE": any(transition.direction != "both" for transition in system.transitions),
    }
    found: dict[Key, str] = {}
    for label in sorted(model.events.model_fields_set):
        asked = getattr(model.events, label)
        if asked != "ignore" and not there[label]:
            found["events", label] = (
                f"'{system.name}' has no {label}, which needs {NEEDS[label]}: nothing will {asked} there. "
                "Remove it, or give `ignore`."
            )
    return found
