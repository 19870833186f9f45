"""What a program computes from its parameters alone, and so only once for a set of them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

from contwalk.fields.derivative import arguments_of
from contwalk.fields.elimination_code import factor_width
from contwalk.fields.graph import CONDITIONS, FACTORS, Graph


def places_of(graph: Graph, nodes: Iterable[int]) -> dict[int, int]:
    """Where each node begins in an array of them all."""
    places, end = {}, 0
    for node in nodes:
        places[node] = end
        end += width_of(graph, node)
    return places


def width_of(graph: Graph, node: int) -> int:
    """How many numbers a node is."""
    key = graph.nodes[node]
    if key[0] in FACTORS:
        return factor_width(math.isqrt(len(key) - 1))
    return len(key) - 2 if key[0] == "solved" else 1


def hoisted(graph: Graph, nodes: Iterable[int], parameters: Collection[int]) -> list[int]:
    """Nodes that depend on nothing but the inputs `parameters`, and that `nodes` are computed from directly.

    Conditions are not among them, as they are no numbers; they are computed where they are needed. Eliminated
    matrices are; `width_of` tells how many numbers they take.
    """
    varying = [False] * len(graph.nodes)
    for node, key in enumerate(graph.nodes):  # arguments come before results
        if key[0] == "input":
            varying[node] = node not in parameters
        elif key[0] != "const":
            for argument in key[1:]:
                if varying[argument]:
                    varying[node] = True
                    break
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
