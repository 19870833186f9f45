"""In which interval the value of a node lies, whatever its inputs are: as far as its operations tell."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import product

from contwalk.fields.derivative import ancestors
from contwalk.fields.graph import Graph

Interval = tuple[float, float]
ANY: Interval = (-math.inf, math.inf)

# What functions give for any argument for which they are defined.
_IMAGES: dict[str, Interval] = {
    "sin": (-1.0, 1.0),
    "cos": (-1.0, 1.0),
    "tanh": (-1.0, 1.0),
    "erf": (-1.0, 1.0),
    "sign": (-1.0, 1.0),
    "erfc": (0.0, 2.0),
    "exp": (0.0, math.inf),
    "expm1": (-1.0, math.inf),
    "cosh": (1.0, math.inf),
    "sqrt": (0.0, math.inf),
    "hypot": (0.0, math.inf),
    "acosh": (0.0, math.inf),
    "acos": (0.0, math.pi),
}


def ranges(
    graph: Graph, outputs: tuple[int, ...], inputs: Mapping[tuple[str, int], Interval]
) -> list[Interval]:
    """An interval for each output that holds its values wherever it is finite; not the smallest one.

    Parameters
    ----------
    graph : Graph
    outputs : tuple of int
    inputs : mapping
        Intervals of inputs, `("p", 0)`; of others nothing is known.
    """
    found: dict[int, Interval] = {}
    for node in ancestors(graph, outputs):
        low, high = _range(graph, node, found, inputs)
        found[node] = (low, high) if low <= high else ANY  # infinities may cancel
    return [found[node] for node in outputs]


def _range(
    graph: Graph, node: int, found: Mapping[int, Interval], inputs: Mapping[tuple[str, int], Interval]
) -> Interval:
    key = graph.nodes[node]
    name, a = key[0], key[1:]
    if name == "const":
        return (a[0], a[0]) if a[0] == a[0] else ANY
    if name == "input":
        return inputs.get((a[0], a[1]), ANY)
    if name in ("pow", "mul") and _is_even_power(graph, name, a):
        return 0.0, math.inf  # no more than the sign is told
    if name == "select":
        return _union(found[a[1]], found[a[2]])
    rule = _RULES.get(name)
    return _IMAGES.get(name, ANY) if rule is None else rule(*(found[k] for k in a))


def _is_even_power(graph: Graph, name: str, a: tuple[int, ...]) -> bool:
    if name == "mul":
        return a[0] == a[1]
    exponent = graph.value(a[1])
    return exponent is not None and exponent > 0.0 and exponent % 2.0 == 0.0


def _union(a: Interval, b: Interval) -> Interval:
    return min(a[0], b[0]), max(a[1], b[1])


def _sum(a: Interval, b: Interval) -> Interval:
    return a[0] + b[0], a[1] + b[1]


def _negative(a: Interval) -> Interval:
    return -a[1], -a[0]


def _product(a: Interval, b: Interval) -> Interval:
    ends = [x * y if x and y else 0.0 for x, y in product(a, b)]  # 0 times infinity is no number, or 0
    return min(ends), max(ends)


def _quotient(a: Interval, b: Interval) -> Interval:
    if b[0] < 0.0 < b[1]:
        return ANY
    sign = (0.0, math.inf) if b[0] >= 0.0 else (-math.inf, 0.0)
    return _product(a, sign)


def _absolute(a: Interval) -> Interval:
    return max(0.0, a[0], -a[1]), max(-a[0], a[1])


_RULES: dict[str, Callable[..., Interval]] = {
    "add": _sum,
    "sub": lambda a, b: _sum(a, _negative(b)),
    "neg": _negative,
    "mul": _product,
    "div": _quotient,
    "abs": _absolute,
    "min": lambda a, b: (min(a[0], b[0]), min(a[1], b[1])),
    "max": lambda a, b: (max(a[0], b[0]), max(a[1], b[1])),
}
