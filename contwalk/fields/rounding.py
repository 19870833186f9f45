"""Running error analysis: how far rounding can carry each output from its exact value.

Every operation is rounded once, so its result is off by at most half an ulp of itself plus what its arguments
bring along. Summed to first order over the graph, in units of the machine epsilon
(N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 3.3).
"""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.fields.derivative import ancestors, partials
from contwalk.fields.graph import BUNDLES, CONDITIONS, Graph
from contwalk.fields.linear_rates import determinant_bound, solution_bounds


def error_bounds(graph: Graph, outputs: Sequence[int]) -> list[int]:
    """Nodes of the error bounds of the outputs, in units of the machine epsilon."""
    bounds: dict[int, int] = {}
    solutions: dict[int, list[int]] = {}
    for node in ancestors(graph, outputs):
        name = graph.nodes[node][0]
        if name in ("const", "input", "piece", "entry", *CONDITIONS):
            bounds[node] = graph.zero
            continue
        if name == "select":
            condition, first, second = graph.nodes[node][1:]
            bounds[node] = graph.select(condition, bounds[first], bounds[second])
            continue
        if name in BUNDLES:
            bounds[node] = graph.zero  # of its items, and of a determinant, that of the equations
            continue
        if name == "item":
            solution, place = graph.nodes[node][1:]
            if solution not in solutions:
                solutions[solution] = solution_bounds(graph, solution, bounds.__getitem__)
            bounds[node] = solutions[solution][int(graph.nodes[place][1])]
            continue
        if name == "determinant":
            bounds[node] = determinant_bound(graph, node, bounds.__getitem__)
            continue
        total = graph.zero if name in ("neg", "abs") else size_of(graph, node)
        for argument, partial in partials(graph, node):
            inherited = bounds[argument]
            if graph.value(inherited) == 0.0:
                continue
            total = graph.add(total, graph.mul(size_of(graph, partial), inherited))
        bounds[node] = total
    return [bounds[output] for output in outputs]


def size_of(graph: Graph, node: int) -> int:
    """|node|, to the same bits as `abs` of it, by fewer operations where signs do not matter."""
    key = graph.nodes[node]
    if key[0] == "abs" or (key[0] == "mul" and key[1] == key[2]):
        return node
    if key[0] == "neg":
        return size_of(graph, key[1])
    if key[0] in ("mul", "div") and all(_has_size(graph, argument) for argument in key[1:]):
        return getattr(graph, key[0])(*(size_of(graph, argument) for argument in key[1:]))
    return graph.call("abs", node)


def _has_size(graph: Graph, node: int) -> bool:
    """Whether |node| costs nothing that has not been written down already."""
    name = graph.nodes[node][0]
    return name in ("const", "abs") or graph.has("abs", node)
