"""Whether nodes are the same when an input goes on by a period, whatever the inputs are.

What is so by its form need not be tried at states, where rounding would have to be told from a difference.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from contwalk.fields.derivative import ancestors
from contwalk.fields.graph import Graph

# Periods of functions, and how near to a multiple of one a shift is it, as a part of itself.
PERIODS = {"sin": 2.0 * math.pi, "cos": 2.0 * math.pi, "tan": math.pi}
NEAR = 1e-13


def repeats(graph: Graph, outputs: Iterable[int], which: int, period: float) -> bool:
    """Whether outputs are the same after input node `which` has grown by `period`, as operations tell.

    False where they do not tell.
    """
    outputs = list(outputs)
    shifts: dict[int, float] = {}
    for node in ancestors(graph, outputs):
        shifts[node] = period if node == which else _shift(graph, node, shifts)
    return all(shifts[node] == 0.0 for node in outputs)


def _shift(graph: Graph, node: int, shifts: Mapping[int, float]) -> float:
    """By how much a node grows, if always by the same; else NaN."""
    key = graph.nodes[node]
    name, arguments = key[0], key[1:]
    if name in ("const", "input"):
        return 0.0
    given = [shifts[argument] for argument in arguments]
    if not any(given):
        return 0.0
    if name == "add":
        return given[0] + given[1]
    if name == "sub":
        return given[0] - given[1]
    if name == "neg":
        return -given[0]
    if name in ("mul", "div"):
        return _scaled(graph, name, arguments, given)
    if name in PERIODS:
        turns = given[0] / PERIODS[name]
        return 0.0 if abs(turns - _whole(turns)) <= NEAR * abs(turns) else math.nan
    return math.nan


def _scaled(graph: Graph, name: str, arguments: tuple[int, ...], given: list[float]) -> float:
    """The shift of a multiple of what shifts."""
    first, second = (graph.value(argument) for argument in arguments)
    if name == "div":
        return math.nan if second is None or second == 0.0 else given[0] / second
    if first is not None:
        return first * given[1]
    return math.nan if second is None else given[0] * second


def _whole(number: float) -> float:
    return math.nan if not math.isfinite(number) else float(round(number))
