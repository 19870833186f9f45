"""A model written as a plugin: the Python that a person would have written, and reads."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from contwalk.equations.functions import CONSTANTS, NUMBERS_ALONE
from contwalk.equations.model import Model
from contwalk.equations.names import LARGEST, TIME, check_names, needs
from contwalk.equations.nodes import Node, calls_in, names_in
from contwalk.equations.python import Writer

# Names of a plugin's own; arguments of its functions, and what stands beside them.
_ARGUMENTS = ("t", "state", "p", "rate", "after", "np", "math")
_DECLARED = ("Mode", "Parameter", "Signal", "State", "Study", "System", "Transition")
_MODULE = ("np", "math", "field", "period", "SYSTEM", *_DECLARED)
_WIDTH = (100,)


@dataclass
class Plugin:
    """A plugin's text, and of each of its lines the line of the model that it comes from (0: none)."""

    text: str = ""
    origins: list[int] = field(default_factory=list)


def plugin_of(model: Model, name: str) -> Plugin:
    """The plugin of a model.

    Parameters
    ----------
    model : Model
    name : str
        Of the system.

    Raises
    ------
    ModelError
        If a name of the model is unknown or taken, or is used as what it is not.
    """
    check_names(model)
    return _Writing(model, name).plugin()


def _free(name: str, taken: Iterable[str]) -> str:
    while name in taken:
        name += "_"
    return name


