"""Writing a program as straight-line Python."""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.fields.derivative import arguments_of
from contwalk.fields.expression import Graph
from contwalk.fields.trace import Fork, Outputs, Program, Raises, Tree

_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/", "lt": "<", "le": "<=", "eq": "=="}
_INFIX |= {"and": "and", "or": "or"}


def source(program: Program, groups: Sequence[str]) -> str:
    """Text of a function `evaluate(group, ...)` that returns the outputs as a list.

    Parameters
    ----------
    program : Program
    groups : sequence of str
        Names of the input arrays, in the order of the arguments.
    """
    lines = [f"def evaluate({', '.join(groups)}):"]
    _emit(program.graph, program.tree, lines, "    ", {})
    return "\n".join(lines) + "\n"


def _emit(graph: Graph, tree: Tree, lines: list[str], indent: str, names: dict[int, str]) -> None:
    if isinstance(tree, Raises):
        lines.append(f"{indent}raise PluginRaised({tree.message!r})")
    elif isinstance(tree, Outputs):
        for node in tree.nodes:
            _define(graph, node, lines, indent, names)
        results = ", ".join(_name(graph, node, names) for node in tree.nodes)
        lines.append(f"{indent}return [{results}]")
    elif isinstance(tree, Fork):
        _define(graph, tree.condition, lines, indent, names)
        lines.append(f"{indent}if {_name(graph, tree.condition, names)}:")
        _emit(graph, tree.then, lines, indent + "    ", dict(names))
        lines.append(f"{indent}else:")
        _emit(graph, tree.otherwise, lines, indent + "    ", dict(names))


def _name(graph: Graph, node: int, names: dict[int, str]) -> str:
    value = graph.value(node)
    if value is None:
        return names[node]
    if value != value or value in (float("inf"), float("-inf")):
        return f"float('{value}')"
    return f"({value!r})" if value < 0 else repr(value)


def _define(graph: Graph, node: int, lines: list[str], indent: str, names: dict[int, str]) -> None:
    """Statements that compute a node, arguments first. A `select` evaluates only the side it takes."""
    stack = [node]
    while stack:
        current = stack[-1]
        if current in names or graph.value(current) is not None:
            stack.pop()
            continue
        key = graph.nodes[current]
        if key[0] == "select":
            _define(graph, key[1], lines, indent, names)
            names[current] = f"t{current}"
            for condition, side in ((f"if {_name(graph, key[1], names)}:", key[2]), ("else:", key[3])):
                lines.append(indent + condition)
                inner = dict(names)
                _define(graph, side, lines, indent + "    ", inner)
                lines.append(f"{indent}    t{current} = {_name(graph, side, inner)}")
            stack.pop()
            continue
        missing = [a for a in arguments_of(graph, current) if key[0] != "input" and a not in names]
        missing = [a for a in missing if graph.value(a) is None]
        if missing:
            stack.extend(reversed(missing))
            continue
        names[current] = f"t{current}"
        lines.append(f"{indent}t{current} = {_expression(graph, key, names)}")
        stack.pop()


def _expression(graph: Graph, key: tuple, names: dict[int, str]) -> str:
    if key[0] == "input":
        return f"{key[1]}[{key[2]}]"
    arguments = [_name(graph, a, names) for a in key[1:]]
    if key[0] in _INFIX:
        if graph.value(key[1]) is not None and graph.value(key[2]) is not None:
            arguments[0] = f"number_({arguments[0]})"  # not in floats where more digits are asked for
        return f"{arguments[0]} {_INFIX[key[0]]} {arguments[1]}"
    if key[0] == "not":
        return f"not {arguments[0]}"
    if key[0] == "neg":
        return f"-{arguments[0]}"
    return f"{key[0]}_({', '.join(arguments)})"
