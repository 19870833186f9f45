"""Filippov's sliding field between two modes, derived from what a plugin says of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from contwalk.errors import SystemDefinitionError
from contwalk.fields.derivative import jacobian
from contwalk.fields.graph import Graph
from contwalk.fields.like_terms import difference
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow.compiled.traced import STATE, TIME, arguments, rates
from contwalk.system import System, Transition


@dataclass(frozen=True)
class SwitchingSurface:
    """Where a guard is zero between two modes, and what leads over it.

    Attributes
    ----------
    above, below : str
        The modes on the side where the guard is positive, and where it is negative.
    crossings : tuple of Transition
        From one of them to the other, with this guard.
    """

    above: str
    below: str
    crossings: tuple[Transition, ...]

    @property
    def guard(self) -> Callable[..., Any]:
        """The guard, with the sign that `above` and `below` speak of."""
        return self.crossings[0].guard

    @property
    def name(self) -> str:
        """The surface in words."""
        names = " and ".join(f"'{name}'" for name in dict.fromkeys(t.name for t in self.crossings))
        return f"{names} between modes '{self.above}' and '{self.below}'"


@dataclass(frozen=True)
class SlidingMode:
    """Filippov's mean of two fields that keeps a guard at zero, and when it ceases to be one.

    Attributes
    ----------
    surface : SwitchingSurface
    field : Program
        Rates of the states that exist in both modes, in their order.
    above, below : Program
        The guard's rate with the field of either mode. It slides where the first is negative and the second
        positive.
    guard : Program
        The guard itself.
    """

    surface: SwitchingSurface
    field: Program
    above: Program
    below: Program
    guard: Program


def sliding_mode(system: System, surface: SwitchingSurface) -> SlidingMode:
    """The sliding mode on a surface.

    With f1, L1 the field and the guard's rate above the surface, and f2, L2 below it, the field is
    (L2 f1 - L1 f2) / (L2 - L1) (A. F. Filippov, Differential Equations with Discontinuous Righthand Sides,
    1988). A state of which alone the guard is made is held exactly.

    Raises
    ------
    SystemDefinitionError
        Where the modes have other states.
    """
    states = system.states_of(surface.above)
    if states != system.states_of(surface.below):
        raise SystemDefinitionError(
            f"The modes '{surface.above}' and '{surface.below}' have other states than each other.",
            "A mean of their fields needs both to move the same states; write the sliding mode by hand.",
        )
    program = _both(system, surface)
    n = len(states)
    return SlidingMode(
        surface,
        field=program.transformed(lambda nodes: _field(program.graph, nodes, states)),
        above=program.transformed(lambda nodes: [_rates(program.graph, nodes, states)[0]]),
        below=program.transformed(lambda nodes: [_rates(program.graph, nodes, states)[1]]),
        guard=program.transformed(lambda nodes: [nodes[2 * n]]),
    )


def _both(system: System, surface: SwitchingSurface) -> Program:
    """Both fields, then the guard, as one program."""
    fields = [(rebound(system.mode(mode).field), mode) for mode in (surface.above, surface.below)]
    guard = rebound(surface.guard)

    def whole(tracer: Tracer) -> list[Any]:
        entries = [rate for field, mode in fields for rate in rates(tracer, system, field, mode)]
        return [*entries, guard(*arguments(tracer, system, surface.crossings[0].source))]

    return trace(whole)


def _slopes(graph: Graph, guard: int, states: Sequence[int]) -> tuple[list[int], int]:
    """Derivatives of the guard by the states of the mode and by the time."""
    inputs = [*(graph.input(STATE, i) for i in states), graph.input(TIME, 0)]
    row = jacobian(graph, [guard], inputs)[0]
    return [row.get(k, graph.zero) for k in range(len(states))], row.get(len(states), graph.zero)


def _rates(graph: Graph, nodes: Sequence[int], states: Sequence[int]) -> tuple[int, int]:
    """The guard's rates with both fields."""
    n = len(states)
    slopes, by_time = _slopes(graph, nodes[2 * n], states)

    def along(field: Sequence[int]) -> int:
        total = graph.zero
        for slope, rate in zip(slopes, field, strict=True):
            total = graph.add(total, graph.mul(slope, rate))
        return graph.add(total, by_time)

    return along(nodes[:n]), along(nodes[n : 2 * n])


def _field(graph: Graph, nodes: Sequence[int], states: Sequence[int]) -> list[int]:
    """f2 + (f1 - f2) L2 / (L2 - L1), in which terms that both fields have cancel."""
    n = len(states)
    slopes, by_time = _slopes(graph, nodes[2 * n], states)
    above, below = _rates(graph, nodes, states)
    share = graph.div(below, difference(graph, below, above))
    field = [
        graph.add(second, graph.mul(difference(graph, first, second), share))
        for first, second in zip(nodes[:n], nodes[n : 2 * n], strict=True)
    ]
    seen = [k for k, slope in enumerate(slopes) if graph.value(slope) != 0.0]
    if len(seen) == 1:
        drift = graph.div(by_time, slopes[seen[0]])
        field[seen[0]] = drift if drift == graph.zero else graph.neg(drift)
    return field
