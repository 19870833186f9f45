"""What a branch lacks at some points: numbers of the plugin's observables, the reported state, a way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.branch import Branch
from contwalk.python_functions import line_of
from contwalk.system import System
from contwalk.workflow.blind_steps import blind_steps
from contwalk.workflow.growing_cuts import growing_cuts
from contwalk.workflow.run_file.settings import ReportAt

NEVER = "which never happens on them"


def notes_of(branch: Branch, system: System, place: ReportAt | None) -> Iterator[tuple[str, str]]:
    """Keys and sentences of what has no value on a branch, or no direction, one sentence for each reason.

    Parameters
    ----------
    branch : Branch
    system : System
    place : ReportAt, optional
        Where the run file asks for the state of an orbit.
    """
    if not len(branch):
        return
    if blind := blind_steps(branch):
        yield f"direction {branch.name}", blind
    if cut := growing_cuts(branch):
        yield f"cuts {branch.name}", cut
    events = None if branch.info.problem == "equilibrium" else _events(branch, system, place)
    absent = _absent(branch, system, place, events)
    if absent:
        yield f"events {branch.name}", absent
    for observable in system.observables:
        name = observable.name
        lacking = ~np.isfinite(branch[name])
        # One that belongs to an event has no value where there is none.
        if np.any(lacking) and (observable.at is None or (events is not None and observable.at in events)):
            yield (
                f"observable {branch.name} {name}",
                f"{branch.name}: observable '{name}' is not a number {_where(branch, lacking)}; marks of it "
                "cannot be found there.",
            )
    for condition in system.conditions:
        if events is None or condition.at not in events:
            continue
        lacking = ~np.isfinite(branch[condition.name])
        if np.any(lacking):
            yield (
                f"condition {branch.name} {condition.name}",
                f"{branch.name}: {line_of(condition.function)}condition '{condition.name}' is not a number "
                f"{_where(branch, lacking)}: orbits there are told to be not admissible, whatever they are. "
                "Return a number there, negative where the motion is not the machine's.",
            )
    if place is not None and place.section is not None and events is not None:
        state, value = place.section
        never = np.all(np.isnan(branch.points["state"]), axis=1)
        if np.any(never):
            yield (
                f"section {branch.name}",
                f"{branch.name}: its orbits never pass {state} = {value:.10g} {_where(branch, never)}, where "
                f"`report_at` asks for their state: NaN is stored instead. Ask for a value of {state} that "
                "they pass (see its least and largest one), or leave `report_at` out.",
            )


def _where(branch: Branch, at: np.ndarray) -> str:
    """At how many points, and where the first one is."""
    value, free = float(branch.points["free"][at][0, 0]), branch.info.free[0]
    return f"at {np.sum(at)} of {len(at)} points, the first of them at {free} = {value:.10g}"


def _events(branch: Branch, system: System, place: ReportAt | None) -> tuple[str, ...]:
    """Names of the events on a branch's orbits, images included, in their order.

    Soft ones, which come and go along a branch, are those at which something that is asked for has a value.
    """
    settings = branch.info.settings
    if "legs" not in settings:
        return ()
    from contwalk.problems.orbit.itinerary import named_itinerary  # of machines with events alone

    itinerary = named_itinerary(system, settings["legs"], settings["image"]).unfolded(system)
    asked = {observable.at: branch[observable.name] for observable in system.observables}
    asked |= {} if place is None else {place.event: branch.points["state"]}
    soft = {transition.name for transition in system.acting if transition.role == "soft"}
    met = [name for name, values in asked.items() if name in soft and np.any(np.isfinite(values))]
    return tuple(dict.fromkeys([*(each.name for each in itinerary.legs if each.name), *map(str, met)]))


def _absent(branch: Branch, system: System, place: ReportAt | None, events: tuple[str, ...] | None) -> str:
    """A sentence where an event never happens at which something is asked for; empty where all of them do."""
    if events is None:
        return ""
    asked = place.event if place is not None and place.event not in events else None
    observables = [o for o in system.observables if o.at is not None and o.at not in events]
    if asked is None and not observables:
        return ""
    said = []
    if asked is not None:
        missing = bool(np.all(np.isnan(branch.points["state"])))
        stored = (
            "NaN is stored as their state" if missing else "their state is that where their phase is fixed"
        )
        said.append(f"`report_at` asks for their state at '{asked}', {NEVER}: {stored}.")
    for observable in observables:
        said.append(f"Observable '{observable.name}' is taken at '{observable.at}', {NEVER}: it is NaN.")
    they = f"They have {_named(events)}." if events else "They have no event at which a state is taken."
    remedies = []
    if asked is not None:
        other = "one of these events or " if events else ""
        remedies.append(f"Let `report_at` name {other}a section, or leave it out")
    if observables:
        remedies.append(
            "take observables at events that orbits have, or over the whole motion (without `at`)"
        )
    remedy = "; ".join(remedies)
    return f"{branch.name}, its orbits: {' '.join(said)} {they} {remedy[0].upper()}{remedy[1:]}."


def _named(events: tuple[str, ...]) -> str:
    quoted = [f"'{name}'" for name in events]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"
