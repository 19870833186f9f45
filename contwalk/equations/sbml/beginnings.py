"""What the names of a model of SBML are at the beginning, as numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contwalk.equations.constant import value_of
from contwalk.equations.model import Model
from contwalk.equations.names import TIME
from contwalk.equations.nodes import ModelError, Node, names_in, node, number, replaced
from contwalk.equations.sbml.symbols import Symbol, Symbols


class Beginnings:
    """Numbers at the beginning.

    Parameters
    ----------
    model : Model
        Ours, with the functions and the rates of reactions.
    symbols : Symbols
    tree : callable
        `tree(element)` is the expression of an element.
    """

    def __init__(self, model: Model, symbols: Symbols, tree: Callable[[Any], Node]) -> None:
        self.model, self.symbols, self.tree = model, symbols, tree
        self.numbers: dict[str, float] = {}
        self.resolving: list[str] = []

    def number(self, identifier: str) -> float | None:
        """What a name is at the beginning; None where nothing says so.

        Raises
        ------
        ModelError
            If it is defined by itself, or cannot be computed.
        """
        if identifier in self.numbers:
            return self.numbers[identifier]
        symbol = self.symbols[identifier]
        if identifier in self.resolving:
            raise self._circle(symbol.line, identifier)
        self.resolving.append(identifier)
        given = symbol.initial if symbol.initial is not None else symbol.assigned
        found = self.computed(self.tree(given), given.getLine()) if given is not None else symbol.value
        if found is None and symbol.kind == "species":
            found = self._species_number(symbol)
        if found is None and symbol.kind == "compartment":
            self.model.notes.append(f"The compartment '{identifier}' has no size: it is 1.")
            found = 1.0
        self.resolving.pop()
        if found is not None:
            self.numbers[identifier] = found
        return found

    def _species_number(self, symbol: Symbol) -> float | None:
        species = symbol.element
        if species.isSetInitialAmount() and self.symbols.is_amount(symbol):
            return float(species.getInitialAmount())
        if species.isSetInitialConcentration() and not self.symbols.is_amount(symbol):
            return float(species.getInitialConcentration())
        if species.isSetInitialAmount():
            return float(species.getInitialAmount()) / self.size(symbol)
        if species.isSetInitialConcentration():
            return float(species.getInitialConcentration()) * self.size(symbol)
        return None

    def _circle(self, line: int, what: str) -> ModelError:
        return self.model.wrong(line, f"'{what}' begins with what it is itself.", "Give it a number.")

    def size(self, symbol: Symbol) -> float:
        """The size of the compartment that a species is in.

        Raises
        ------
        ModelError
        """
        place = self.symbols.compartment(symbol)
        size = self.number(place.identifier)
        if not size:
            raise self.model.wrong(place.line, f"'{place.identifier}' has the size 0.", "Give another one.")
        return size

    def computed(self, root: Node, line: int) -> float:
        """The value of an expression at the beginning.

        Raises
        ------
        ModelError
        """
        values: dict[str, Node] = {TIME: number(0.0)}
        for own in names_in(root) - {TIME, "pi"}:
            known = self.model.parameters.get(own)
            identifier = self.symbols.meant.get(own, own)
            value = known.value if known is not None else None
            if value is None and own in self.model.quantities:
                value = self._rate(own, line)
            if value is None and identifier in self.symbols:
                value = self.number(identifier)
            if value is None:
                raise self.model.wrong(line, f"'{identifier}' has no value at the beginning.", "Give one.")
            values[own] = number(value)
        try:
            return value_of(self._inlined(replaced(root, values)))
        except ModelError as error:
            raise self.model.told(line, error) from None

    def _rate(self, reaction: str, line: int) -> float:
        if reaction in self.resolving:
            raise self._circle(line, reaction)
        self.resolving.append(reaction)
        found = self.computed(self.model.quantities[reaction].value, line)
        self.resolving.pop()
        return found

    def _inlined(self, root: Node, depth: int = 0) -> Node:
        """An expression without calls of the model's own functions."""
        parts = [self._inlined(part, depth) for part in root.parts]
        function = self.model.functions.get(str(root.value)) if root.kind == "call" else None
        if function is None:
            return node(root.kind, *parts, value=root.value) if parts else root
        if len(parts) != len(function.arguments) or depth > len(self.model.functions):
            raise ModelError(f"{root.value} cannot be computed.", "Check its arguments.")
        given = dict(zip(function.arguments, parts, strict=True))
        return self._inlined(replaced(function.body, given), depth + 1)

    def begins(self, symbol: Symbol) -> float | None:
        """What a state begins with."""
        value = self.number(symbol.identifier)
        if value is None or self.symbols.amount_of(symbol) is None:
            return value
        return value * self.size(symbol)
