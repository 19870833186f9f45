"""Exact derivatives on an expression graph, in forward mode."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from contwalk.fields.functions import FUNCTIONS
from contwalk.fields.graph import CONDITIONS, FACTORS, Graph
from contwalk.fields.linear_rates import determinant_slopes, solution_rate

_LEAVES = ("const", "input", "piece", "entry", *CONDITIONS, *FACTORS)


def arguments_of(graph: Graph, node: int) -> tuple[int, ...]:
    """Nodes that a node is computed from, the condition of a `select` included."""
    key = graph.nodes[node]
    return () if key[0] in ("const", "input") else key[1:]


def ancestors(graph: Graph, outputs: Iterable[int]) -> list[int]:
    """All nodes that the outputs need, in an order of evaluation."""
    needed: set[int] = set()
    nodes, stack = graph.nodes, list(outputs)
    while stack:
        node = stack.pop()
        if node not in needed:
            needed.add(node)
            key = nodes[node]
            if key[0] not in ("const", "input"):
                stack += key[1:]
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
    if name == "determinant":
        return determinant_slopes(graph, node)
    found = FUNCTIONS[name].partials(graph, node, a)
    return [(argument, partial) for argument, partial in zip(a, found, strict=True) if partial is not None]


def jacobian(graph: Graph, outputs: Sequence[int], inputs: Sequence[int]) -> list[dict[int, int]]:
    """For each output, its nonzero derivatives: position in `inputs` -> node."""
    rows = _propagated(graph, outputs, {node: {k: graph.one} for k, node in enumerate(inputs)})
    return [{k: d for k, d in rows.get(output, {}).items() if graph.value(d) != 0.0} for output in outputs]


def directional(graph: Graph, outputs: Sequence[int], directions: Mapping[int, int]) -> list[int]:
    """Derivatives of the outputs when each input moves along its direction (input node -> direction node)."""
    rows = _propagated(graph, outputs, {node: {0: direction} for node, direction in directions.items()})
    return [rows.get(output, {}).get(0, graph.zero) for output in outputs]


# For each node its derivatives along numbered directions; what is zero may be left out.
_Rows = Mapping[int, Mapping[int, int]]


def _propagated(graph: Graph, outputs: Sequence[int], rows: dict[int, dict[int, int]]) -> _Rows:
    """Derivatives of all that the outputs need, from those of some nodes."""
    for node in ancestors(graph, outputs):
        if node not in rows:
            rows[node] = _RULES.get(graph.nodes[node][0], _chained)(graph, node, rows)
    return rows


def _chained(graph: Graph, node: int, rows: _Rows) -> dict[int, int]:
    """The chain rule."""
    row: dict[int, int] = {}
    for argument, partial in partials(graph, node):
        found = rows.get(argument)
        if not found:
            continue
        as_it_is = partial == graph.one
        for k, inner in found.items():
            term = inner if as_it_is else graph.mul(partial, inner)
            row[k] = graph.add(row[k], term) if k in row else term
    return row


def _selected(graph: Graph, node: int, rows: _Rows) -> dict[int, int]:
    """Derivatives of a choice: chosen as well, since what is not taken need not exist there."""
    condition, first, second = graph.nodes[node][1:]
    one, other = rows.get(first, {}), rows.get(second, {})
    return {
        k: graph.select(condition, one.get(k, graph.zero), other.get(k, graph.zero)) for k in {**one, **other}
    }


def _of_solution(graph: Graph, node: int, rows: _Rows) -> dict[int, int]:
    """Derivatives of a solution: other ones, of the same matrix."""
    factor, *right = graph.nodes[node][1:]
    along = {k: None for number in (*graph.nodes[factor][1:], *right) for k in rows.get(number, {})}

    def rate_along(k: int) -> int | None:
        return solution_rate(graph, node, lambda number: rows.get(number, {}).get(k, graph.zero))

    return {k: rate for k in along if (rate := rate_along(k)) is not None}


def _of_item(graph: Graph, node: int, rows: _Rows) -> dict[int, int]:
    solution, place = graph.nodes[node][1:]
    i = int(graph.nodes[place][1])
    return {k: graph.item(rate, i) for k, rate in rows.get(solution, {}).items()}


_RULES: dict[str, Callable[[Graph, int, _Rows], dict[int, int]]] = {
    "select": _selected,
    "solved": _of_solution,
    "item": _of_item,
}
