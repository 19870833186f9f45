"""Where a traced function is smooth by pieces only: its choices, and what jumps where one changes.

A comparison, `abs`, `min`, `floor` or a table chooses a smooth piece. Choices are told at many inputs at
once; with the choices of one side held, a function and its derivatives are those of that side's piece,
wherever they are asked for. So the difference of both sides at one place is exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.derivative import ancestors, directional
from contwalk.fields.functions import FUNCTIONS
from contwalk.fields.graph import FACTORS, Graph
from contwalk.fields.trace import Fork, Outputs, Program, Tree, roots

# What may jump where these choose otherwise is a derivative, never the value.
CONTINUOUS = frozenset({"abs", "min", "max"})
CHOICES = CONTINUOUS | {"sign", "floor", "trunc", "fmod", "piece", "lt", "le"}

Inputs = Mapping[tuple[str, int], Any]
Held = Mapping[int, Any]

_BY_NUMPY = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "neg": np.negative,
    "pow": np.power,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "asinh": np.arcsinh,
    "acosh": np.arccosh,
    "atanh": np.arctanh,
}


def choices_of(program: Program) -> tuple[int, ...]:
    """Nodes of a program that choose between smooth pieces."""
    graph = program.graph
    return tuple(n for n in ancestors(graph, roots(program.tree)) if graph.nodes[n][0] in CHOICES)


def may_jump(program: Program) -> bool:
    """Whether a value of a program may jump, and not only its slopes."""
    return any(program.graph.nodes[node][0] not in CONTINUOUS for node in choices_of(program))


class Switching:
    """A program that is smooth by pieces.

    Parameters
    ----------
    program : Program
    moving : sequence of (group, index)
        Inputs that are unknowns: what a switching instant may depend on.
    time : (group, index)
    """

    def __init__(self, program: Program, moving: Iterable[tuple[str, int]], time: tuple[str, int]) -> None:
        self.program, self.graph = program, program.graph
        self.choices = choices_of(program)
        self.unknowns, self._time = list(moving), time
        # What has been told of thin layers, by all choices before, in and behind them.
        self.layers: dict[bytes, float] = {}

    def sides(self, inputs: Inputs) -> np.ndarray:
        """What each choice is at some inputs, shape (.., choices); NaN where it is undefined."""
        if not self.choices:
            return np.zeros((1, 0))
        chosen: dict[int, Any] = {}
        _values(self.graph, self._deciding, inputs, {}, chosen)
        return np.stack(np.broadcast_arrays(*[chosen[node] for node in self.choices]), axis=-1).astype(float)

    def numbers(self, inputs: Inputs) -> np.ndarray:
        """Numbers that pass a whole one where the choices change, at some inputs, shape (.., choices)."""
        nodes, behind = self._compared
        found = _values(self.graph, behind, inputs, {}, {})
        values = [self._level(choice, found[node]) for choice, node in zip(self.choices, nodes, strict=True)]
        return np.stack(np.broadcast_arrays(*values), axis=-1).astype(float)

    def _level(self, choice: int, number: Any) -> Any:
        """A switching function's value, where only zero counts between -1 and 1; the place among breaks."""
        name, *arguments = self.graph.nodes[choice]
        if name in ("floor", "trunc", "fmod"):
            return number
        if name != "piece":
            with np.errstate(invalid="ignore"):
                return number / (1.0 + np.abs(number))
        breaks = np.asarray(self.graph.tables[int(arguments[-1])])
        return np.interp(number, breaks, np.arange(len(breaks)))

    def jumps(self, changed: Iterable[int]) -> bool:
        """Whether the value may jump where these choices (by their columns) change."""
        return any(self.graph.nodes[self.choices[k]][0] not in CONTINUOUS for k in changed)

    def values(self, inputs: Inputs) -> np.ndarray:
        """The outputs at some inputs, shape (.., outputs)."""
        return self._outputs(self.program.tree, inputs, {}, {})

    def beside(
        self, inputs: Inputs, before: Inputs, after: Inputs, directions: Mapping[tuple[str, int], float]
    ) -> np.ndarray:
        """Values and first and second derivatives along a direction of both sides' pieces at one place.

        Shape (2, 3, number of outputs). Which pieces these are is told by two places beside it.
        """
        found: np.ndarray = self.beside_each(inputs, before, after, directions, 1)[:, 0]
        return found

    def beside_each(
        self,
        inputs: Inputs,
        before: Inputs,
        after: Inputs,
        directions: Mapping[tuple[str, int], float],
        count: int,
    ) -> np.ndarray:
        """As `beside`, at so many places at once: inputs of shape (count,), or one for all of them.

        Shape (2, count, 3, number of outputs).
        """
        held = [self.held(place, directions) for place in (before, after)]
        return np.array([self.pieces(inputs, each, directions, count) for each in held])

    def held(self, place: Inputs, directions: Mapping[tuple[str, int], float]) -> dict[int, Any]:
        """What all choices are at a place, those in first and second derivatives among them."""
        held: dict[int, Any] = {}
        self._outputs(self._lifted.tree, {**place, **self._along(directions)}, {}, held)
        return held

    def pieces(
        self, inputs: Inputs, held: Held, directions: Mapping[tuple[str, int], float], count: int
    ) -> np.ndarray:
        """Values and derivatives as of `beside_each`, with these choices: shape (count, 3, outputs)."""
        outputs = self._outputs(self._lifted.tree, {**inputs, **self._along(directions)}, held, {})
        return np.broadcast_to(outputs, (count, outputs.shape[-1])).reshape(count, 3, -1)

    def _along(self, directions: Mapping[tuple[str, int], float]) -> dict[tuple[str, int], float]:
        return {("k", k): directions.get(name, 0.0) for k, name in enumerate(self.unknowns)}

    def limited_to(self, choices: Iterable[int]) -> Switching:
        """The same program, of which only some of the choices are watched."""
        limited = Switching(self.program, self.unknowns, self._time)
        limited.choices = tuple(choices)
        return limited

    @property
    def lifted_nodes(self) -> list[int]:
        """Nodes of the program with its derivatives, in an order of evaluation."""
        return self._behind[id(self._lifted.tree)]

    def moves(self, inputs: Inputs, changed: Iterable[int], directions: Mapping[Any, float]) -> bool:
        """Whether the instant at which choices change depends on the unknowns."""
        graph, nodes = self.graph, [self._switching_function(self.choices[k]) for k in changed]
        along = {graph.input(*name): graph.constant(directions.get(name, 0.0)) for name in self.unknowns}
        in_time = directional(graph, nodes, {graph.input(*self._time): graph.one})
        wanted = [*directional(graph, nodes, along), *in_time]
        found = _values(graph, ancestors(graph, wanted), inputs, {}, {})
        rates = np.abs([float(np.ravel(found[node])[0]) for node in wanted]).reshape(2, -1)
        return bool(np.any(rates[0] > FIXED * rates[1]))

    def _switching_function(self, node: int) -> int:
        """Node of the number whose passing of a level changes a choice."""
        name, *arguments = self.graph.nodes[node]
        if name in ("lt", "le", "min", "max"):
            return self.graph.sub(*arguments)
        return self.graph.div(*arguments) if name == "fmod" else int(arguments[0])

    @cached_property
    def _deciding(self) -> list[int]:
        """Nodes that the choices follow from."""
        return list(ancestors(self.graph, self.choices))

    @cached_property
    def _compared(self) -> tuple[list[int], list[int]]:
        """Nodes of the choices' switching functions, and the nodes that these follow from."""
        nodes = [self._switching_function(node) for node in self.choices]
        return nodes, list(ancestors(self.graph, nodes))

    @cached_property
    def _behind(self) -> dict[int, list[int]]:
        """Nodes that a program's outputs follow from, by the tree's own id: both are kept here."""
        trees = (self.program.tree, self._lifted.tree)
        return {id(tree): list(ancestors(self.graph, roots(tree))) for tree in trees}

    @cached_property
    def _lifted(self) -> Program:
        graph = self.graph
        along = {graph.input(*name): graph.input("k", k) for k, name in enumerate(self.unknowns)}

        def change(outputs: tuple[int, ...]) -> list[int]:
            first = directional(graph, list(outputs), along)
            return [*outputs, *first, *directional(graph, first, along)]

        return self.program.transformed(change)

    def _outputs(self, tree: Tree, inputs: Inputs, held: Held, chosen: dict[int, Any]) -> np.ndarray:
        values = _values(self.graph, self._behind[id(tree)], inputs, held, chosen)
        width = max((len(leaf.nodes) for leaf in self._leaves(tree)), default=1)

        def of(part: Tree) -> np.ndarray:
            if isinstance(part, Fork):
                holds = np.asarray(values[part.condition])[..., None]
                otherwise = np.where(holds == 0.0, of(part.otherwise), np.nan)
                return np.where(holds == 1.0, of(part.then), otherwise)
            if isinstance(part, Outputs):
                entries = [np.asarray(values[node], dtype=float) for node in part.nodes]
                return np.stack(np.broadcast_arrays(*entries), axis=-1)
            return np.full(width, np.nan)

        with np.errstate(all="ignore"):
            return of(tree)

    @staticmethod
    def _leaves(tree: Tree) -> list[Outputs]:
        if isinstance(tree, Fork):
            return Switching._leaves(tree.then) + Switching._leaves(tree.otherwise)
        return [tree] if isinstance(tree, Outputs) else []


