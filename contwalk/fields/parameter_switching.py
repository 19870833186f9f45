"""What of a traced function changes with parameters alone, whatever the states: choices that read no others.

A comparison of a parameter with a number holds everywhere or nowhere, so that no motion crosses the place:
a branch does, at one of its solutions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from functools import cached_property

import numpy as np

from contwalk.fields.derivative import ancestors, arguments_of
from contwalk.fields.switching import CHOICES, Inputs, Switching

Name = tuple[str, int]


class ParameterSwitching:
    """The choices of a function that some of its inputs move, and others that are constants at most.

    Parameters
    ----------
    switching : Switching
    moving : collection of (group, index)
        The free parameters.
    constant : collection of str
        Groups of inputs that no solution changes.

    Attributes
    ----------
    choices : tuple of int
        Nodes of the choices of parameters alone.
    parameters, others : Switching
        The function with only these watched, and with only the others.
    """

    def __init__(self, switching: Switching, moving: Collection[Name], constant: Collection[str]) -> None:
        self._all, self._moving, self._constant = switching, frozenset(moving), frozenset(constant)
        own = self._own(ancestors(switching.graph, switching.choices))
        self.choices = tuple(node for node in switching.choices if node in own)
        self.parameters = switching.limited_to(self.choices)
        self.others = switching.limited_to(node for node in switching.choices if node not in own)

    def beside(
        self, before: Inputs, after: Inputs, directions: Mapping[Name, float], count: int
    ) -> np.ndarray:
        """Values and first and second derivatives along a direction on both sides, at places that differ in
        the parameters by rounding, so many at once: shape (2, count, 3, number of outputs).

        Choices of states alone are those of the first side on both.
        """
        held = [self._all.held(each, directions) for each in (before, after)]
        held[1] = {node: held[node in self._changing][node] for node in held[0]}
        return np.array([self._all.pieces(before, each, directions, count) for each in held])

    @cached_property
    def _changing(self) -> set[int]:
        """Choices, those in derivatives among them, that change with the parameters alone, or follow from
        one that does.
        """
        graph, nodes = self._all.graph, self._all.lifted_nodes
        own, follows = self._own(nodes), set[int]()
        for node in nodes:
            if node in own or any(argument in follows for argument in arguments_of(graph, node)):
                follows.add(node)
        return {node for node in follows if graph.nodes[node][0] in CHOICES}

    def _own(self, nodes: Iterable[int]) -> set[int]:
        """Choices among nodes, which are in an order of evaluation, that follow from parameters alone."""
        graph = self._all.graph
        alone: dict[
            int, tuple[bool, bool]
        ] = {}  # whether nothing else is behind a node, and whether one moves
        for node in nodes:
            name, *key = graph.nodes[node]
            if name == "input":
                moves = tuple(key) in self._moving
                alone[node] = moves or key[0] in self._constant, moves
            else:
                behind = [alone[argument] for argument in arguments_of(graph, node)]
                alone[node] = all(each for each, _ in behind), any(moves for _, moves in behind)
        return {node for node, both in alone.items() if graph.nodes[node][0] in CHOICES and all(both)}