class _Writing:
    def __init__(self, model: Model, name: str) -> None:
        self.model, self.name = model, name
        self.needs = needs(model)
        if sum(len(self.needs[name]) for name in model.shown) > LARGEST["lines"]:
            raise model.wrong(1, "quantities are defined by way of too many others.", "Write a plugin.")
        self.lines: list[tuple[str, int]] = []
        own: dict[str, str] = {}
        for function in (*model.functions, *model.tables):
            own[function] = _free(function, (*_MODULE, *_ARGUMENTS, *own.values()))
        self.functions = own
        self.globals = [*_MODULE, *own.values()]

    def add(self, text: str = "", origin: int = 0) -> None:
        self.lines += [(line, origin) for line in text.split("\n")]

    def plugin(self) -> Plugin:
        model = self.model
        for name in (name for name in self.needs if name in model.functions):
            self._function(name)
        for name in model.tables:
            self._table(name)
        writes = "the next state" if model.is_map else "the rates of the states"
        values = {state: entry.value for state, entry in model.rates.items()}
        first = next(iter(model.rates.values())).line
        into = "after" if model.is_map else "rate"
        self._writing("field", into, values, f"Write {writes}.", first, own_lines=True)
        transitions = [self._event(name) for name in model.events]
        signals = [self._signal(name) for name in model.quantities if self._is_signal(name)]
        if model.period is not None:
            about = "The period of the forcing."
            self._returning("period", ("p",), model.period.value, model.period.line, about)
        self._system(transitions, signals)
        body, self.lines = self.lines, []
        self._head("\n".join(text for text, _ in body))
        lines = [*self.lines, *body]
        return Plugin("\n".join(text for text, _ in lines) + "\n", [origin for _, origin in lines])

    def _head(self, body: str) -> None:
        about = _in_docstring(self.model.about or self.name)
        made_from = _in_docstring(self.model.reference or self.model.source)
        self.add(f'"""{about}.\n\nMade from {made_from}.\n"""\n')
        if "math." in body:
            self.add("import math\n")
        if "np." in body:
            self.add("import numpy as np\n")
        used = [name for name in _DECLARED if f"{name}(" in body]
        self.add(f"from contwalk.system import {', '.join(used)}")

    # What a function uses, and under which names.

    def _used(self, roots: Iterable[Node], arguments: Sequence[str] = ()) -> set[str]:
        """All names that expressions use, directly or not."""
        found: set[str] = set()
        for root in roots:
            direct = {*names_in(root) - set(arguments), *calls_in(root)}
            found |= direct | {other for name in direct for other in self.needs.get(name, ())}
        return found

    def _locals(self, arguments: Sequence[str] = ()) -> dict[str, str]:
        """What stands for each name in a function."""
        model, taken = self.model, {*_ARGUMENTS, *self.globals}
        names = {constant: f"math.{constant}" for constant in CONSTANTS}
        names |= {parameter: f"p.{parameter}" for parameter in model.parameters} | {TIME: "t"}
        for name in dict.fromkeys((*arguments, *model.rates, *model.quantities)):
            names[name] = _free(name, taken)
            taken.add(names[name])
        return names

    def _extra(self, function: str) -> list[str]:
        """What a function of the model gets beside its arguments: names of the model, `p` last."""
        if function in self.model.tables:
            return []
        used = self.needs[function]
        order = [TIME, *self.model.rates, *self.model.quantities]
        extra = [name for name in order if name in used]
        return [*extra, *(["p"] if any(name in self.model.parameters for name in used) else [])]

    def _writer(self, names: dict[str, str]) -> Writer:
        def called(name: str, arguments: list[str]) -> str:
            extra = ["p" if other == "p" else names[other] for other in self._extra(name)]
            return f"{self.functions[name]}({', '.join([*arguments, *extra])})"

        return Writer(names, called)

    # The functions of the plugin.

    def _function(self, name: str) -> None:
        function = self.model.functions[name]
        names = self._locals(function.arguments)
        extra = ["p" if other == "p" else names[other] for other in self._extra(name)]
        head = f"def {self.functions[name]}({', '.join([*(names[a] for a in function.arguments), *extra])}):"
        self.add(f"\n\n{head}", function.line)
        self._statement("return ", self._writer(names).text(function.body), function.line)

    def _table(self, name: str) -> None:
        table, own = self.model.tables[name], self.functions[name]
        places, values = (_free(f"{own.upper()}_{what}", self.globals) for what in ("AT", "VALUES"))
        self.globals += [places, values]
        self.add("\n")
        self._statement(f"{places} = ", f"np.array([{', '.join(map(repr, table.places))}])", table.line, "")
        self._statement(f"{values} = ", f"np.array([{', '.join(map(repr, table.values))}])", table.line, "")
        (x0, x1), (y0, y1) = table.places[:2], table.values[:2]
        (a0, a1), (b0, b1) = table.places[-2:], table.values[-2:]
        self.add(f"\n\ndef {own}(at):", table.line)
        self.add('    """Linear between the values, and beyond them as at the ends."""', table.line)
        beyond = f"{(y1 - y0) / (x1 - x0)!r} * np.minimum(at - {x0!r}, 0.0)"
        beyond += f" + {(b1 - b0) / (a1 - a0)!r} * np.maximum(at - {a1!r}, 0.0)"
        self._statement("return ", f"np.interp(at, {places}, {values}) + {beyond}", table.line)

    def _begin(self, roots: Sequence[Node], names: dict[str, str], columns: str = "") -> None:
        """States and quantities that expressions use, as names of a function's own."""
        used, model = self._used(roots), self.model
        states = [state for state in model.rates if state in used]
        unpacked = ", ".join(names[state] for state in states)
        if len(states) == len(model.rates) > 1 and len(unpacked) < _WIDTH[0] - 20:
            self.add(f"    {unpacked} = state{'.T' * bool(columns)}")
        else:
            for i, state in enumerate(model.rates):
                if state in used:
                    self.add(f"    {names[state]} = state[{columns}{i}]")
        writer = self._writer(names)
        for quantity in (name for name in self.needs if name in model.quantities):
            if quantity in used:
                entry = model.quantities[quantity]
                self._statement(f"{names[quantity]} = ", writer.text(entry.value), entry.line)

    def _returning(
        self, name: str, arguments: Sequence[str], root: Node, line: int, about: str, columns: str = ""
    ) -> None:
        names = self._locals()
        self.add(f"\n\ndef {name}({', '.join(arguments)}):", line)
        self.add(f'    """{about}"""', line)
        self._begin([root], names, columns)
        self._statement("return ", self._writer(names).text(root), line)

    def _writing(
        self, name: str, into: str, values: dict[str, Node], about: str, line: int, own_lines: bool = False
    ) -> None:
        """A function that writes its last argument: an entry for each state, its own where none is given."""
        names, model = self._locals(), self.model
        self.add(f"\n\ndef {name}(t, state, p, {into}):", line)
        self.add(f'    """{about}"""', line)
        self._begin(list(values.values()), names)
        writer = self._writer(names)
        for i, state in enumerate(model.rates):
            text = writer.text(values[state]) if state in values else f"state[{i}]"
            self._statement(f"{into}[{i}] = ", text, model.rates[state].line if own_lines else line)

    def _event(self, name: str) -> str:
        event = self.model.events[name]
        guard, reset = (_free(f"{name}_{what}", self.globals) for what in ("guard", "reset"))
        self.globals += [guard, reset]
        direction = event.direction
        about = "Zero at the event."
        self._returning(guard, ("t", "state", "p"), event.guard, event.line, about)
        declared = f'Transition("{name}", "motion", "motion", {guard}, direction="{direction}"'
        if not event.resets:
            return f'{declared}, role="watched")'
        self._writing(reset, "after", dict(event.resets), "Write the state after the event.", event.line)
        return f"{declared}, reset={reset})"

    def _is_signal(self, name: str) -> bool:
        used = {name, *self.needs[name]}
        return name in self.model.shown and bool(used & {TIME, *self.model.rates})

    def _signal(self, name: str) -> str:
        model, entry = self.model, self.model.quantities[name]
        own = _free(f"{name}_along", self.globals)
        self.globals.append(own)
        used = {*calls_in(entry.value), *self.needs[name]}
        bodies = [model.quantities[n].value for n in used if n in model.quantities]
        bodies += [model.functions[n].body for n in used if n in model.functions]
        called = {call for body in (*bodies, entry.value) for call in calls_in(body)}
        if called & set(NUMBERS_ALONE):  # of one number at a time
            at = _free(f"{name}_at", self.globals)
            self._returning(at, ("t", "state", "p"), entry.value, entry.line, f"Value of {name}.")
            self.add(f"\n\ndef {own}(t, state, p):", entry.line)
            self.add(f'    """Values of {name} along a motion."""', entry.line)
            self.add(f"    return np.array([{at}(*instant, p) for instant in zip(t, state)])", entry.line)
        else:
            about = f"Values of {name} along a motion."
            self._returning(own, ("t", "state", "p"), entry.value, entry.line, about, ":, ")
        about = f", about={_quoted(entry.about)}" if entry.about else ""
        return f'Signal("{name}", {own}{about})'

    def _system(self, transitions: list[str], signals: list[str]) -> None:
        model = self.model
        self.add("\n\nSYSTEM = System(")
        self.add(f"    name={_quoted(self.name)},")
        if model.about:
            self.add(f"    about={_quoted(model.about)},")
        self._entries("states", [self._state(name) for name in model.rates])
        self._entries("parameters", [self._parameter(name) for name in model.parameters])
        kind = ', kind="map"' if model.is_map else ""
        self._entries("modes", [(f'Mode("motion", field{kind})', 0)])
        self._entries("transitions", [(text, 0) for text in transitions])
        self._entries("signals", [(text, 0) for text in signals])
        if model.period is not None:
            self.add("    period=period,", model.period.line)
        if model.presets:
            self.add("    presets={")
            for name, values in model.presets.items():
                self.add(f"        {_quoted(name)}: {_mapping(values)},")
            self.add("    },")
        if model.study is not None:
            name, (low, high) = model.study
            self.add(f'    study=Study("{name}", ({low!r}, {high!r})),')
        self.add(f"    reference={_quoted(model.reference or model.source)},")
        self.add(")")

    def _state(self, name: str) -> tuple[str, int]:
        entry, start = self.model.rates[name], self.model.starts.get(name)
        told = f", start={start.value!r}" if start is not None else ""
        about = entry.about or (start.about if start is not None else "")
        return f'State("{name}"{told}{_about(about)})', entry.line

    def _parameter(self, name: str) -> tuple[str, int]:
        entry = self.model.parameters[name]
        return f'Parameter("{name}", {entry.value!r}{_about(entry.about)})', entry.line

    def _entries(self, what: str, entries: list[tuple[str, int]]) -> None:
        """A tuple of declarations; nothing where there are none, but of what a system must have."""
        if not entries and what != "parameters":
            return
        if not entries:
            self.add(f"    {what}=(),")
            return
        if len(entries) == 1 and len(entries[0][0]) < _WIDTH[0] - 20:
            self.add(f"    {what}=({entries[0][0]},),", entries[0][1])
            return
        self.add(f"    {what}=(")
        for text, line in entries:
            self.add(f"        {text},", line)
        self.add("    ),")

    def _statement(self, head: str, text: str, line: int, indent: str = "    ") -> None:
        """A statement, over several lines where it is long."""
        whole = f"{indent}{head}{text}"
        if len(whole) <= _WIDTH[0]:
            self.add(whole, line)
            return
        self.add(f"{indent}{head}(", line)
        row = f"{indent}   "
        for word in text.split(" "):
            if len(row) + 1 + len(word) > _WIDTH[0] and row.strip():
                self.add(row, line)
                row = f"{indent}   "
            row += f" {word}"
        self.add(row, line)
        self.add(f"{indent})", line)


def _mapping(values: Mapping[str, float]) -> str:
    return f"{{{', '.join(f'{_quoted(name)}: {value!r}' for name, value in values.items())}}}"


def _about(text: str) -> str:
    return f", about={_quoted(text)}" if text else ""


def _quoted(text: str) -> str:
    """A text as Python writes it, in double quotes."""
    return json.dumps(text, ensure_ascii=False)


def _in_docstring(text: str) -> str:
    """A text that stays inside a docstring."""
    shown = "".join(letter for letter in " ".join(text.split()) if letter.isprintable())
    return shown.replace("\\", "/").replace('"', "'").rstrip(".")