# A switching function that changes by less than this part of what it does in time does not move.
FIXED = 1e-9


def _values(
    graph: Graph, nodes: Iterable[int], inputs: Inputs, held: Held, chosen: dict[int, Any]
) -> dict[int, Any]:
    """Values of nodes, which are in an order of evaluation; the choices that are met go into `chosen`."""
    values: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for node in nodes:
            name, *key = graph.nodes[node]
            if name == "const":
                values[node] = key[0]
            elif name == "input":
                values[node] = inputs[key[0], key[1]]
            elif name in CHOICES:
                arguments = [values[a] for a in key]
                choice = held[node] if node in held else _chosen(graph, name, arguments)
                chosen[node], values[node] = choice, _as_chosen(name, choice, arguments)
            else:
                values[node] = _operation(graph, name)(*[values[a] for a in key])
    return values


def _chosen(graph: Graph, name: str, arguments: list[Any]) -> Any:
    """What a choice is."""
    a, b = arguments[0], arguments[-1]
    if name == "piece":
        table = np.asarray(graph.tables[int(b)])
        return np.where(np.isnan(a), np.nan, np.searchsorted(table, a, side="right"))
    if name in ("abs", "sign"):
        return np.sign(a)
    if name in ("floor", "trunc", "fmod"):
        return np.floor(a) if name == "floor" else np.trunc(a / b if name == "fmod" else a)
    outcome = {"lt": a < b, "le": a <= b, "min": b < a, "max": b > a}[name]
    return np.where(np.isnan(a) | np.isnan(b), np.nan, outcome)


