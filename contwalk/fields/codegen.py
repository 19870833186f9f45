"""Writing a program as straight-line Python."""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.fields.derivative import ancestors, arguments_of
from contwalk.fields.graph import ROUNDING
from contwalk.fields.trace import Fork, Outputs, Program, Raises, Tree, roots
from contwalk.numerics import noise

_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
# Conditions are True, False, or None where a number in them is NaN. `and` is decided by a side that does not
# hold, `or` by one that does, whatever the other one is.
_CONDITIONS = {
    "lt": "True if {0} < {1} else False if {0} >= {1} else None",
    "le": "True if {0} <= {1} else False if {0} > {1} else None",
    "eq": "True if {0} == {1} else False if {0} < {1} or {0} > {1} else None",
    "and": "False if {1} is False else ({0} and {1})",
    "or": "True if {1} else {1} if {0} is False else {0}",
    "not": "None if {0} is None else not {0}",
}
_NEVER_RAISE = ("add", "sub", "mul", "neg", "abs", "min", "max", "sign")


def source(program: Program, groups: Sequence[str]) -> str:
    """Text of a function `evaluate(group, ...)` that returns the outputs as a list.

    Parameters
    ----------
    program : Program
    groups : sequence of str
        Names of the input arrays, in the order of the arguments.
    """
    lines = [f"def evaluate({', '.join(groups)}):"]
    _emit(_Graph(program), program.tree, lines, "    ", {})
    return "\n".join(lines) + "\n"


class _Graph:
    """A program's graph, and which of its nodes conditions of choices are computed from.

    These are NaN where they do not exist, since the choice may not depend on them: they must not raise.
    """

    def __init__(self, program: Program) -> None:
        self.graph, self.nodes, self.value = program.graph, program.graph.nodes, program.graph.value
        self.total: frozenset[int] = frozenset()
        if any(key[0] == "select" for key in self.nodes):
            needed = ancestors(program.graph, roots(program.tree))
            chosen_by = [self.nodes[node][1] for node in needed if self.nodes[node][0] == "select"]
            self.total = frozenset(ancestors(program.graph, chosen_by))


def _emit(graph: _Graph, tree: Tree, lines: list[str], indent: str, names: dict[int, str]) -> None:
    if isinstance(tree, Raises):
        lines.append(f"{indent}raise PluginRaised({tree.message!r})")
    elif isinstance(tree, Outputs):
        for node in tree.nodes:
            _define(graph, node, lines, indent, names)
        results = ", ".join(_result(graph, node, names) for node in tree.nodes)
        lines.append(f"{indent}return [{results}]")
    elif isinstance(tree, Fork):
        _define(graph, tree.condition, lines, indent, names)
        condition = _name(graph, tree.condition, names)
        lines.append(f"{indent}if {condition} is None:")
        lines.append(f"{indent}    raise ArithmeticError('a comparison with NaN has no outcome')")
        lines.append(f"{indent}if {condition}:")
        _emit(graph, tree.then, lines, indent + "    ", dict(names))
        lines.append(f"{indent}else:")
        _emit(graph, tree.otherwise, lines, indent + "    ", dict(names))


def _result(graph: _Graph, node: int, names: dict[int, str]) -> str:
    """An output, with noise in its last bits where there is to be some; see `numerics.noise`."""
    noisy = noise.SEED is not None and graph.value(node) is None and graph.nodes[node][0] in ROUNDING
    return f"noisy_({names[node]})" if noisy else _name(graph, node, names)


def _name(graph: _Graph, node: int, names: dict[int, str]) -> str:
    value = graph.value(node)
    if value is None:
        return names[node]
    if value != value or value in (float("inf"), float("-inf")):
        return f"float('{value}')"
    return f"({value!r})" if value < 0 else repr(value)


def _define(graph: _Graph, node: int, lines: list[str], indent: str, names: dict[int, str]) -> None:
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
            condition = _name(graph, key[1], names)
            lines.append(f"{indent}if {condition} is None:")
            lines.append(f"{indent}    t{current} = NAN_")
            for word, side in ((f"elif {condition}:", key[2]), ("else:", key[3])):
                lines.append(indent + word)
                inner = dict(names)
                _define(graph, side, lines, indent + "    ", inner)
                lines.append(f"{indent}    t{current} = {_name(graph, side, inner)}")
            stack.pop()
            continue
        missing = [a for a in arguments_of(graph.graph, current) if key[0] != "input" and a not in names]
        missing = [a for a in missing if graph.value(a) is None]
        if missing:
            stack.extend(reversed(missing))
            continue
        names[current] = f"t{current}"
        lines.append(f"{indent}t{current} = {_expression(graph, current, names)}")
        stack.pop()


def _expression(graph: _Graph, node: int, names: dict[int, str]) -> str:
    key = graph.nodes[node]
    if key[0] == "input":
        return f"{key[1]}[{key[2]}]"
    arguments = [_name(graph, a, names) for a in key[1:]]
    if key[0] in _CONDITIONS:
        return _CONDITIONS[key[0]].format(*arguments)
    if key[0] in _INFIX and all(graph.value(argument) is not None for argument in key[1:]):
        arguments[0] = f"number_({arguments[0]})"  # not in floats where more digits are asked for
    if node in graph.total and key[0] not in _NEVER_RAISE:
        return f"total_{key[0]}_({', '.join(arguments)})"
    if key[0] in _INFIX:
        return f"{arguments[0]} {_INFIX[key[0]]} {arguments[1]}"
    if key[0] == "neg":
        return f"-{arguments[0]}"
    return f"{key[0]}_({', '.join(arguments)})"
