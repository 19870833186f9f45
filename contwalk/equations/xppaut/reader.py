"""XPPAUT's .ode files: equations, parameters, functions, tables, auxiliary and fixed quantities, events.

Upper and lower case are one there, operators bind otherwise than on paper (comparisons as tightly as powers,
a row of powers from the left), and an event sets one state after the other.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from contwalk.equations.constant import is_constant, value_of
from contwalk.equations.forcing import period_of
from contwalk.equations.grammar import Parser, Precedence
from contwalk.equations.model import Defined, Event, Function, Model, Value
from contwalk.equations.names import TIME, needs, usable_name
from contwalk.equations.nodes import RELATIONS, ModelError, Node, calls_in, replaced
from contwalk.equations.text import require_size
from contwalk.equations.tokens import Token, tokens
from contwalk.equations.xppaut.lines import Line, lines_of
from contwalk.equations.xppaut.options import Options, assignments, number_of
from contwalk.equations.xppaut.tables import table_of_file, table_of_formula

_ARITHMETIC = {"+": 4, "-": 4, "*": 6, "/": 6, "^": 7}
OWN = Precedence(_ARITHMETIC | dict.fromkeys(RELATIONS, 7) | {"and": 6, "or": 4}, 7, 7)
# What begins a line, by its first letters, and why it cannot be translated.
_REFUSED = {
    "markov": "a Markov variable jumps by chance",
    "wiener": "a Wiener process moves by chance",
    "volterra": "an integral equation depends on all that was before",
    "special": "a network of convolutions is not translated",
    "solv": "an algebraic equation is solved at each step",
    "solve": "an algebraic equation is solved at each step",
    "export": "a compiled library is called",
    "vector": "a vector is not translated",
    "include": "another file is read",
}
_FUNCTIONS_REFUSED = {
    "delay": "the past of a state",
    "del_shft": "the past of a state",
    "ran": "a random number",
    "normal": "a random number",
    "poisson": "a random number",
    "besselj": "a Bessel function",
    "bessely": "a Bessel function",
    "besseli": "a Bessel function",
    "shift": "a state by its number",
    "ishift": "a state by its number",
    "sum": "a sum over states by their numbers",
    "set": "a state by its number",
    "int": "an integral over all that was before",
    "hom_bcs": "a boundary condition of AUTO",
}
_CALLED = re.compile(r"\b([^\W\d]\w*)\s*[({[]")
_RENAMED = {"flr": "floor"}
_EVENT_WORDS = ("out_put", "arret")


def model_of_ode(text: str, source: str, folder: Path | None = None) -> Model:
    """The model of an .ode file.

    Parameters
    ----------
    text : str
    source : str
        The file, as messages name it.
    folder : Path, optional
        Where the files of its tables are.

    Raises
    ------
    ModelError
        With the line of what cannot be translated.
    """
    require_size(text, source)
    return _Reader(text, source, folder).model


class _Reader:
    def __init__(self, text: str, source: str, folder: Path | None) -> None:
        self.model = Model(source, about=_title(text))
        self.folder, self.options = folder, Options()
        self.lines = list(lines_of(text, self.model.wrong))
        # How often a name stands before a parenthesis: once where x(t) = ... is an integral equation.
        self.calls = Counter(name.lower() for line in self.lines for name in _CALLED.findall(line.text))
        self.spelled: dict[str, str] = {}
        self.auxiliary: list[tuple[str, Line, Node]] = []
        self.kinds: dict[str, int] = {}
        for line in self.lines:
            self._spell(line)
        for line in self.lines:
            try:
                self._read(line)
            except ModelError as error:
                told = error.sentence.startswith(source)
                raise error if told else self.model.told(line.number, error) from None
        self._finish()

    # Names: the spelling of their definition, and another one where it is taken.

    def _spell(self, line: Line) -> None:
        """Note how the names that a line defines are spelled."""
        word, rest = _keyword(line)
        function = word == "table"
        if word in ("par", "number"):
            names = re.findall(r"([^\W\d]\w*)\s*(?:=[^\s,]*|[\s,]|$)", rest)
        elif word in ("table", "!"):
            names = re.findall(r"^\s*([^\W\d]\w*)", rest)
        elif word:
            names = []
        else:
            match = re.match(r"(?i)d([^\W\d]\w*)\s*/\s*dt\s*=|([^\W\d]\w*)\s*([(='])", line.text)
            names = [match.group(1) or match.group(2)] if match else []
            function = match is not None and match.group(3) == "(" and not re.match(r"\w+\(t\+", line.text)
        for name in names:
            own = self.spelled.setdefault(name.lower(), usable_name(name, function))
            if own != name and own.rstrip("_") == name:
                self._note(f"The name {name} is taken: it is {own} in the plugin.")

    def _note(self, text: str) -> None:
        if text not in self.model.notes:
            self.model.notes.append(text)

    def _folded(self, token: Token) -> Token:
        if token.kind != "name":
            return token
        lower = token.text.lower()
        return replace(token, text=self.spelled.get(lower, _RENAMED.get(lower, lower)))

    def parser(self, text: str) -> Parser:
        return Parser([self._folded(token) for token in tokens(text)], OWN)

    def expression(self, text: str, line: Line) -> Node:
        for call in _CALLED.findall(text):
            name = call.lower()
            if name in _FUNCTIONS_REFUSED and name not in self.spelled:
                raise self.model.wrong(
                    line.number, f"{name}(...) is {_FUNCTIONS_REFUSED[name]}.", "It cannot be translated."
                )
        parser = self.parser(text)
        found = parser.expression()
        parser.end()
        return found

    # Lines.

    def _read(self, line: Line) -> None:
        word, rest = _keyword(line)
        if word in _REFUSED:
            raise self.model.wrong(line.number, f"{_REFUSED[word]}.", "It cannot be translated.")
        handlers: dict[str, Callable[[str, Line], None]] = {
            "par": self._parameters,
            "number": self._parameters,
            "init": self._starts,
            "aux": self._aux,
            "table": self._table,
            "global": self._event,
            "set": self._preset,
            "@": self._options,
            "!": self._statement,
            "only": self._left_out,
            "bndry": self._left_out,
            "options": self._left_out,
        }
        if word:
            handlers[word](rest, line)
        else:
            self._statement(line.text, line)

    def _left_out(self, rest: str, line: Line) -> None:
        self._note(f"{self.model.source}, line {line.number}: '{line.text[:60]}' is left out.")

    def _assigned(self, rest: str, line: Line) -> list[tuple[str, float]]:
        found = assignments(rest, lambda what, remedy: self.model.wrong(line.number, what, remedy))
        return [(self.spelled.get(name.lower(), name), value) for name, value in found]

    def _parameters(self, rest: str, line: Line) -> None:
        for name, value in self._assigned(rest, line):
            self._once(name, self.model.parameters, line)
            self.model.parameters[name] = Value(value, line.number)

    def _starts(self, rest: str, line: Line) -> None:
        for name, value in self._assigned(rest, line):
            self.model.starts[name] = Value(value, line.number)

    def _aux(self, rest: str, line: Line) -> None:
        match = re.fullmatch(r"\s*([^\W\d][\w.]*)\s*=(.*)", rest)
        if match is None:
            raise self.model.wrong(line.number, "the quantity has no expression.", "As in aux y=x^2")
        name, right = re.sub(r"\W+", "_", match.group(1)).strip("_"), match.group(2)
        self.auxiliary.append((name, line, self.expression(right, line)))

    def _preset(self, rest: str, line: Line) -> None:
        match = re.fullmatch(r"\s*([^\W\d]\w*)\s*\{(.*)\}?\s*", rest)
        if match is None:
            raise self.model.wrong(line.number, "the set has no braces.", "As in set hopf {a=1,b=2}")
        values = {}
        for name, text in re.findall(r"([^\W\d]\w*)\s*=\s*([-+.\deE]+)", match.group(2)):
            with_name = self.spelled.get(name.lower(), name)
            value = number_of(text)
            if value is not None:
                values[with_name] = value
        self.options.sets[usable_name(match.group(1), False)] = values

    def _options(self, rest: str, line: Line) -> None:
        self.options.read(rest)

    def _table(self, rest: str, line: Line) -> None:
        name, _, what = rest.strip().partition(" ")
        own = self.spelled.get(name.lower(), name)
        self._once(own, self.model.tables, line)
        if what.strip().startswith("%"):
            self.model.tables[own] = table_of_formula(
                what, lambda formula: self.expression(formula, line), line.number
            )
        else:
            self.model.tables[own] = table_of_file(what.strip(), self.folder, line.number)

    def _event(self, rest: str, line: Line) -> None:
        sign, _, what = rest.strip().partition(" ")
        condition, brace, action = what.strip().removesuffix("}").rpartition("{")
        if not re.fullmatch(r"[-+]?\d", sign) or not brace or not condition or "}" in action:
            form = "As in global 1 v-1 {v=0}"
            raise self.model.wrong(line.number, "the event has not the form of one.", form)
        if int(sign) not in (1, -1):
            raise self.model.wrong(
                line.number, "an event at zero alone has no direction.", "Write 1, rising, or -1, falling."
            )
        guard = self.expression(condition.strip().removeprefix("{").removesuffix("}"), line)
        resets: dict[str, Node] = {}
        for part in filter(str.strip, action.split(";")):
            name, _, right = part.partition("=")
            state = self.spelled.get(name.strip().lower(), name.strip())
            if state in _EVENT_WORDS:
                self._note(f"{self.model.source}, line {line.number}: {state} of the event is left out.")
                continue
            value = self.expression(right, line)
            resets[state] = replaced(value, resets)
        number_ = len(self.model.events) + 1
        direction = "rising" if int(sign) > 0 else "falling"
        self.model.events[f"event_{number_}"] = Event(guard, direction, resets, line.number)

    def _statement(self, text: str, line: Line) -> None:
        """An equation, a function, a start, or a fixed quantity."""
        parser = self.parser(text)
        if parser.next.kind == "number":
            raise self.model.wrong(
                line.number, "an algebraic equation is solved at each step.", "It cannot be translated."
            )
        rate = re.match(r"(?i)d([^\W\d]\w*)\s*/\s*dt\s*=", text)
        if rate is not None:
            name = self.spelled.get(rate.group(1).lower(), rate.group(1))
            self._equation(name, "flow", text[rate.end() :], line)
            return
        name = parser.take_name()
        if parser.took("'"):
            self._equation(name, "flow", _right_of(text), line)
        elif parser.took("(", TIME, "+"):
            self._equation(name, "map", _right_of(text), line)
        elif parser.seen("(", TIME, ")") and self.calls[name.lower()] < 2:
            raise self.model.wrong(
                line.number,
                "an integral equation depends on all that was before.",
                "It cannot be translated.",
            )
        elif parser.took("("):
            if parser.next.kind == "number":
                value = self.expression(_right_of(text), line)
                if not is_constant(value):
                    raise self.model.wrong(line.number, f"the start of {name} is no number.", "As in x(0)=1")
                self.model.starts[name] = Value(value_of(value), line.number)
                return
            arguments = [parser.take_name()]
            while parser.took(","):
                arguments.append(parser.take_name())
            parser.need(")")
            self._once(name, self.model.functions, line)
            body = self.expression(_right_of(text), line)
            self.model.functions[name] = Function(tuple(arguments), body, line.number)
        else:
            parser.need("=")
            self._once(name, self.model.quantities, line)
            self.model.quantities[name] = Defined(self.expression(_right_of(text), line), line.number)

    def _equation(self, name: str, kind: str, right: str, line: Line) -> None:
        self._once(name, self.model.rates, line)
        self.kinds.setdefault(kind, line.number)
        self.model.rates[name] = Defined(self.expression(right, line), line.number)

    def _once(self, name: str, entries: dict, line: Line) -> None:
        if name in entries:
            raise self.model.wrong(
                line.number, f"'{name}' is defined again; it is on line {entries[name].line} already."
            )

    # What can be said when all lines have been read.

    def _finish(self) -> None:
        model = self.model
        model.is_map = "map" in self.kinds
        if len(self.kinds) > 1:
            raise model.wrong(max(self.kinds.values()), "equations of a flow and of a map stand in one file.")
        taken = {other.lower() for _, other, _ in model.lines()}
        for name, line, value in self.auxiliary:
            own = self.spelled.get(name.lower(), usable_name(name, False))
            if value.kind == "name" and value.value == own and own in model.quantities:
                model.shown.add(own)
                continue
            while own.lower() in taken:
                own += "_"
            taken.add(own.lower())
            model.quantities[own] = Defined(value, line.number)
            model.shown.add(own)
        self._check_events()
        if model.rates:
            self._check_resets()
            model.period = None if model.is_map else period_of(model)
        self.options.into(model)

    def _check_events(self) -> None:
        for event in self.model.events.values():
            for state in event.resets:
                if state in self.model.parameters:
                    raise self.model.wrong(
                        event.line,
                        f"the event changes the parameter {state}.",
                        f"Make it a state: {state}'=0 with init {state}=...",
                    )

    def _check_resets(self) -> None:
        """An event sets one state after the other: a function that comes later would see the new value."""
        used = needs(self.model)
        for event in self.model.events.values():
            before: set[str] = set()
            for state, value in event.resets.items():
                through = {n for call in calls_in(value) for n in used.get(call, ())} & before
                if through:
                    raise self.model.wrong(
                        event.line,
                        f"{state} is set by a function of {min(through)}, which the event has just set.",
                        "Write what it is of the states before the event.",
                    )
                before.add(state)


def _title(text: str) -> str:
    """The comment that a file begins with."""
    first = text.lstrip().partition("\n")[0]
    return " ".join(first.strip('#" \t').split()) if first.startswith(("#", '"')) else ""


_ONE_LETTER = {"p": "par", "n": "number", "i": "init", "a": "aux", "g": "global", "b": "bndry", "t": "table"}
_ONE_LETTER |= {"v": "volterra", "w": "wiener", "m": "markov", "bdry": "bndry", "sp": "special"}
_STEMS = ("par", "number", "init", "aux", "global", "table", "set", "only", "bndry", "options", *_REFUSED)


def _keyword(line: Line) -> tuple[str, str]:
    """What kind of line it is, and the rest; no word for equations and definitions."""
    if line.text[0] in "@!":
        return line.text[0], line.text[1:]
    match = re.match(r"(?i)([a-z]+)\s+(?=[^\s'=(^*/])", line.text)
    if match is None:
        return "", line.text
    word = match.group(1).lower()
    if re.match(r"[-+]", line.text[match.end() :]) and word not in ("global", "g"):
        return "", line.text
    found = _ONE_LETTER.get(word) or next((stem for stem in _STEMS if word.startswith(stem[:3])), "")
    return found, line.text[match.end() :]


def _right_of(text: str) -> str:
    return text.partition("=")[2]
