"""What a program computes from its parameters alone, and so only once for a set of them."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from contwalk.fields.derivative import arguments_of
from contwalk.fields.expression import CONDITIONS, Graph


def hoisted(graph: Graph, nodes: Iterable[int], parameters: Collection[int]) -> list[int]:
    """Nodes that depend on nothing but the inputs `parameters`, and that `nodes` are computed from directly.

    Conditions are not among them, as they are no numbers; they are computed where they are needed.
    """
    varying = [False] * len(graph.nodes)
    for node, key in enumerate(graph.nodes):  # arguments come before results
        if key[0] == "input":
            varying[node] = node not in parameters
        else:
            varying[node] = any(varying[argument] for argument in arguments_of(graph, node))
    found: set[int] = set()
    seen: set[int] = set()
    stack = list(nodes)
    while stack:
        node = stack.pop()
        if node in seen or graph.value(node) is not None:
            continue
        seen.add(node)
        if varying[node] or graph.nodes[node][0] in CONDITIONS:
            stack.extend(arguments_of(graph, node))
        else:
            found.add(node)
    return sorted(found)
