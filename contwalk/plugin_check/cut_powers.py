"""Powers that begin at zero, as the force of a Hertzian contact, whose derivatives have no bound there.

`max(u, 0)**1.5` and `u**1.5 if u > 0 else 0` have no second derivative where u is zero, and that is where the
event lies at which the contact begins: special points of orbits, which take second derivatives of the motion,
are not located there.
"""

from __future__ import annotations

from contwalk.fields.derivative import ancestors
from contwalk.fields.graph import Graph, Key
from contwalk.fields.trace import roots
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.traced import Traced
from contwalk.system import System

# From this exponent on second derivatives have a bound.
BOUNDED = 2.0


def check_cut_powers(report: Report, name: str, field: Traced, system: System) -> None:
    """Warn of powers below the second whose base is cut at zero, in a mode's field."""
    graph = field.program.graph
    own = ancestors(graph, roots(field.program.tree))
    asked = {
        node for key in graph.nodes if key[0] in ("lt", "le") and graph.zero in key[1:] for node in key[1:]
    }
    for key in (graph.nodes[node] for node in own):
        exponent = _exponent(graph, key)
        if exponent is None or not exponent < BOUNDED or not _cut_at_zero(graph, key[1], asked):
            continue
        what = "slope" if exponent < 1.0 else "second derivative"
        report.add(
            "warning",
            f"field of mode '{name}'",
            f"A power {exponent:g} of what is cut at zero has no bound of its {what} there: special points "
            "of orbits that touch this place, or begin a segment at it, are not located. Cut it a little "
            "above: max(..., 1e-12) instead of max(..., 0).",
            place_of(system.mode(name).field),
        )


def _exponent(graph: Graph, key: Key) -> float | None:
    """That of a power with a fixed exponent that is not whole."""
    if key[0] == "sqrt":
        return 0.5
    return graph.value(key[2]) if key[0] == "pow" else None


def _cut_at_zero(graph: Graph, base: int, asked: set[int]) -> bool:
    """Whether a node is max(u, 0), or its sign is asked for, as that of others is."""
    key = graph.nodes[base]
    if key[0] == "max":
        return graph.zero in key[1:]
    same = {base, *(key[1:] if key[0] == "neg" else ())}
    return bool(same & asked) or any(graph.nodes[node] == ("neg", base) for node in asked)
