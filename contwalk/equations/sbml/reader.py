"""SBML's levels 2 and 3: compartments, species, reactions, rules, functions, initial assignments, events.

The name of a species is its concentration, or its amount where it has only substance units, as SBML says. Of
a species that reactions change in a compartment that changes itself the state is the amount. Amounts that are
a sum of others and of what stays as it is are quantities, and the sum is a parameter.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from contwalk.equations.forcing import period_of
from contwalk.equations.model import Defined, Event, Function, Model
from contwalk.equations.names import usable_name
from contwalk.equations.nodes import ModelError, Node, name, names_in, node, number
from contwalk.equations.sbml.beginnings import Beginnings
from contwalk.equations.sbml.declaring import add_parameter, add_state
from contwalk.equations.sbml.document import document_of, library
from contwalk.equations.sbml.mathematics import Mathematics
from contwalk.equations.sbml.species import Change, Species
from contwalk.equations.sbml.symbols import Symbol, Symbols, each
from contwalk.equations.sbml.triggers import guard_of


def model_of_sbml(text: str, source: str) -> Model:
    """The model of a text of SBML.

    Parameters
    ----------
    text : str
    source : str
        The file, as messages name it.

    Raises
    ------
    ModelError
        With the line of what cannot be translated, or where python-libsbml is not installed.
    """
    document = document_of(text, source)  # owns what it gives
    return _Reader(document.getModel(), source).model


class _Reader:
    def __init__(self, sbml: Any, source: str) -> None:
        self.sbml, about = sbml, sbml.getName() or sbml.getId()
        self.model = Model(source, about=" ".join(about.split()))
        self.symbols = Symbols(sbml, self.model)
        self.changes: dict[str, list[Change]] = {}
        self._refuse()
        self.mathematics = Mathematics(library(), self.symbols.names)
        self.beginnings = Beginnings(self.model, self.symbols, self._tree)
        self._functions()
        self._reactions()
        self._values()
        Species(self.model, self.symbols, self.beginnings, self.changes, sbml.getConversionFactor()).add()
        self._events()
        if self.model.rates:
            self.model.period = period_of(self.model)

    # What is refused.

    def _refuse(self) -> None:
        wrong = self.model.wrong
        for rule in each(self.sbml, "Rules"):
            line = rule.getLine()
            if rule.isAlgebraic():
                raise wrong(line, "an algebraic rule is solved at each instant.", "Write what it gives.")
            self._check_set(rule, rule.getVariable(), "rule")
        for reaction in each(self.sbml, "Reactions"):
            line = reaction.getLine()
            if reaction.isSetFast() and reaction.getFast():
                raise wrong(line, "a fast reaction is solved at each instant.", "Give it a rate.")
            if reaction.getKineticLaw() is None or reaction.getKineticLaw().getMath() is None:
                raise wrong(line, f"the reaction '{reaction.getId()}' has no rate.", "Give it a kinetic law.")
        for event in each(self.sbml, "Events"):
            if event.isSetDelay():
                raise wrong(
                    event.getDelay().getLine(), "an event acts after a delay.", "Leave the delay out."
                )
            if event.getTrigger() is None or event.getTrigger().getMath() is None:
                raise wrong(event.getLine(), "an event has no trigger.", "Give it one.")
            if event.isSetPriority():
                self._note(event, "the priority of the event is left out: events of an instant act in order")
            for assignment in each(event, "EventAssignments"):
                self._check_set(assignment, assignment.getVariable(), "event")
        for given in each(self.sbml, "InitialAssignments"):
            if given.getSymbol() not in self.symbols:
                raise wrong(given.getLine(), f"'{given.getSymbol()}' cannot be set.", "Check its name.")
        for constraint in each(self.sbml, "Constraints"):
            self._note(constraint, "the constraint is left out")

    def _check_set(self, element: Any, identifier: str, by: str) -> None:
        """Refuse a rule or an event for what is constant, is no name, or is set by something else."""
        symbol, why = self.symbols.get(identifier), ""
        if symbol is None:
            why = "is no compartment, species or parameter"
        elif symbol.constant:
            why = "is constant"
        elif symbol.moved and by == "rule":
            why = "is changed by reactions"
        elif symbol.assigned is not None and (by == "event" or symbol.rate is not None):
            why = "is set by a rule"
        if why:
            raise self.model.wrong(
                element.getLine(), f"the {by} sets '{identifier}', which {why}.", "Keep one of both."
            )

    def _note(self, element: Any, what: str) -> None:
        note = f"{self.model.source}, line {element.getLine()}: {what}."
        if note not in self.model.notes:
            self.model.notes.append(note)

    def _tree(self, element: Any, local: dict[str, str | Node] | None = None) -> Node:
        """The expression of an element, errors with its line."""
        if element.getMath() is None:
            raise self.model.wrong(element.getLine(), "an expression is missing.", "Give one.")
        try:
            return self.mathematics.tree(element.getMath(), local)
        except ModelError as error:
            raise self.model.told(element.getLine(), error) from None

    def _functions(self) -> None:
        for function in each(self.sbml, "FunctionDefinitions"):
            given = [function.getArgument(i).getName() for i in range(function.getNumArguments())]
            arguments: dict[str, str | Node] = {each_: usable_name(each_, False) for each_ in given}
            if function.getBody() is None or not given:
                raise self.model.wrong(function.getLine(), "a function has no arguments or no body.", "")
            try:
                body = self.mathematics.tree(function.getBody(), arguments)
            except ModelError as error:
                raise self.model.told(function.getLine(), error) from None
            own = str(self.symbols.names[function.getId()])
            self.model.functions[own] = Function(
                tuple(map(str, arguments.values())), body, function.getLine()
            )

    # Reactions: their rates are quantities, and what they change is kept for the species' equations.

    def _reactions(self) -> None:
        reactions = list(each(self.sbml, "Reactions"))
        for reaction in reactions:
            for sign, what in ((-1, "Reactants"), (1, "Products")):
                for reference in each(reaction, what):
                    self._changed(str(self.symbols.names[reaction.getId()]), sign, reference)
        local_names = [parameter.getId() for r in reactions for parameter in _local(r.getKineticLaw())]
        for reaction in reactions:
            local: dict[str, str | Node] = {}
            for parameter in _local(reaction.getKineticLaw()):
                identifier = parameter.getId()
                alone = local_names.count(identifier) == 1 and identifier not in self.symbols.names
                own = self.symbols.new(identifier if alone else f"{reaction.getId()}_{identifier}")
                local[identifier] = own
                value = parameter.getValue() if parameter.isSetValue() else None
                add_parameter(self.model, own, value, parameter.getLine(), parameter.getName())
            law = self._tree(reaction.getKineticLaw(), local)
            own = str(self.symbols.names[reaction.getId()])
            self.model.quantities[own] = Defined(law, reaction.getKineticLaw().getLine())

    def _changed(self, reaction: str, sign: int, reference: Any) -> None:
        """Note what a reaction adds to a species."""
        line, wrong = reference.getLine(), self.model.wrong
        symbol, identifier = self.symbols.get(reference.getSpecies()), reference.getId()
        if symbol is None or symbol.kind != "species":
            raise wrong(line, f"'{reference.getSpecies()}' is no species.", "Check its name.")
        factor: Fraction | Node = Fraction(1)
        if reference.isSetStoichiometryMath():
            factor = self._tree(reference.getStoichiometryMath())
        elif reference.isSetStoichiometry():
            try:
                factor = Fraction(repr(reference.getStoichiometry()))
            except ValueError:
                raise wrong(line, "the stoichiometry is no finite number.", "Give one.") from None
        if identifier:
            constant = number(float(factor)) if isinstance(factor, Fraction) else factor
            self.symbols.names[identifier] = constant
        if symbol.moved:
            signed = factor * sign if isinstance(factor, Fraction) else factor
            signed = node("negative", signed) if isinstance(signed, Node) and sign < 0 else signed
            self.changes.setdefault(symbol.identifier, []).append(Change(reaction, signed, line))

    # Parameters, quantities, and states by rules.

    def _values(self) -> None:
        for symbol in self.symbols.values():
            own, about = self.symbols.own(symbol), symbol.about
            if symbol.assigned is not None:
                given = symbol.assigned
                self.model.quantities[own] = Defined(self._tree(given), given.getLine(), about)
                self.model.shown.add(own)
                continue
            if symbol.rate is not None:
                rate = Defined(self._tree(symbol.rate), symbol.rate.getLine(), about)
                add_state(self.model, own, rate, self.beginnings.number(symbol.identifier))
                continue
            amount = self.symbols.amount_of(symbol)
            if amount is not None:
                place = name(self.symbols.own(self.symbols.compartment(symbol)))
                self.model.quantities[own] = Defined(node("/", name(amount), place), symbol.line)
                self.model.shown.add(own)
            if symbol.set_by_event and not symbol.moved:
                rate = Defined(number(0.0), symbol.line, about)
                add_state(self.model, amount or own, rate, self.beginnings.begins(symbol))
            elif amount is not None and not symbol.moved:
                add_parameter(self.model, amount, self.beginnings.begins(symbol), symbol.line, about)
            elif not (symbol.moved or symbol.is_point):
                self._fixed(symbol)

    def _fixed(self, symbol: Symbol) -> None:
        """What nothing changes: a parameter, or what is computed of parameters."""
        own, given = self.symbols.own(symbol), symbol.initial
        if given is not None:
            value = self._tree(given)
            fixed = {self.symbols.own(other) for other in self.symbols.values() if other.is_fixed}
            if names_in(value) - {"pi"} <= fixed and names_in(value) & fixed:
                self.model.quantities[own] = Defined(value, given.getLine(), symbol.about)
                return
            if names_in(value) - {"pi"}:
                self._note(given, f"'{own}' is the number that this is at the beginning")
        add_parameter(self.model, own, self.beginnings.number(symbol.identifier), symbol.line, symbol.about)

    # Events.

    def _events(self) -> None:
        for k, event in enumerate(each(self.sbml, "Events"), 1):
            line, resets = event.getLine(), {}
            trigger = event.getTrigger()
            try:
                guard, direction = guard_of(self._tree(trigger))
            except ModelError as error:
                told = error.sentence.startswith(self.model.source)
                raise error if told else self.model.told(trigger.getLine(), error) from None
            for assignment in each(event, "EventAssignments"):
                resets[assignment.getVariable()] = self._tree(assignment)
            targets: dict[str, Node] = {}
            for identifier, value in resets.items():
                symbol = self.symbols[identifier]
                if self.symbols.amount_of(symbol) is not None:
                    place = self.symbols.compartment(symbol)
                    size = resets.get(place.identifier, name(self.symbols.own(place)))
                    value = node("*", value, size)
                targets[self.symbols.state_of(symbol)] = value
            own = self.symbols.new(event.getId() or f"event_{k}")
            self.model.events[own] = Event(guard, direction, targets, line)


def _local(law: Any) -> list[Any]:
    """The parameters of a reaction alone, of level 3 or of level 2."""
    return [*each(law, "LocalParameters")] or [*each(law, "Parameters")]
