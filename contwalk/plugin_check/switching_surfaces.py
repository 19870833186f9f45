"""The switching surfaces of a machine: guards over which one mode hands the state on to another as it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Raises, Tracer, trace
from contwalk.flow.compiled.traced import arguments
from contwalk.flow.hybrid.sliding import SlidingMode, SwitchingSurface
from contwalk.plugin_check.functions import EPSILON
from contwalk.plugin_check.kernels import Kernels
from contwalk.plugin_check.samples import Samples, samples_of
from contwalk.plugin_check.states_at_event import FACTOR, state_on
from contwalk.plugin_check.traced import Traced, number_form, vector_form
from contwalk.system import System, Transition


def switching_surfaces(system: System) -> list[SwitchingSurface]:
    """All surfaces over which hard transitions lead from one mode to another and keep the state."""
    samples = _samples(system)
    found: list[SwitchingSurface] = []
    for transition in system.transitions:
        if not _switches(transition) or not _keeps(system, transition, samples):
            continue
        sides = _sides(transition)
        known = next((k for k, surface in enumerate(found) if _is_of(system, surface, transition)), None)
        if known is None:
            found.append(SwitchingSurface(*sides, (transition,)))
        else:
            found[known] = SwitchingSurface(*sides, (*found[known].crossings, transition))
    return found


def refuse_one_rate(system: System, mode: SlidingMode) -> None:
    """Refuse a surface that both fields leave or meet at one rate: nothing slides there.

    Raises
    ------
    SystemDefinitionError
    """
    samples, surface = _samples(system), mode.surface
    guard = Traced(surface.guard, system, number_form("guard(t, x, p)"), mode=surface.crossings[0].source)
    rates = [Kernels(program, 1, len(samples.scales)) for program in (mode.above, mode.below)]
    for t, x in _states_on(guard, samples):
        above, below = (float(rate.values(t, x, samples.values, ())[0]) for rate in rates)
        if abs(below - above) > FACTOR * EPSILON * (abs(above) + abs(below)):
            return
    raise SystemDefinitionError(
        f"The guard of {surface.name} changes at one rate in both modes, so that nothing slides along it.",
        "A surface slides where both fields lead towards it. Where what switches acts on a derivative of the "
        "guard only, the switches follow each other ever faster instead, and no sliding mode replaces them.",
    )


def _samples(system: System) -> Samples:
    return samples_of(system, None)


def _switches(transition: Transition) -> bool:
    return (
        transition.role == "hard"
        and transition.direction != "both"
        and transition.source != transition.target
        and transition.relabel is None
    )


def _sides(transition: Transition) -> tuple[str, str]:
    """The modes above and below the surface."""
    ends = (transition.source, transition.target)
    return ends if transition.direction == "falling" else (ends[1], ends[0])


def _is_of(system: System, surface: SwitchingSurface, transition: Transition) -> bool:
    """Whether a transition leads over this surface: the same sides, and one guard."""
    first = surface.crossings[0]
    if (surface.above, surface.below) != _sides(transition):
        return False
    if first.guard is transition.guard:
        return True

    def values(tracer: Tracer) -> list[Any]:
        return [rebound(each.guard)(*arguments(tracer, system, each.source)) for each in (first, transition)]

    leaves = trace(values).leaves()
    return all(not isinstance(leaf, Raises) and leaf.nodes[0] == leaf.nodes[1] for leaf in leaves)


def _keeps(system: System, transition: Transition, samples: Samples) -> bool:
    """Whether the state is kept on the surface; that what is zero there is written as zero does not count."""
    if transition.reset is None:
        return True
    states = list(system.states_of(transition.source))
    if states != list(system.states_of(transition.target)):
        return False
    mode = transition.source
    reset = Traced(transition.reset, system, vector_form(system, "reset", "x_plus", states), mode=mode)
    guard = Traced(transition.guard, system, number_form("guard(t, x, p)"), mode=mode)
    tried = _states_on(guard, samples)
    return bool(tried) and all(
        np.allclose(reset.values(t, x, samples.values)[states], x[states], rtol=0.0, atol=_rounding(x))
        for t, x in tried
    )


def _rounding(x: np.ndarray) -> float:
    return FACTOR * EPSILON * float(np.abs(x).max())


def _states_on(guard: Traced, samples: Samples) -> list[tuple[float, np.ndarray]]:
    """Times and states where a guard is zero."""
    reached = (
        (float(t), state_on(guard, float(t), guard.given(x), samples))
        for t, x in zip(samples.times, samples.states, strict=True)
    )
    return [(t, x) for t, x in reached if x is not None]
