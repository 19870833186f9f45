"""Recording what a function computes, along every path it can take.

A comparison of symbols has no value yet; the tracer explores both outcomes, one call of the function for
each path. The result is a `Program`: a tree whose inner nodes are conditions and whose leaves are outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from contwalk.errors import NO_LINE, ContwalkError, UnsupportedOperation, plugin_line
from contwalk.fields.expression import Expression
from contwalk.fields.graph import Graph

MOST_PATHS = 256
MOST_CONDITIONS = 64


@dataclass(frozen=True)
class Outputs:
    """A leaf: the nodes of the results."""

    nodes: tuple[int, ...]


@dataclass(frozen=True)
class Raises:
    """A leaf on which the function itself raises."""

    message: str


@dataclass(frozen=True)
class Fork:
    """A condition with what follows where it holds and where it does not."""

    condition: int
    then: Tree
    otherwise: Tree


Tree = Outputs | Raises | Fork


@dataclass(frozen=True)
class Program:
    """What a function computes: a graph and a tree of outputs over it."""

    graph: Graph
    tree: Tree

    def transformed(self, change: Callable[[tuple[int, ...]], Sequence[int]]) -> Program:
        """The program whose outputs are `change(outputs)` on every leaf."""

        def walk(tree: Tree) -> Tree:
            if isinstance(tree, Fork):
                return Fork(tree.condition, walk(tree.then), walk(tree.otherwise))
            return Outputs(tuple(change(tree.nodes))) if isinstance(tree, Outputs) else tree

        return Program(self.graph, walk(self.tree))

    def reads(self, group: str) -> bool:
        """Whether a result, or a comparison, depends on an input of this group."""
        stack, seen = list(roots(self.tree)), set[int]()
        while stack:
            node = stack.pop()
            if node in seen:
                continue
            seen.add(node)
            key = self.graph.nodes[node]
            if key[0] == "input":
                if key[1] == group:
                    return True
            elif key[0] != "const":
                stack.extend(key[1:])
        return False

    def leaves(self) -> list[Outputs | Raises]:
        """All leaves."""

        def walk(tree: Tree) -> list[Outputs | Raises]:
            return walk(tree.then) + walk(tree.otherwise) if isinstance(tree, Fork) else [tree]

        return walk(self.tree)


class Tracer:
    """Hands out symbols and answers their comparisons, path by path."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.path: list[tuple[int, bool]] = []
        self._given: list[bool] = []

    def restart(self, given: list[bool]) -> None:
        """Begin a call whose first decisions are `given`."""
        self.path, self._given = [], given

    def decide(self, condition: int) -> bool:
        """The outcome of a comparison on this path."""
        key = self.graph.nodes[condition]
        if key[0] == "not":
            return not self.decide(key[1])
        if key[0] in ("and", "or"):
            first = self.decide(key[1])
            return self.decide(key[2]) if first == (key[0] == "and") else first
        relation, a, b = key
        va, vb = self.graph.value(a), self.graph.value(b)
        if va is not None and vb is not None:
            return {"lt": va < vb, "le": va <= vb, "eq": va == vb}[relation]
        for decided, outcome in self.path:
            if decided == condition:
                return outcome
        if len(self.path) >= MOST_CONDITIONS:
            raise UnsupportedOperation(
                f"More than {MOST_CONDITIONS} comparisons of the state are made one after another.",
                "A loop whose end depends on the state cannot be traced; give it a fixed number of passes.",
            )
        outcome = self._given[len(self.path)] if len(self.path) < len(self._given) else True
        self.path.append((condition, outcome))
        return outcome

    def symbol(self, group: str, index: int) -> Expression:
        """The symbol of an input."""
        return Expression(self.graph, self.graph.input(group, index), self)


def trace(function: Callable[[Tracer], Sequence[Any]]) -> Program:
    """The program of a function.

    Parameters
    ----------
    function : callable
        Called with a `Tracer` that hands out symbols; returns a sequence of results. It is called once for
        each path through its comparisons.

    Raises
    ------
    UnsupportedOperation
        With the line of the plugin, if the function does what cannot be traced.
    """
    graph = Graph()
    tracer = Tracer(graph)
    given: list[bool] = []
    paths: list[tuple[list[tuple[int, bool]], Outputs | Raises]] = []
    while True:
        tracer.restart(given)
        paths.append((tracer.path, _leaf(function, tracer)))
        paths[-1] = (list(tracer.path), paths[-1][1])
        if len(paths) > MOST_PATHS:
            raise UnsupportedOperation(
                f"There are more than {MOST_PATHS} paths through the comparisons of this function.",
                "Use min, max, abs or numpy.where in place of some of its branches.",
            )
        given = [outcome for _, outcome in tracer.path]
        while given and not given[-1]:
            given.pop()
        if not given:
            return Program(graph, _tree(paths, 0))
        given[-1] = False


def _leaf(function: Callable[[Tracer], Sequence[Any]], tracer: Tracer) -> Outputs | Raises:
    try:
        results = function(tracer)
    except UnsupportedOperation as error:
        raise UnsupportedOperation(f"{plugin_line(error)}: {error.sentence}", error.remedy) from error
    except ContwalkError:
        raise
    except TypeError as error:  # most often something that numbers can do and symbols cannot
        if plugin_line(error) == NO_LINE:  # the call itself: wrong number of arguments
            return Raises(f"{NO_LINE}: TypeError: {error}")
        raise UnsupportedOperation(
            f"{plugin_line(error)}: this cannot be traced ({error}).",
            "Use arithmetic, comparisons, and the functions of docs/reference/plugin.md.",
        ) from error
    except (Exception, SystemExit) as error:
        return Raises(f"{plugin_line(error)}: {type(error).__name__}: {error}")
    zero = Expression(tracer.graph, tracer.graph.zero, tracer)
    return Outputs(tuple(zero.lift(result) for result in results))


def roots(tree: Tree) -> list[int]:
    """Nodes of a tree's outputs and conditions."""
    if isinstance(tree, Fork):
        return [tree.condition, *roots(tree.then), *roots(tree.otherwise)]
    return list(tree.nodes) if isinstance(tree, Outputs) else []


def _tree(paths: list[tuple[list[tuple[int, bool]], Outputs | Raises]], depth: int) -> Tree:
    """Paths that share their first `depth` decisions, as a tree."""
    conditions, leaf = paths[0]
    if len(conditions) == depth:
        return leaf
    holds = [p for p in paths if p[0][depth][1]]
    fails = [p for p in paths if not p[0][depth][1]]
    return Fork(conditions[depth][0], _tree(holds, depth + 1), _tree(fails, depth + 1))
