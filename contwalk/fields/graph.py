"""Expression graphs: every operation a function performs, each recorded once.

Nodes are interned (the same operation on the same arguments is the same node), so common subexpressions are
shared without further effort. Node numbers grow from arguments to results: their order is an order of
evaluation.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from contwalk.fields.elimination import FEW_ROWS
from contwalk.fields.exact_functions import EXACT

Key = tuple[Any, ...]

RELATIONS = ("lt", "le", "eq")
CONDITIONS = (*RELATIONS, "and", "or", "not")
# Nodes that are several numbers: a matrix as it is eliminated; a solution.
FACTORS = ("factor", "factor_symmetric")
BUNDLES = (*FACTORS, "solved")
# Operations of which results are rounded, but for those that count or look something up.
_ROOTS = ("sqrt", "cbrt", "hypot", "pow", "exp", "expm1", "log", "log1p", "log2", "log10")
_CIRCULAR = (
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
)
ROUNDING = frozenset(("add", "sub", "mul", "div", *_ROOTS, *_CIRCULAR, "erf", "erfc", "gamma", "lgamma"))

_ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
}


class Graph:
    """A store of interned nodes. Nodes are named by their number."""

    def __init__(self) -> None:
        self.nodes: list[Key] = []
        self._numbers: dict[Key, int] = {}
        self.tables: list[tuple[float, ...]] = []
        self.zero: int = self.constant(0.0)
        self.one: int = self.constant(1.0)

    def _intern(self, key: Key) -> int:
        number = self._numbers.get(key)
        if number is None:
            number = len(self.nodes)
            self.nodes.append(key)
            self._numbers[key] = number
        return number

    def constant(self, value: float) -> int:
        """Node of a number."""
        # 0.0 and -0.0 are equal as dictionary keys; the sign is part of the key.
        return self._intern(("const", float(value), math.copysign(1.0, value)))

    def input(self, group: str, index: int) -> int:
        """Node of entry `index` of the input array `group`."""
        return self._intern(("input", group, index))

    def value(self, node: int) -> float | None:
        """The number a node stands for, if it is a constant."""
        key = self.nodes[node]
        return key[1] if key[0] == "const" else None

    def _folded(self, name: str, a: int, b: int) -> int:
        """The constant that an operation on constants gives, if a float holds it exactly; else the operation.

        Derivatives are evaluated in extended precision too: a constant rounded here would be wrong there.
        """
        va, vb = self.nodes[a][1], self.nodes[b][1]
        if math.isfinite(va) and math.isfinite(vb):
            value = _ARITHMETIC[name](va, vb)
            if math.isfinite(value) and Fraction(value) == _ARITHMETIC[name](Fraction(va), Fraction(vb)):
                return self.constant(value)
        return self._intern((name, a, b))

    def add(self, a: int, b: int) -> int:
        """a + b."""
        ka, kb = self.nodes[a], self.nodes[b]
        if ka[0] == "const" or kb[0] == "const":
            va, vb = self.value(a), self.value(b)
            if va == 0.0:
                return b
            if vb == 0.0:
                return a
            if va is not None and vb is not None:
                return self._folded("add", a, b)
        if kb[0] == "neg":
            return self.sub(a, kb[1])
        if ka[0] == "neg":
            return self.sub(b, ka[1])
        return self._intern(("add", a, b) if a <= b else ("add", b, a))

    def sub(self, a: int, b: int) -> int:
        """a - b."""
        va, vb = self.value(a), self.value(b)
        if vb == 0.0:
            return a
        if va == 0.0:
            return self.neg(b)
        if va is not None and vb is not None:
            return self._folded("sub", a, b)
        if self.nodes[b][0] == "neg":
            return self.add(a, self.nodes[b][1])
        return self._intern(("sub", a, b))

    def neg(self, a: int) -> int:
        """-a."""
        va = self.value(a)
        if va is not None:
            return self.constant(-va)
        if self.nodes[a][0] == "neg":
            return self.nodes[a][1]
        return self._intern(("neg", a))

    def mul(self, a: int, b: int) -> int:
        """a * b."""
        ka, kb = self.nodes[a], self.nodes[b]
        if ka[0] == "const" or kb[0] == "const":
            va, vb = self.value(a), self.value(b)
            if va is not None and vb is not None:
                return self._folded("mul", a, b)
            for constant, other in ((va, b), (vb, a)):
                if constant == 0.0:
                    return self.zero
                if constant == 1.0:
                    return other
                if constant == -1.0:
                    return self.neg(other)
        if ka[0] == "neg":
            return self.neg(self.mul(ka[1], b))
        if kb[0] == "neg":
            return self.neg(self.mul(a, kb[1]))
        return self._intern(("mul", a, b) if a <= b else ("mul", b, a))

    def kept(self, name: str, a: int, b: int) -> int:
        """An operation as it stands: nothing is folded or dropped."""
        return self._intern((name, a, b))

    def div(self, a: int, b: int) -> int:
        """a / b."""
        va, vb = self.value(a), self.value(b)
        if va is not None and vb is not None and vb != 0.0:
            return self._folded("div", a, b)
        if va == 0.0 and vb != 0.0:
            return self.zero
        if vb == 1.0:
            return a
        if vb == -1.0:
            return self.neg(a)
        return self._intern(("div", a, b))

    def power(self, a: int, b: int) -> int:
        """a ** b. Small whole exponents become products, whose derivatives stay exact at zero."""
        exponent = self.value(b)
        if exponent is not None and abs(exponent) <= 16 and exponent == int(exponent):
            product = self._whole_power(a, abs(int(exponent)))
            return product if exponent >= 0 else self.div(self.one, product)
        if exponent == 0.5:
            return self.call("sqrt", a)
        return self.call("pow", a, b)

    def _whole_power(self, a: int, exponent: int) -> int:
        if exponent == 0:
            return self.one
        half = self._whole_power(a, exponent // 2)
        square = self.mul(half, half)
        return self.mul(square, a) if exponent % 2 else square

    def call(self, name: str, *arguments: int) -> int:
        """A function of `functions.FUNCTIONS` applied to nodes."""
        values = [self.value(a) for a in arguments]
        if name in EXACT and all(v is not None and math.isfinite(v) for v in values):
            return self.constant(EXACT[name](*values))
        return self._intern((name, *arguments))

    def has(self, name: str, *arguments: int) -> bool:
        """Whether there is this function of these nodes."""
        return (name, *arguments) in self._numbers

    def piece(self, a: int, breaks: tuple[float, ...]) -> int:
        """How many of these rising numbers `a` has reached."""
        return self._intern(("piece", a, self._table(breaks)))

    def entry(self, place: int, values: tuple[float, ...]) -> int:
        """The value at a place that `piece` has found."""
        return self._intern(("entry", place, self._table(values)))

    def _table(self, values: tuple[float, ...]) -> int:
        """Node of the number of a table among `tables`."""
        if values not in self.tables:
            self.tables.append(values)
        return self.constant(float(self.tables.index(values)))

    def factor(self, entries: Sequence[int]) -> int:
        """A square matrix, given row by row, made ready to solve equations (`elimination`)."""
        n = math.isqrt(len(entries))
        symmetric = all(entries[i * n + j] == entries[j * n + i] for i in range(n) for j in range(i))
        kind = "factor_symmetric" if symmetric and n > FEW_ROWS else "factor"
        return self._intern((kind, *entries))

    def solved(self, factor: int, right: Sequence[int]) -> int:
        """The solution for a right-hand side, all of it."""
        return self._intern(("solved", factor, *right))

    def item(self, solution: int, i: int) -> int:
        """One number of a solution."""
        return self._intern(("item", solution, self.constant(float(i))))

    def items(self, solution: int) -> list[int]:
        """All numbers of a solution."""
        return [self.item(solution, i) for i in range(len(self.nodes[solution]) - 2)]

    def determinant(self, factor: int) -> int:
        """The determinant of a matrix."""
        return self._intern(("determinant", factor))

    def is_bundle(self, node: int) -> bool:
        """Whether a node is several numbers."""
        return self.nodes[node][0] in BUNDLES

    def compare(self, relation: str, a: int, b: int) -> int:
        """Node of a comparison (`lt`, `le`, `eq`); only conditions of branches and `select` use it."""
        return self._intern((relation, a, b))

    def is_condition(self, node: int) -> bool:
        """Whether a node is a condition rather than a number."""
        return self.nodes[node][0] in CONDITIONS

    def combine(self, operation: str, *conditions: int) -> int:
        """Node of conditions combined by `and`, `or`, `not`."""
        return self._intern((operation, *conditions))

    def select(self, condition: int, a: int, b: int) -> int:
        """`a` where the condition holds, else `b`."""
        return a if a == b else self._intern(("select", condition, a, b))
