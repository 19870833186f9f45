"""Transitions that happen at one instant all along a branch, as by a symmetry.

Where they commute, each order of them leads to the same mode and state, and the orbit is that of either
order: its equations are those of the itinerary that was simulated, in which the later ones follow in no time.
The guard of each is an equation still, so that multipliers tell what becomes of motions on which they come
apart. Where they do not commute nobody but the plugin can say which comes first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.limits import ROUNDED
from contwalk.diagram import not_begun
from contwalk.flow.events.jump_instants import room
from contwalk.flow.hybrid.machine import HybridMachine, hybrid_machine
from contwalk.numerics.linear import EPSILON
from contwalk.plugin_check.orders import conflict, orders_told, remedy, results
from contwalk.problems.hybrid.adjacent.orbit import assembled, starts_and_durations
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.sample import Sample

# Along a branch on which events stay together a duration keeps zero, to the root of rounding.
KEPT = float(np.sqrt(EPSILON))


def joined(problem: HybridOrbit, sample: Sample) -> tuple[HybridOrbit, np.ndarray] | Outcome | None:
    """The orbit with those of its events as one instant's that keep together along its branch.

    Returns
    -------
    tuple (HybridOrbit, ndarray) or Outcome or None
        The orbit, beginning after the first of its events at one instant, and its unknowns, shape (N + 1,);
        why there is none; None where no events are together.
    """
    itinerary, z = problem.itinerary, sample.z
    if not itinerary.eventful:
        return None
    there, total = discretized(problem, z), problem.duration(z)
    states, lasting, start = starts_and_durations(there, z)
    turning = np.abs(sample.tangent[problem.layout.durations])
    short = [
        i
        for i, leg in enumerate(itinerary.legs)
        if not leg.momentary and abs(lasting[i]) <= ROUNDED * total and turning[i] <= KEPT * total
        if itinerary.leading_in(problem.system, i) != leg.name
    ]
    firsts = [i for i in range(len(itinerary)) if i not in short and (i + 1) % len(itinerary) in short]
    if not firsts:
        return None
    machine, times = hybrid_machine(problem.system, problem.values_of(z)), problem.starting_times(z)
    scale = np.where(problem.mesh.variation > 0.0, problem.mesh.variation, 1.0)
    legs = [replace(leg, together=leg.together or i in short) for i, leg in enumerate(itinerary.legs)]
    for i in firsts:
        t, view = float(times[i] + lasting[i]), problem.pieces_of(z, i)[-1]
        given = machine, t, view.full(view.end), view.piece.passage.leg.mode, scale, ROUNDED * total
        found = results(*given, declared=True)
        if not found or not found[0].order:
            return None
        if apart := conflict(found, scale):
            sentence = orders_told(problem.system, t, *apart, scale)
            return not_begun.refused(
                sentence, f"{remedy(*apart)} Or begin where they come one after the other."
            )
        first = found[0]
        if first.stays_together(scale) or len(results(*given, declared=False)) == 1:
            continue
        for k in range(i + 1, i + len(first.order)):
            legs[k % len(legs)] = replace(legs[k % len(legs)], ordered=True)
    other, unknowns = assembled(there, replace(itinerary, legs=tuple(legs)), states, lasting, start, z)
    assert isinstance(other, HybridOrbit)
    return rotated(other, unknowns, (firsts[0] + 1) % len(itinerary))


def differing(machine: HybridMachine, t: float, x: np.ndarray, mode: str, scale: np.ndarray) -> str:
    """What is to be said where transitions have an instant of a motion and no declared order, and the order
    matters; empty otherwise.

    x is the state of shape (n,) before the first of them, `scale` the magnitudes of the states.
    """
    found = conflict(results(machine, t, x, mode, scale, room(t), declared=True), scale)
    if found is None:
        return ""
    sentence = orders_told(machine.system, t, *found, scale)
    return f"{sentence} The one declared first has acted first. {remedy(*found)}"


def sentence_on(problem: HybridOrbit) -> str:
    """What is to be said of a branch on which the order of events at one instant matters; empty of others."""
    names = [leg.name for leg in problem.itinerary.legs if leg.ordered]
    if not names:
        return ""
    return (
        f"Its stability is not told: '{names[0]}' has the instant of the event before it, and how motions "
        "beside this one go on changes with which of both comes first."
    )
