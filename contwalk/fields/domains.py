"""Products with a zero: kept where the other factor has a domain, outside of which it is not a number.

Zero times what is not a number is not a number (IEEE 754). Of a plugin's own products such a zero is kept,
so that a field has no values where Python's arithmetic gives none; the zeros of chain rules are of structure,
and drop what they multiply. Poles, as of a quotient, are single places, which no computation meets, and do
not count; nor does what overflows.
"""

from __future__ import annotations

import math

from contwalk.fields.graph import Graph

# Functions that are not numbers on whole intervals of their arguments.
WITH_DOMAIN = frozenset(("log", "log1p", "log2", "log10", "sqrt", "asin", "acos", "acosh", "atanh", "pow"))


def product(graph: Graph, a: int, b: int) -> int:
    """The node of a * b; a zero stays beside a factor with a domain."""
    if graph.value(a) == 0.0 and has_domain(graph, b):
        return graph.kept("mul", a, b)
    if graph.value(b) == 0.0 and has_domain(graph, a):
        return graph.kept("mul", b, a)
    return graph.mul(a, b)


def has_domain(graph: Graph, node: int) -> bool:
    """Whether a node may be no number in a region of its inputs, or is none, or infinite, as a constant."""
    seen, stack = {node}, [node]
    while stack:
        name, *arguments = graph.nodes[stack.pop()]
        if name in WITH_DOMAIN or (name == "const" and not math.isfinite(arguments[0])):
            return True
        if name in ("const", "input"):
            continue
        stack += [each for each in arguments if each not in seen]
        seen.update(arguments)
    return False
