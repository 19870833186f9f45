"""Nodes of an expression graph that stand for numbers in a plugin's functions."""

from __future__ import annotations

from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.fields.complex_numbers import REMEDY, applied, is_complex
from contwalk.fields.domains import product
from contwalk.fields.functions import Number
from contwalk.fields.graph import Graph

KEPT = (
    "What the function gives depends on an earlier call of it: it keeps something in a variable outside, or "
    "in a default argument."
)


def _words(value: Any) -> str:
    """What stands where a number should, in words."""
    shape = getattr(value, "shape", None)
    if shape is not None:
        return f"an array of shape {shape}"
    return f"a {type(value).__name__}" if isinstance(value, list | tuple | dict) else repr(value)


class Expression(Number):
    """A node of a graph that behaves like a number in a plugin's function."""

    __slots__ = ("graph", "node", "tracer")

    def __init__(self, graph: Graph, node: int, tracer: Any) -> None:
        self.graph = graph
        self.node = node
        self.tracer = tracer

    def wrap(self, node: int) -> Expression:
        """Another node of the same graph."""
        return Expression(self.graph, node, self.tracer)

    def lift(self, other: Any) -> int:
        """Node of an operand: an expression or a number; a condition is 1 where it holds, else 0."""
        if isinstance(other, Expression):
            graph, node = other.graph, other.node
            if graph is not self.graph:
                raise UnsupportedOperation(KEPT, "What it needs must be constant, a state or a parameter.")
            return graph.select(node, graph.one, graph.zero) if graph.is_condition(node) else node
        if is_complex(other):
            raise UnsupportedOperation("A complex number stands where a real one is needed.", REMEDY)
        try:
            return self.graph.constant(float(other))
        except (TypeError, ValueError):
            raise UnsupportedOperation(
                f"A number is needed here, and this is {_words(other)}.", "Use real numbers only."
            ) from None

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """A function of `functions.FUNCTIONS` applied to numbers of which at least one is symbolic."""
        for argument in arguments:
            if not isinstance(argument, Expression) and is_complex(argument):
                return applied(name, arguments)
        nodes = [self.lift(a) for a in arguments]
        if name == "mul":
            return self.wrap(product(self.graph, *nodes))
        if name in ("add", "sub", "div"):
            return self.wrap(getattr(self.graph, name)(*nodes))
        if name == "pow":
            return self.wrap(self.graph.power(*nodes))
        if name == "neg":
            return self.wrap(self.graph.neg(*nodes))
        return self.wrap(self.graph.call(name, *nodes))

    def compare(self, relation: str, a: Any, b: Any) -> Expression:
        """A condition."""
        return self.wrap(self.graph.compare(relation, self.lift(a), self.lift(b)))

    def solution(self, matrix: list[list[Any]], columns: list[list[Any]]) -> list[list[Any]]:
        """Solutions of one linear system for several right-hand sides."""
        factor = self._factor(matrix)
        solutions = [self.graph.solved(factor, [self.lift(b) for b in column]) for column in columns]
        return [[self.wrap(item) for item in self.graph.items(each)] for each in solutions]

    def piece(self, breaks: tuple[float, ...]) -> Expression:
        """How many of these rising numbers it has reached."""
        return self.wrap(self.graph.piece(self.node, breaks))

    def entry(self, values: tuple[float, ...]) -> Expression:
        """The value at this place."""
        return self.wrap(self.graph.entry(self.node, values))

    def is_zero(self) -> bool:
        """Whether it is the constant zero."""
        return self.graph.value(self.node) == 0.0

    def determinant_of(self, matrix: list[list[Any]]) -> Expression:
        """The determinant of a matrix."""
        return self.wrap(self.graph.determinant(self._factor(matrix)))

    def _factor(self, matrix: list[list[Any]]) -> int:
        return self.graph.factor([self.lift(entry) for row in matrix for entry in row])

    @property
    def condition(self) -> int:
        """Node of the condition that this is; of a number that it is not zero."""
        if self.graph.is_condition(self.node):
            return self.node
        return self.graph.combine("not", self.graph.compare("eq", self.node, self.graph.zero))

    def __and__(self, other: Any) -> Any:
        return self._combined("and", other)

    def __or__(self, other: Any) -> Any:
        return self._combined("or", other)

    __rand__, __ror__ = __and__, __or__

    def __invert__(self) -> Expression:
        return self.wrap(self.graph.combine("not", self._own_condition()))

    def _own_condition(self) -> int:
        if not self.graph.is_condition(self.node):
            raise UnsupportedOperation(
                "&, | and ~ stand between a number and something else here.",
                "They combine comparisons, each in parentheses: (x[0] > 0) & (x[1] > 0).",
            )
        return self.node

    def _combined(self, operation: str, other: Any) -> Any:
        """This condition and, or or, another one; conditions known already are plain bools."""
        own = self._own_condition()
        if isinstance(other, Expression):
            return self.wrap(self.graph.combine(operation, own, other._own_condition()))
        if operation == "and":
            return self if other else False
        return True if other else self

    def select(self, a: Any, b: Any) -> Expression:
        """`a` where this condition holds, else `b`, without a branch."""
        return self.wrap(self.graph.select(self.condition, self.lift(a), self.lift(b)))

    def __bool__(self) -> bool:
        return self.tracer.decide(self.condition)

    def __float__(self) -> float:
        raise UnsupportedOperation(
            "A number that depends on the state or a parameter is turned into a plain float here.",
            "Use arithmetic, the functions of math, and numpy's functions of single numbers.",
        )

    def __int__(self) -> int:
        raise UnsupportedOperation(
            "A number that depends on the state or a parameter is made a whole number here, as NumPy does in "
            "arrays of whole numbers.",
            "Steps are math.floor(x); arrays are np.zeros(n) or np.array([0.0, 1.0]), of floats.",
        )

    __index__ = __int__
