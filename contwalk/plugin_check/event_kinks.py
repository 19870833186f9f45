"""Guards and resets that are smooth by pieces only, where their event happens.

Where a reset or the surface of a guard jumps no orbit beyond is near, and where slopes jump multipliers do.
Elsewhere nothing depends on it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from contwalk.fields.blame import first_switched
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.plugin_check.events import Happening, state_on, traced_reset
from contwalk.plugin_check.findings import Report, split_place
from contwalk.plugin_check.samples import Samples, as_field
from contwalk.plugin_check.traced import Traced
from contwalk.problems.kinks import Kink, between
from contwalk.system import System

# How many pairs of states at an event are looked between, and at how many places each.
PAIRS, PLACES = 8, 24
# Two neighbouring places on a guard are on one piece of its surface if not further apart than so many parts.
NEXT = 4.0


def check_event_kinks(report: Report, happening: Happening, system: System, samples: Samples) -> None:
    """Tell of jumps of a transition's guard and reset, and of their slopes, between states at the event."""
    transition = happening.transition
    if transition.role == "watched":
        return
    reset = traced_reset(Report(), transition, system)
    for kind, function in (("guard", happening.guard), ("reset", reset)):
        if function is None or not choices_of(function.program):
            continue
        for kink in _kinks(function, happening, system, samples):
            line, _, what = kink.where.partition(" (")
            place, _ = split_place(f"{line}: ")
            report.warning(
                f"{kind} of transition '{transition.name}'", _sentence(kink, kind, what.rstrip(")")), place
            )


def _kinks(function: Traced, happening: Happening, system: System, samples: Samples) -> list[Kink]:
    """What jumps between neighbouring places at the event; second derivatives are left out."""
    switching = Switching(function.program, [("x", i) for i in range(len(system.states))], ("t", 0))
    given = samples.parameters | dict(system.mode(happening.transition.source).constants)
    constants = {("p", k): value for k, value in enumerate(samples.values)}

    def evaluate(_: np.ndarray, places: np.ndarray) -> Inputs:
        return {("x", i): x for i, x in enumerate(places.T[:-1])} | {("t", 0): places[:, -1]} | constants

    def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
        (_, a), (_, b) = before, after
        return first_switched(as_field(function), (a[-1], a[:-1].tolist()), (b[-1], b[:-1].tolist()), given)

    at_event = np.array([[*x, t] for t, x in happening.before[: PAIRS + 1]])
    if len(at_event) < 2:
        return []
    sizes = np.abs(at_event).max(axis=0)
    found: dict[Kink, None] = {}
    for ends in pairwise(at_event):
        for piece in _pieces(happening, *ends, samples):
            found |= dict.fromkeys(between(switching, evaluate, piece, sizes, where))
    return [kink for kink in found if kink.order < 2]


def _pieces(
    happening: Happening, a: np.ndarray, b: np.ndarray, samples: Samples
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Neighbouring places on the guard's surface on the way from one to another."""
    way = [a + share * (b - a) for share in np.linspace(0.0, 1.0, PLACES)]
    states = [state_on(happening.guard, place[-1], place[:-1], samples) for place in way]
    found = [None if x is None else np.append(x, place[-1]) for x, place in zip(states, way, strict=True)]
    scales = np.append(samples.scales, 1.0)
    furthest = NEXT * float(np.max(np.abs(b - a) / scales)) / PLACES
    return [
        (one, other)
        for one, other in pairwise(found)
        if one is not None and other is not None and np.max(np.abs(other - one) / scales) <= furthest
    ]


def _sentence(kink: Kink, kind: str, what: str) -> str:
    if kink.order == 0:
        return (
            f"It jumps here ({what}), at states where its event happens: a branch that gets there cannot go "
            "on, and its points pile up. Declare two transitions, one for each side, each with its own "
            f"{kind}, or make it continuous."
        )
    return (
        f"Its slopes jump here ({what}), at states where its event happens: multipliers of a branch that "
        "crosses this place jump, and special points near it may stay unlocated. Declare two transitions, "
        f"one for each side, each with its own {kind}, or make it smooth."
    )
