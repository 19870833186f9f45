"""Writing a traced program as a function of a plugin: Python in the symbols `t`, `x[i]` and `p.name`."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from contwalk.errors import UnsupportedOperation
from contwalk.fields.derivative import ancestors, arguments_of
from contwalk.fields.graph import FACTORS, Graph
from contwalk.fields.trace import Fork, Outputs, Program, Tree

# How tightly operations bind; what binds less than its place asks for gets parentheses. Of each operator: its
# own tightness, and what its sides ask for; the order of operations is kept, to the bit.
_CHOICE, _SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(6)
_INFIX = {
    "add": ("+", _SUM, _SUM, _PRODUCT),
    "sub": ("-", _SUM, _SUM, _PRODUCT),
    "mul": ("*", _PRODUCT, _PRODUCT, _SIGN),
    "div": ("/", _PRODUCT, _PRODUCT, _SIGN),
    "pow": ("**", _POWER, _ATOM, _POWER),
}
_RELATIONS = {"lt": ("<", ">="), "le": ("<=", ">"), "eq": ("==", "!=")}
_NAMES = {"abs": "abs", "min": "min", "max": "max", "sign": "np.sign"}
_UNWRITABLE = ("piece", "entry", "polygamma")


def function_text(
    head: str, about: str, program: Program, parameters: Sequence[str], outputs: Sequence[str] = ()
) -> str:
    """Text of a function with the form of a plugin's.

    Parameters
    ----------
    head : str
        Name and arguments, as in `slides(t, x, p, dx)`.
    about : str
        Its docstring.
    program : Program
        In the groups `t`, `x` and `p`, the parameters in their order.
    parameters : sequence of str
        Names of the parameters.
    outputs : sequence of str, optional
        What each output is written to, as in `dx[0]`; without it the one output is returned.

    Raises
    ------
    UnsupportedOperation
        For what no single expression writes: tables, splines and polygamma functions.
    """
    lines = [f"def {head}:", f'    """{about}"""']
    _Writer(program.graph, parameters, outputs).write(program.tree, lines, "    ")
    return "\n".join(lines) + "\n"


class _Writer:
    def __init__(self, graph: Graph, parameters: Sequence[str], outputs: Sequence[str]) -> None:
        self.graph, self.parameters, self.outputs = graph, parameters, outputs

    def write(self, tree: Tree, lines: list[str], indent: str) -> None:
        if isinstance(tree, Fork):
            lines.append(f"{indent}if {self._condition(tree.condition, {})}:")
            self.write(tree.then, lines, indent + "    ")
            lines.append(f"{indent}else:")
            self.write(tree.otherwise, lines, indent + "    ")
        elif isinstance(tree, Outputs):
            self._leaf(tree.nodes, lines, indent)
        else:
            lines.append(f"{indent}raise ValueError({tree.message!r})")

    def _leaf(self, nodes: Sequence[int], lines: list[str], indent: str) -> None:
        names: dict[int, str] = {}
        for node in self._shared(nodes):
            text = self._text(node, names, _CHOICE)
            names[node] = f"{'s' if self.graph.is_bundle(node) else 'a'}{len(names) + 1}"
            lines.append(f"{indent}{names[node]} = {text}")
        for k, node in enumerate(nodes):
            result = f"{self.outputs[k]} =" if self.outputs else "return"
            lines.append(f"{indent}{result} {self._text(node, names, _CHOICE)}")

    def _shared(self, nodes: Sequence[int]) -> list[int]:
        """Operations that are used more than once, and solutions, in an order of evaluation.

        What a choice uses is written in it: on the side that is not taken it need not exist.
        """
        graph = self.graph
        uses: Counter[int] = Counter(nodes)
        stack, seen = list(nodes), set[int]()
        while stack:
            node = stack.pop()
            arguments = arguments_of(graph, node)
            if node not in seen and graph.nodes[node][0] != "select":
                uses.update(arguments)
                stack += arguments
            seen.add(node)
        alone = ("const", "input", *FACTORS)
        return [
            node
            for node in ancestors(graph, seen)
            if node in seen
            and graph.nodes[node][0] not in alone
            and (uses[node] > 1 or graph.nodes[node][0] == "solved")
        ]

    def _text(self, node: int, names: dict[int, str], place: int) -> str:
        """The text of a node where something that binds as `place` is needed."""
        text, binds = self._bound(node, names)
        return f"({text})" if binds < place else text

    def _bound(self, node: int, names: dict[int, str]) -> tuple[str, int]:
        """The text of a node, and how tightly it binds."""
        if node in names:
            return names[node], _ATOM
        name, *a = self.graph.nodes[node]
        if name == "const":
            return _number(a[0])
        if name == "input":
            return {"t": "t", "x": f"x[{a[1]}]"}.get(a[0]) or f"p.{self.parameters[a[1]]}", _ATOM
        if name in _INFIX:
            sign, binds, left, right = _INFIX[name]
            if name == "add" and (self.graph.value(a[1]) or 0.0) < 0.0:  # a - 1.0 rather than a + -1.0
                sign, a[1] = "-", self.graph.neg(a[1])
            return f"{self._text(a[0], names, left)} {sign} {self._text(a[1], names, right)}", binds
        if name == "neg":
            return f"-{self._text(a[0], names, _SIGN)}", _SIGN
        if name == "item":
            return f"{self._text(a[0], names, _ATOM)}[{int(self.graph.nodes[a[1]][1])}]", _ATOM
        return self._called(node, names), _ATOM

    def _called(self, node: int, names: dict[int, str]) -> str:
        name, *a = self.graph.nodes[node]
        if name in _UNWRITABLE:
            raise UnsupportedOperation(
                "A table, a spline or the derivative of a gamma function is not written as one expression.",
                "Write the sliding mode by hand, with calls of the fields of both modes: "
                "docs/howto/relays.md has the formula.",
            )
        if name == "select":
            sides = ", ".join(self._text(side, names, _CHOICE) for side in a[1:])
            return f"np.where({self._condition(a[0], names)}, {sides})"
        if name == "solved":
            right = ", ".join(self._text(b, names, _CHOICE) for b in a[1:])
            return f"np.linalg.solve({self._matrix(a[0], names)}, np.array([{right}]))"
        if name == "determinant":
            return f"np.linalg.det({self._matrix(a[0], names)})"
        arguments = ", ".join(self._text(argument, names, _CHOICE) for argument in a)
        return f"{_NAMES.get(name, f'math.{name}')}({arguments})"

    def _matrix(self, factor: int, names: dict[int, str]) -> str:
        entries = [self._text(entry, names, _CHOICE) for entry in self.graph.nodes[factor][1:]]
        n = math.isqrt(len(entries))
        rows = (", ".join(entries[i * n : (i + 1) * n]) for i in range(n))
        return f"np.array([{', '.join(f'[{row}]' for row in rows)}])"

    def _condition(self, node: int, names: dict[int, str], holds: bool = True) -> str:
        """A condition, or its contrary: `not` of a traced condition is written into its relations."""
        name, *a = self.graph.nodes[node]
        if name == "not":
            return self._condition(a[0], names, not holds)
        if name in _RELATIONS:
            relation = _RELATIONS[name][0 if holds else 1]
            return f"{self._text(a[0], names, _SUM)} {relation} {self._text(a[1], names, _SUM)}"
        both = (name == "and") == holds
        sides = (f"({self._condition(side, names, holds)})" for side in a)
        return f" {'&' if both else '|'} ".join(sides)


def _number(value: float) -> tuple[str, int]:
    if math.isfinite(value):
        return repr(value), _SIGN if math.copysign(1.0, value) < 0 else _ATOM
    return f'float("{value}")', _ATOM
