"""Exact derivatives on an expression graph, in forward mode."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from contwalk.fields.expression import CONDITIONS, Graph
from contwalk.fields.functions import FUNCTIONS

_LEAVES = ("const", "input", *CONDITIONS)


def arguments_of(graph: Graph, node: int) -> tuple[int, ...]:
    """Nodes that a node is computed from, the condition of a `select` included."""
    key = graph.nodes[node]
    return () if key[0] in ("const", "input") else key[1:]


def ancestors(graph: Graph, outputs: Iterable[int]) -> list[int]:
    """All nodes that the outputs need, in an order of evaluation."""
    needed: set[int] = set()
    stack = list(outputs)
    while stack:
        node = stack.pop()
        if node not in needed:
            needed.add(node)
            stack.extend(arguments_of(graph, node))
    return sorted(needed)


def partials(graph: Graph, node: int) -> list[tuple[int, int]]:
    """Pairs (argument, partial derivative of the node by it)."""
    key = graph.nodes[node]
    name, a = key[0], key[1:]
    if name in _LEAVES:
        return []
    if name == "add":
        return [(a[0], graph.one), (a[1], graph.one)]
    if name == "sub":
        return [(a[0], graph.one), (a[1], graph.constant(-1.0))]
    if name == "neg":
        return [(a[0], graph.constant(-1.0))]
    if name == "mul":
        return [(a[0], a[1]), (a[1], a[0])]
    if name == "div":
        reciprocal = graph.div(graph.one, a[1])
        return [(a[0], reciprocal), (a[1], graph.neg(graph.mul(node, reciprocal)))]
    found = FUNCTIONS[name].partials(graph, node, a)
    return [(argument, partial) for argument, partial in zip(a, found, strict=True) if partial is not None]


def jacobian(graph: Graph, outputs: Sequence[int], inputs: Sequence[int]) -> list[dict[int, int]]:
    """For each output, its nonzero derivatives: position in `inputs` -> node."""
    derivatives: dict[int, dict[int, int]] = {node: {k: graph.one} for k, node in enumerate(inputs)}
    for node in ancestors(graph, outputs):
        if node in derivatives:
            continue
        if graph.nodes[node][0] == "select":
            derivatives[node] = _selected(graph, node, derivatives)
            continue
        row: dict[int, int] = {}
        for argument, partial in partials(graph, node):
            for k, inner in derivatives.get(argument, {}).items():
                term = graph.mul(partial, inner)
                row[k] = graph.add(row[k], term) if k in row else term
        derivatives[node] = row
    return [
        {k: d for k, d in derivatives.get(output, {}).items() if graph.value(d) != 0.0} for output in outputs
    ]


def _selected(graph: Graph, node: int, derivatives: Mapping[int, Mapping[int, int]]) -> dict[int, int]:
    """Derivatives of a choice: chosen as well, since what is not taken need not exist there."""
    condition, first, second = graph.nodes[node][1:]
    one, other = derivatives.get(first, {}), derivatives.get(second, {})
    return {
        k: graph.select(condition, one.get(k, graph.zero), other.get(k, graph.zero)) for k in {**one, **other}
    }


def directional(graph: Graph, outputs: Sequence[int], directions: Mapping[int, int]) -> list[int]:
    """Derivatives of the outputs when each input moves along its direction (input node -> direction node)."""
    derivatives: dict[int, int] = dict(directions)
    for node in ancestors(graph, outputs):
        if node in derivatives:
            continue
        if graph.nodes[node][0] == "select":
            condition, first, second = graph.nodes[node][1:]
            sides = (derivatives.get(side, graph.zero) for side in (first, second))
            derivatives[node] = graph.select(condition, *sides)
            continue
        total = graph.zero
        for argument, partial in partials(graph, node):
            total = graph.add(total, graph.mul(partial, derivatives.get(argument, graph.zero)))
        derivatives[node] = total
    return [derivatives.get(output, graph.zero) for output in outputs]
