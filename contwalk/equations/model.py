"""A model that has been read: what it defines by name, and on which lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from contwalk.equations.nodes import ModelError, Node


@dataclass(frozen=True)
class Defined:
    """A name's expression, the line it stands on, and what is said of it there."""

    value: Node
    line: int
    about: str = ""


@dataclass(frozen=True)
class Value:
    """A name's number, its line, and what is said of it."""

    value: float
    line: int
    about: str = ""


@dataclass(frozen=True)
class Function:
    """A function of a model: `name(arguments) = body`."""

    arguments: tuple[str, ...]
    body: Node
    line: int


@dataclass(frozen=True)
class Table:
    """A function by its values at places in between which it is linear, and beyond which it goes on so."""

    places: tuple[float, ...]
    values: tuple[float, ...]
    line: int


@dataclass(frozen=True)
class Event:
    """Where `guard` passes zero, falling or rising, some states become what `resets` say."""

    guard: Node
    direction: str
    resets: Mapping[str, Node]
    line: int


@dataclass
class Model:
    """What a text defines.

    Parameters
    ----------
    source : str
        What the text is called in messages: a file, or `the equations`.
    rates : dict
        Each state's rate, of a map its next value.
    parameters, starts : dict
    quantities : dict
        Expressions with names of their own, which others may use.
    shown : set of str
        Of these, those that are results for themselves.
    functions, tables, events : dict
    period : Defined, optional
        Of a forced system.
    is_map : bool
    about : str
    reference : str
        Where the model comes from.
    presets : dict
        Named sets of parameters.
    study : tuple of (str, tuple of float), optional
        A parameter along which something happens, with a range.
    until : float, optional
        How long simulations are to last.
    notes : list of str
        What was left out of it, and what the user had better know.
    """

    source: str
    rates: dict[str, Defined] = field(default_factory=dict)
    parameters: dict[str, Value] = field(default_factory=dict)
    starts: dict[str, Value] = field(default_factory=dict)
    quantities: dict[str, Defined] = field(default_factory=dict)
    shown: set[str] = field(default_factory=set)
    functions: dict[str, Function] = field(default_factory=dict)
    tables: dict[str, Table] = field(default_factory=dict)
    events: dict[str, Event] = field(default_factory=dict)
    period: Defined | None = None
    is_map: bool = False
    about: str = ""
    reference: str = ""
    presets: dict[str, dict[str, float]] = field(default_factory=dict)
    study: tuple[str, tuple[float, float]] | None = None
    until: float | None = None
    notes: list[str] = field(default_factory=list)

    def wrong(self, line: int, what: str, remedy: str = "") -> ModelError:
        """A sentence on a line of the text."""
        return ModelError(f"{self.source}, line {line}: {what}", remedy)

    def told(self, line: int, error: ModelError) -> ModelError:
        """An error of an expression with its place put in front."""
        return self.wrong(line, error.sentence, error.remedy)

    def lines(self) -> Iterator[tuple[str, str, int]]:
        """Kind, name and line of all that is defined, in the order of kinds."""
        kinds: tuple[tuple[str, Mapping[str, Defined | Value | Function | Table]], ...] = (
            ("state", self.rates),
            ("parameter", self.parameters),
            ("quantity", self.quantities),
            ("function", self.functions),
            ("table", self.tables),
        )
        for kind, entries in kinds:
            for name, entry in entries.items():
                yield kind, name, entry.line

    def expressions(self) -> Iterator[tuple[Node, int, tuple[str, ...]]]:
        """Each expression with its line, and the arguments that are names in it alone."""
        for entry in (*self.rates.values(), *self.quantities.values()):
            yield entry.value, entry.line, ()
        for function in self.functions.values():
            yield function.body, function.line, function.arguments
        for event in self.events.values():
            yield event.guard, event.line, ()
            for value in event.resets.values():
                yield value, event.line, ()
        if self.period is not None:
            yield self.period.value, self.period.line, ()
