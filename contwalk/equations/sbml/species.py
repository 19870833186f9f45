"""Equations of the species that reactions change, and the sums that reactions keep."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import NamedTuple

from contwalk.equations.model import Defined, Model
from contwalk.equations.nodes import Node, name, node, number
from contwalk.equations.sbml.beginnings import Beginnings
from contwalk.equations.sbml.conserved import dependent_rows, without_differences
from contwalk.equations.sbml.declaring import add_parameter, add_state
from contwalk.equations.sbml.symbols import Symbol, Symbols


class Change(NamedTuple):
    """What a reaction adds to an amount: `factor` times its rate; a number, or an expression."""

    reaction: str
    factor: Fraction | Node
    line: int


class Species:
    """The species that reactions change, put into a model.

    Parameters
    ----------
    model : Model
        Ours.
    symbols : Symbols
    beginnings : Beginnings
    changes : dict
        Of each species by its identifier.
    conversion : str
        The identifier of the model's conversion factor, or nothing.
    """

    def __init__(
        self,
        model: Model,
        symbols: Symbols,
        beginnings: Beginnings,
        changes: dict[str, list[Change]],
        conversion: str,
    ) -> None:
        self.model, self.symbols, self.beginnings = model, symbols, beginnings
        self.changes, self._conversion = changes, conversion

    def add(self) -> None:
        """Add their equations, and quantities for those that sums determine."""
        moved = [symbol for symbol in self.symbols.values() if symbol.moved]
        dependent = self._sums(moved)
        for symbol in moved:
            if symbol.identifier in dependent:
                self._add_held(symbol, dependent[symbol.identifier])
            else:
                self._add_state(symbol)

    def _add_state(self, symbol: Symbol) -> None:
        own, symbols = self.symbols.state_of(symbol), self.symbols
        rate = added((factor, name(reaction)) for factor, reaction in self._terms(symbol))
        conversion = self._conversion_of(symbol)
        if conversion:
            rate = node("*", name(str(symbols.names.get(conversion, conversion))), rate)
        if own == symbols.own(symbol) and not symbols.is_amount(symbol):
            rate = node("/", rate, name(symbols.own(symbols.compartment(symbol))))
        line = self.changes[symbol.identifier][0].line
        add_state(self.model, own, Defined(rate, line, symbol.about), self.beginnings.begins(symbol))

    def _conversion_of(self, symbol: Symbol) -> str:
        return str(symbol.element.getConversionFactor() or self._conversion)

    def _terms(self, symbol: Symbol) -> Iterator[tuple[Fraction | Node, str]]:
        """Factor and reaction of each term of a rate; what a reaction takes and gives is one term."""
        changes = self.changes[symbol.identifier]
        for reaction in dict.fromkeys(change.reaction for change in changes):
            of = [change.factor for change in changes if change.reaction == reaction]
            whole = sum((factor for factor in of if isinstance(factor, Fraction)), Fraction(0))
            if whole:
                yield whole, reaction
            for factor in of:
                if isinstance(factor, Node):
                    yield factor, reaction

    def _sums(self, moved: list[Symbol]) -> dict[str, dict[str, Fraction]]:
        """Species that are a combination of others and of what stays as it is, with the others' factors."""
        known = [symbol for symbol in moved if not self._varies(symbol)]
        terms = [{reaction: factor for factor, reaction in self._terms(symbol)} for symbol in known]
        reactions = list(dict.fromkeys(reaction for row in terms for reaction in row))
        rows = [[row.get(reaction, Fraction(0)) for reaction in reactions] for row in terms]
        found = without_differences(dependent_rows(rows))  # type: ignore[arg-type]  # numbers alone
        return {
            known[i].identifier: {known[j].identifier: factor for j, factor in sorted(factors.items())}
            for i, factors in found.items()
        }

    def _varies(self, symbol: Symbol) -> bool:
        """Whether more than fixed numbers of reactions change an amount."""
        factors = [change.factor for change in self.changes[symbol.identifier]]
        varied = symbol.set_by_event or bool(self._conversion_of(symbol))
        return varied or any(isinstance(factor, Node) for factor in factors)

    def _add_held(self, symbol: Symbol, factors: dict[str, Fraction]) -> None:
        """A species as what a sum leaves of it."""
        symbols, own = self.symbols, self.symbols.state_of(symbol)
        if not factors:
            add_parameter(self.model, own, self._begins(symbol), symbol.line, symbol.about)
            return
        others = [symbols[other] for other in factors]
        every = [symbol, *others]
        # In one compartment that stays as it is, the sum of concentrations does so too.
        alike = len({symbols.compartment(one).identifier for one in every}) == 1
        alike = alike and len({symbols.weighed(one).kind for one in every}) == 1
        names = [name(symbols.state_of(one)) if alike else symbols.weighed(one) for one in every]
        pairs = zip(names, every, strict=True)
        sizes = [1.0 if each.kind == "name" else self.beginnings.size(one) for each, one in pairs]
        begins = [size * self._begins(one) for size, one in zip(sizes, every, strict=True)]
        total = symbols.new(f"{own}_total")
        value = begins[0] - sum(float(f) * at for f, at in zip(factors.values(), begins[1:], strict=True))
        add_parameter(self.model, total, value, symbol.line, f"what {own} is a part of")
        terms = list(zip(factors.values(), names[1:], strict=True))
        tree = added([(Fraction(1), name(total)), *terms])
        if names[0].kind != "name":
            tree = node("/", tree, names[0].parts[1])
        self.model.quantities[own] = Defined(tree, symbol.line)
        self.model.shown.add(own)
        words = ", ".join(symbols.state_of(one) for one in every)
        self.model.notes.append(f"A sum of {words} is conserved: it is the parameter {total}.")

    def _begins(self, symbol: Symbol) -> float:
        value = self.beginnings.begins(symbol)
        if value is None:
            self.model.notes.append(f"'{symbol.identifier}' has no value at the beginning: it is 0.")
        return value or 0.0


def added(terms: Iterable[tuple[Fraction | Node, Node]]) -> Node:
    """A sum of products, written as on paper."""
    found: Node | None = None
    for factor, part in terms:
        minus = factor < 0 if isinstance(factor, Fraction) else factor.kind == "negative"
        if isinstance(factor, Fraction):
            size = abs(factor)
            whole = part if size == 1 else node("*", number(float(size)), part)
        else:
            whole = node("*", factor.parts[0] if minus else factor, part)
        if found is None:
            found = node("negative", whole) if minus else whole
        else:
            found = node("-" if minus else "+", found, whole)
    return number(0.0) if found is None else found
