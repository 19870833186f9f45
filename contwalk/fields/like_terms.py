"""Differences of sums in which equal terms cancel before anything is computed."""

from __future__ import annotations

import math
from fractions import Fraction

from contwalk.fields.graph import Graph


def difference(graph: Graph, a: int, b: int) -> int:
    """The node of a - b, without the terms that stand in both.

    Interned nodes name equal operations equally, so that terms are compared by their numbers; sums, signs and
    constant factors are looked through, products of sums are not multiplied out.
    """
    terms: dict[int, Fraction] = {}
    _collect(graph, a, Fraction(1), terms)
    _collect(graph, b, Fraction(-1), terms)
    kept = {node: factor for node, factor in terms.items() if factor != 0}
    if any(Fraction(float(factor)) != factor for factor in kept.values()):
        return graph.sub(a, b)  # a factor that no float holds would be rounded here
    result = graph.zero
    for node, factor in kept.items():
        result = graph.add(result, graph.mul(graph.constant(float(factor)), node))
    return result


def _collect(graph: Graph, node: int, factor: Fraction, terms: dict[int, Fraction]) -> None:
    """Add the terms of a node, times a factor, to those that are there; a number is a multiple of one."""
    stack = [(node, factor)]
    while stack:
        node, factor = stack.pop()
        name, *arguments = graph.nodes[node]
        number, other = _number(graph, node)
        if name in ("add", "sub"):
            stack += [(arguments[1], factor if name == "add" else -factor), (arguments[0], factor)]
        elif name == "neg":
            stack.append((arguments[0], -factor))
        elif number is None:
            terms[node] = terms.get(node, Fraction(0)) + factor
        elif other == graph.one:
            terms[other] = terms.get(other, Fraction(0)) + factor * number
        else:
            stack.append((other, factor * number))


def _number(graph: Graph, node: int) -> tuple[Fraction | None, int]:
    """The finite number that a node is a multiple of, and what it is a multiple of."""
    value = graph.value(node)
    if value is not None:
        return (Fraction(value), graph.one) if math.isfinite(value) else (None, node)
    if graph.nodes[node][0] == "mul":
        a, b = graph.nodes[node][1:]
        for constant, other in ((a, b), (b, a)):
            value = graph.value(constant)
            if value is not None and math.isfinite(value):
                return Fraction(value), other
    return None, node
