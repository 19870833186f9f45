"""What the identifiers of a model of SBML stand for, and what decides each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from contwalk.equations.model import Model
from contwalk.equations.names import usable_name
from contwalk.equations.nodes import Node, name, node


@dataclass
class Symbol:
    """A compartment, a species or a parameter.

    Parameters
    ----------
    identifier : str
    element : object
        Of libsbml.
    line : int
    about : str
        Its name in words.
    value : float, optional
        What its attribute says; of a species see `species_value`.
    constant : bool
    assigned, rate, initial : object, optional
        The element that says what it is at all times, how it changes, or what it begins with.
    moved : bool
        Whether reactions change it.
    set_by_event : bool
    """

    identifier: str
    element: Any
    line: int
    about: str
    value: float | None
    constant: bool
    assigned: Any = None
    rate: Any = None
    initial: Any = None
    moved: bool = False
    set_by_event: bool = False

    @property
    def kind(self) -> str:
        """`compartment`, `parameter` or `species`."""
        return str(self.element.getElementName())

    @property
    def is_point(self) -> bool:
        """Whether it is a compartment without a size."""
        return self.kind == "compartment" and self.element.getSpatialDimensions() == 0

    @property
    def is_fixed(self) -> bool:
        """Whether nothing changes it."""
        return self.assigned is None and self.rate is None and not (self.moved or self.set_by_event)


def each(model: Any, what: str) -> Iterator[Any]:
    """The elements of a list of libsbml's: `Species`, `Reactions`, ..."""
    singular = what if what == "Species" else what.removesuffix("s")
    get = getattr(model, f"get{singular}")
    return (get(i) for i in range(getattr(model, f"getNum{what}")()))


def symbols_of(model: Any) -> dict[str, Symbol]:
    """Compartments, species and parameters by their identifiers, with what acts on them."""
    found: dict[str, Symbol] = {}
    for compartment in each(model, "Compartments"):
        value = compartment.getSize() if compartment.isSetSize() else None
        found[compartment.getId()] = _symbol(compartment, value)
    for parameter in each(model, "Parameters"):
        value = parameter.getValue() if parameter.isSetValue() else None
        found[parameter.getId()] = _symbol(parameter, value)
    for species in each(model, "Species"):
        found[species.getId()] = _symbol(species, None)
    for rule in each(model, "Rules"):
        symbol = found.get(rule.getVariable())
        if symbol is not None and rule.isAssignment():
            symbol.assigned = rule
        elif symbol is not None and rule.isRate():
            symbol.rate = rule
    for given in each(model, "InitialAssignments"):
        if given.getSymbol() in found:
            found[given.getSymbol()].initial = given
    for event in each(model, "Events"):
        for assignment in each(event, "EventAssignments"):
            if assignment.getVariable() in found:
                found[assignment.getVariable()].set_by_event = True
    for reaction in each(model, "Reactions"):
        for reference in (*each(reaction, "Reactants"), *each(reaction, "Products")):
            symbol = found.get(reference.getSpecies())
            if symbol is not None and not (symbol.constant or symbol.element.getBoundaryCondition()):
                symbol.moved = True
    return found


def _symbol(element: Any, value: float | None) -> Symbol:
    about = " ".join((element.getName() or "").split())
    about = "" if about == element.getId() else about
    return Symbol(element.getId(), element, element.getLine(), about, value, element.getConstant())


class Symbols(dict[str, Symbol]):
    """Compartments, species and parameters by their identifiers, and our names for all that has one.

    Parameters
    ----------
    sbml : object
        The model of libsbml.
    model : Model
        Ours, which gets notes.
    """

    def __init__(self, sbml: Any, model: Model) -> None:
        super().__init__(symbols_of(sbml))
        self.model = model
        self.names: dict[str, str | Node] = {}
        self.meant: dict[str, str] = {}  # identifiers by our names
        for what in ("Compartments", "Species", "Parameters", "Reactions", "FunctionDefinitions"):
            for element in each(sbml, what):
                self._named(element, what == "FunctionDefinitions")

    def _named(self, element: Any, function: bool) -> None:
        """Our name for an element: its own, with an underscore where that is taken."""
        identifier = element.getId()
        if not identifier or identifier in self.names:
            what = "has no identifier" if not identifier else f"'{identifier}' is defined again"
            raise self.model.wrong(
                element.getLine(), f"{element.getElementName()} {what}.", "Give it its own."
            )
        own = usable_name(identifier, function)
        while own in self.meant:
            own += "_"
        if own != identifier:
            self.model.notes.append(f"The name {identifier} is taken: it is {own} in the plugin.")
        self.names[identifier], self.meant[own] = own, identifier

    def own(self, symbol: Symbol) -> str:
        """Our name for a symbol."""
        return str(self.names[symbol.identifier])

    def new(self, wanted: str) -> str:
        """A name for what has none in the file."""
        own = usable_name(wanted, False)
        while own in self.meant:
            own += "_"
        self.meant[own] = own
        return own

    def compartment(self, symbol: Symbol) -> Symbol:
        """Where a species is.

        Raises
        ------
        ModelError
        """
        found = self.get(symbol.element.getCompartment())
        if found is None:
            raise self.model.wrong(symbol.line, f"'{symbol.identifier}' is in no compartment.", "Name one.")
        return found

    def is_amount(self, symbol: Symbol) -> bool:
        """Whether the name of a species is its amount."""
        return bool(symbol.element.getHasOnlySubstanceUnits() or self.compartment(symbol).is_point)

    def amount_of(self, symbol: Symbol) -> str | None:
        """The name of a species' amount, where that is the state, or what stays as it is; else None.

        It is of species whose names are concentrations in a compartment that changes.
        """
        if symbol.kind != "species" or self.compartment(symbol).is_fixed:
            return None
        if self.is_amount(symbol) or symbol.rate is not None or symbol.assigned is not None:
            return None
        wanted = f"{self.own(symbol)}_amount"
        if self.meant.get(wanted) is None:
            self.meant[wanted] = wanted
        return wanted

    def state_of(self, symbol: Symbol) -> str:
        """The name of what is in the state vector for a symbol that is."""
        return self.amount_of(symbol) or self.own(symbol)

    def weighed(self, symbol: Symbol) -> Node:
        """The amount of a species in terms of its state."""
        amount = self.amount_of(symbol)
        if amount is not None or self.is_amount(symbol):
            return name(amount or self.own(symbol))
        return node("*", name(self.own(symbol)), name(self.own(self.compartment(symbol))))