def _as_chosen(name: str, choice: Any, arguments: list[Any]) -> Any:
    """The value on the piece that is chosen."""
    if name == "abs":
        return choice * arguments[0]
    if name == "fmod":
        return arguments[0] - choice * arguments[1]
    if name in ("min", "max"):
        return np.where(np.isnan(choice), np.nan, np.where(choice == 1.0, arguments[1], arguments[0]))
    return choice


def _operation(graph: Graph, name: str) -> Callable[..., Any]:
    if name in _BY_NUMPY:
        return _BY_NUMPY[name]
    if name in _OTHERS:
        return _OTHERS[name]
    if name in FACTORS:
        return _matrix
    if name == "entry":
        return lambda place, table: _looked_up(np.asarray(graph.tables[int(table)]), place)
    own = getattr(np, name, None)
    return own if own is not None else np.vectorize(_total(FUNCTIONS[name].of_float), otypes=[float])


def _total(function: Callable[..., float]) -> Callable[..., float]:
    def call(*arguments: float) -> float:
        try:
            return function(*arguments)
        except (ArithmeticError, ValueError):
            return float("nan")

    return call


def _looked_up(table: np.ndarray, place: Any) -> Any:
    known = np.isfinite(place)
    return np.where(known, table[np.where(known, place, 0).astype(int)], np.nan)


def _matrix(*entries: Any) -> np.ndarray:
    n = math.isqrt(len(entries))
    stacked = np.stack(np.broadcast_arrays(*entries), axis=-1).astype(float)
    return stacked.reshape(*stacked.shape[:-1], n, n)


def _solved(matrix: np.ndarray, *right: Any) -> np.ndarray:
    sides = np.stack(np.broadcast_arrays(*right), axis=-1).astype(float)
    sides = np.broadcast_to(sides, (*matrix.shape[:-2], sides.shape[-1]))
    try:
        return np.linalg.solve(matrix, sides[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.full(sides.shape, np.nan)


_OTHERS: dict[str, Callable[..., Any]] = {
    "eq": lambda a, b: np.where(np.isnan(a) | np.isnan(b), np.nan, np.equal(a, b)),
    # A side that decides does so whatever the other one is.
    "and": lambda a, b: np.where((a == 0.0) | (b == 0.0), 0.0, a * b),
    "or": lambda a, b: np.where((a == 1.0) | (b == 1.0), 1.0, a + b),
    "not": lambda a: 1.0 - a,
    "select": lambda c, a, b: np.where(c == 1.0, a, np.where(c == 0.0, b, np.nan)),
    "solved": _solved,
    "item": lambda solution, i: solution[..., int(i)],
    "determinant": np.linalg.det,
}
