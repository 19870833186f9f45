"""Equations as text: one a line or between semicolons, as on paper.

`x' = ...` or `dx/dt = ...`, `a = 1.2` a parameter, `x(0) = 1` a start, `name = ...` an auxiliary quantity,
`f(u) = ...` a function, `period = ...`, `event NAME: g falls, v = -r * v`, and `x+ = ...` of a map. What
stands behind a # is a comment; behind a definition it says what that is.
"""

from __future__ import annotations

from collections.abc import Iterator

from contwalk.equations.constant import is_constant, value_of
from contwalk.equations.grammar import Parser
from contwalk.equations.model import Defined, Event, Function, Model, Value
from contwalk.equations.nodes import ModelError, Node
from contwalk.equations.tokens import tokens

LARGEST = {"characters": 256 * 1024}
_KINDS = {"falls": "falling", "rises": "rising"}


def model_of_text(text: str, source: str = "the equations") -> Model:
    """The model that a text of equations defines.

    Parameters
    ----------
    text : str
    source : str
        What messages call the text.

    Raises
    ------
    ModelError
        With the line.
    """
    require_size(text, source)
    model = Model(source, about=_title(text))
    kinds: dict[str, int] = {}
    for line, statement, comment in _statements(text):
        try:
            _Statement(model, line, comment, kinds).read(statement)
        except ModelError as error:
            raise error if error.sentence.startswith(source) else model.told(line, error) from None
    model.is_map = "map" in kinds
    if len(kinds) > 1:
        raise model.wrong(
            max(kinds.values()),
            f"this equation is of another kind than that on line {min(kinds.values())}.",
            "All states have x' = rates, or all have x+ = next values.",
        )
    model.shown = set(model.quantities)
    return model


def require_size(text: str, source: str) -> None:
    """Refuse a text that is no model but something else.

    Raises
    ------
    ModelError
    """
    if len(text) > LARGEST["characters"]:
        raise ModelError(
            f"{source} has {len(text)} characters.",
            f"At most {LARGEST['characters']} are read; is it a text of equations?",
        )


def _title(text: str) -> str:
    """What a text begins with, where that is a comment."""
    first = text.lstrip().partition("\n")[0]
    return " ".join(first.lstrip("#").split()) if first.startswith("#") else ""


def _statements(text: str) -> Iterator[tuple[int, str, str]]:
    """Line, text and comment of each statement; a comment belongs to one that is alone on its line."""
    for number, whole in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        line, _, comment = whole.partition("#")
        found = [part for part in line.split(";") if part.strip()]
        for part in found:
            yield number, part, " ".join(comment.split()) if len(found) == 1 else ""


class _Statement:
    """Reads one statement into a model."""

    def __init__(self, model: Model, line: int, about: str, kinds: dict[str, int]) -> None:
        self.model, self.line, self.about, self.kinds = model, line, about, kinds

    def read(self, text: str) -> None:
        """What the statement defines."""
        parser = self.parser = Parser(tokens(text))
        if parser.next.text == "event" and not (parser.seen("event", "=") or parser.seen("event", "'")):
            self._event()
            return
        name = parser.take_name()
        if parser.took("'"):
            if parser.seen("'"):
                raise parser.wrong(
                    "a second derivative stands on the left", f"Give the first a name: {name}' = v; v' = ..."
                )
            self._equation(name, "flow")
        elif name[0] == "d" and len(name) > 1 and parser.seen("/", "dt"):
            parser.need("/", "A rate is written x' = ... or dx/dt = ...")
            parser.need("dt", "A rate is written x' = ... or dx/dt = ...")
            self._equation(name[1:], "flow")
        elif parser.seen("+", "="):
            parser.took("+")
            self._equation(name, "map")
        elif parser.took("("):
            self._start(name) if parser.next.kind == "number" else self._function(name)
        else:
            self._value(name)

    def _right(self) -> Node:
        """The expression behind the sign of equality, up to the end."""
        self.parser.need("=", "An equation is written x' = ..., a parameter a = 1.0.")
        found = self.parser.expression()
        self.parser.end()
        return found

    def _equation(self, name: str, kind: str) -> None:
        value = self._right()
        self._once(name, self.model.rates)
        self.kinds.setdefault(kind, self.line)
        self.model.rates[name] = Defined(value, self.line, self.about)

    def _start(self, name: str) -> None:
        if float(self.parser.next.text) != 0.0:
            raise self.parser.wrong("a start is at time 0", f"Write {name}(0) = number.")
        self.parser.took(self.parser.next.text)
        self.parser.need(")", f"Write {name}(0) = number.")
        value = self._right()
        if not is_constant(value):
            raise self.model.wrong(self.line, f"the start of {name} is no number.", f"As in {name}(0) = 1.0.")
        self._once(name, self.model.starts)
        self.model.starts[name] = Value(value_of(value), self.line, self.about)

    def _function(self, name: str) -> None:
        arguments = [self.parser.take_name()]
        while self.parser.took(","):
            arguments.append(self.parser.take_name())
        self.parser.need(")", f"A function is written {name}(u) = ..., with names as arguments.")
        body = self._right()
        self._once(name, self.model.functions)
        self.model.functions[name] = Function(tuple(arguments), body, self.line)

    def _value(self, name: str) -> None:
        value = self._right()
        if name == "period":
            if self.model.period is not None:
                raise self.model.wrong(self.line, "the period is given twice.", "Give it once.")
            self.model.period = Defined(value, self.line, self.about)
        elif is_constant(value):
            self._once(name, self.model.parameters)
            self.model.parameters[name] = Value(value_of(value), self.line, self.about)
        else:
            self._once(name, self.model.quantities)
            self.model.quantities[name] = Defined(value, self.line, self.about)

    def _event(self) -> None:
        parser, form = self.parser, "As in: event hit: x falls, v = -r * v"
        parser.took("event")
        name = parser.take_name()
        parser.need(":", form)
        guard = parser.expression()
        direction = _KINDS.get(parser.next.text)
        if direction is None:
            raise parser.wrong(f"{parser.next} stands where 'falls' or 'rises' must", form)
        parser.took(parser.next.text)
        resets: dict[str, Node] = {}
        while parser.took(","):
            state = parser.take_name()
            parser.need("=", form)
            if state in resets:
                raise parser.wrong(f"the event sets {state} twice", "Set it once.")
            resets[state] = parser.expression()
        parser.end()
        self._once(name, self.model.events)
        self.model.events[name] = Event(guard, direction, resets, self.line)

    def _once(self, name: str, entries: dict) -> None:
        if name in entries:
            raise self.model.wrong(
                self.line,
                f"'{name}' is defined again; it is on line {entries[name].line} already.",
                "Remove one of the lines.",
            )
