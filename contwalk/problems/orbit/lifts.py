"""Lifts: what integrates derivatives beside the state, and maps them.

A *lift* of a field is a field again, made of the same graph:

| lift | states | what is integrated |
|---|---|---|
| `PLAIN` | x | the motion |
| `TANGENT` | x, v | and its derivative in one direction (v, w) of state and parameters |
| `MIXED` | x, v, y, z | and the derivative of x and v in a second direction (y, e) |
| `JET` | x, x1, x2, x3 | and the first three derivatives of the motion by the parameter of a curve of
motions |

Steps of an integrator commute with differentiation: on the same steps a lift gives the exact derivatives of
what the integrator makes of the motion.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from contwalk.fields.derivative import directional
from contwalk.fields.trace import Program

PLAIN, TANGENT, MIXED, JET = "plain", "tangent", "mixed", "jet"
# Groups of state inputs of each lift, and groups of directions in the columns.
STATES = {PLAIN: "u", TANGENT: "uv", MIXED: "uvyz", JET: ("u", "u1", "u2", "u3")}
DIRECTIONS = {PLAIN: (), TANGENT: ("w",), MIXED: ("w", "e"), JET: ("c1", "c2", "c3")}


def lifted(program: Program, states: int, columns: Sequence[tuple[str, int]], lift: str) -> Program:
    """The program that computes a lift's outputs from those of `program`: a field, a map or a guard."""
    graph = program.graph

    def moved(pairs: Mapping[str, str], along: Sequence[tuple[str, str]]) -> dict[int, int]:
        """Direction of every input: state groups by `pairs`, columns by the groups in `along`."""
        result = {graph.input(a, i): graph.input(b, i) for a, b in pairs.items() for i in range(states)}
        for source, target in along:
            for k, (group, index) in enumerate(columns):
                node = graph.input(group, index) if source == "" else graph.input(source, k)
                result[node] = graph.input(target, k)
        return result

    def change(outputs: tuple[int, ...]) -> list[int]:
        first = list(outputs)
        if lift == PLAIN:
            return first
        if lift == TANGENT:
            return first + directional(graph, first, moved({"u": "v"}, [("", "w")]))
        if lift == MIXED:
            pair = first + directional(graph, first, moved({"u": "v"}, [("", "w")]))
            return pair + directional(graph, pair, moved({"u": "y", "v": "z"}, [("", "e")]))
        one = directional(graph, first, moved({"u": "u1"}, [("", "c1")]))
        two = directional(graph, one, moved({"u": "u1", "u1": "u2"}, [("", "c1"), ("c1", "c2")]))
        chain = moved({"u": "u1", "u1": "u2", "u2": "u3"}, [("", "c1"), ("c1", "c2"), ("c2", "c3")])
        return first + one + two + directional(graph, two, chain)

    return program.transformed(change)
