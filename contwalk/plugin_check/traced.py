"""A plugin's function made ready for checks: traced, differentiated, and callable with plain numbers."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError, PluginError
from contwalk.fields.derivative import ancestors, jacobian
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Outputs, Program, Raises, Tracer, roots, trace
from contwalk.plugin_check.findings import Report, place_of, split_place
from contwalk.plugin_check.kernels import Kernels
from contwalk.python_functions import plain
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

AGAIN = (
    "Called again it gives other values: it depends on something besides t, x and p, such as a random "
    "number, a clock, or a variable that changes. What it needs must be constant, a state or a parameter."
)
OTHERWISE = (
    "Called with plain numbers it gives {own:.10g}, and with symbols, as it is used, {value:.10g}. Does it "
    "keep something from call to call, ask for the type of its arguments, or cut numbers to whole ones? What "
    "it needs must be constant, a state or a parameter."
)


@dataclass(frozen=True)
class Form:
    """What a function is expected to give: a number, or entries of the argument called `argument`.

    `names` are the names of the entries. `needed` are those that must be written, all by default; the others
    belong to states that do not exist and count as zero, whatever is written there.
    """

    signature: str
    names: Sequence[str]
    argument: str = ""
    needed: frozenset[int] | None = None

    @property
    def wanted(self) -> np.ndarray:
        """Which entries must be written, as a mask."""
        return np.array([self.needed is None or i in self.needed for i in range(len(self.names))])

    def entry(self, index: int) -> str:
        """An entry in words: `dx[1] (state Y)`."""
        return f"{self.argument}[{index}] (state {self.names[index]})"


def vector_form(system: System, name: str, argument: str, needed: Collection[int] | None = None) -> Form:
    """The form of `field`, `reset`, `map` and `generator`."""
    entries = None if needed is None else frozenset(needed)
    return Form(f"{name}(t, x, p, {argument})", system.state_names, argument, entries)


def number_form(signature: str) -> Form:
    """The form of `guard` and of observables."""
    return Form(signature, ("its value",))


class Traced:
    """A function as a program in t, x and p.

    Parameters
    ----------
    function : callable
        `function(t, x, p, out)`, or `function(t, x, p)` for a number.
    system : System
    form : Form
    instants : int
        For an observable, the number of instants of the motion it is given; 0 for all other functions.
    mode : str, optional
        States that do not exist in it are zero, and its constants are there; without it all states exist.
    every : bool
        Whether the mode gives its constants only, and all states exist.
    kernels : Kernels, optional
        Those of a program that is the function in other modes too, with all states and the constants among
        its inputs. Its own program is traced when it is first asked for.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        system: System,
        form: Form,
        instants: int = 0,
        mode: str | None = None,
        every: bool = False,
        kernels: Kernels | None = None,
    ) -> None:
        self.function = function
        self.system = system
        self.form = form
        self.instants = instants
        self.existing = range(len(system.states)) if mode is None or every else system.states_of(mode)
        self._constants = {} if mode is None else dict(system.mode(mode).constants)
        self._numbers = tuple(self._constants.values())
        self.unwritten: set[int] = set()
        # Whoever made the kernels has asked; of others what cannot be traced is refused here.
        self.repeats = kernels is not None or _same(self.program, trace(self.recorded))
        self._kernels = kernels or Kernels(self.program, len(form.names), len(system.states))

    @cached_property
    def program(self) -> Program:
        """Its entries as they depend on t, x and p."""
        return trace(self.recorded)

    def recorded(self, tracer: Tracer) -> list[Any]:
        """Its entries for the symbols of t, x and p."""
        x = np.full(len(self.system.states), 0.0, dtype=object)
        for i in self.existing:
            x[i] = tracer.symbol("x", i)
        p = {name: tracer.symbol("p", k) for k, name in enumerate(self.system.parameter_names)}
        known = ParameterValues(**p, **self._constants)
        out = self._call(rebound(self.function), tracer.symbol("t", 0), x, known, None, object)
        out[~self.form.wanted] = 0.0
        self.unwritten |= {i for i, entry in enumerate(out) if entry is None}
        return [0.0 if entry is None else entry for entry in out]

    @cached_property
    def _plain(self) -> Callable[..., Any]:
        return plain(self.function)

    def _call(
        self, function: Callable[..., Any], t: Any, x: np.ndarray, p: ParameterValues, blank: Any, dtype: Any
    ) -> np.ndarray:
        out = np.full(len(self.form.names), blank, dtype=dtype)
        if self.instants:
            out[0] = function(np.zeros(self.instants), np.tile(x, (self.instants, 1)), p)
        elif self.form.argument:
            function(t, x, p, out)
        else:
            out[0] = function(t, x, p)
        return out

    @cached_property
    def has_nan(self) -> bool:
        """Whether a constant that is not a number is among what the function is computed from."""
        graph = self.program.graph
        constants = (graph.value(node) for node in ancestors(graph, roots(self.program.tree)))
        return any(value is not None and np.isnan(value) for value in constants)

    def given(self, x: np.ndarray) -> np.ndarray:
        """A state as the function gets it: zero for what does not exist."""
        state = np.zeros(len(x))
        state[list(self.existing)] = x[list(self.existing)]
        return state

    def plainly(self, t: float, x: np.ndarray, parameters: dict[str, float]) -> np.ndarray:
        """The function's own values, called with numbers; NaN where it raises."""
        p = ParameterValues(**parameters, **self._constants)
        with np.errstate(all="ignore"):
            try:
                out = self._call(self._plain, t, self.given(x), p, np.nan, float)
            except (Exception, SystemExit) as error:
                if isinstance(error, ArithmeticError | ValueError) or self.raises():
                    return np.full(len(self.form.names), np.nan)
                raise PluginError(
                    f"With numbers in place of symbols it raises {type(error).__name__}: {error}.",
                    f"Its form is {self.form.signature}.",
                ) from error
        return np.where(self.form.wanted, out, 0.0)

    def raises(self) -> list[str]:
        """What the function raises, on those of its paths that end so."""
        return [leaf.message for leaf in self.program.leaves() if isinstance(leaf, Raises)]

    def outputs(self) -> list[Outputs]:
        """The other ends of its paths."""
        return [leaf for leaf in self.program.leaves() if isinstance(leaf, Outputs)]

    def is_condition(self) -> bool:
        """Whether a result is True or False rather than a number: 1 where something holds, else 0."""
        graph = self.program.graph
        keys = (graph.nodes[node] for leaf in self.outputs() for node in leaf.nodes)
        return any(key[0] == "select" and key[2:] == (graph.one, graph.zero) for key in keys)

    def is_identity(self) -> bool:
        """Whether it writes the state itself, whatever that is."""
        graph = self.program.graph
        wanted = [int(i) for i in np.flatnonzero(self.form.wanted) if i in self.existing]
        return all(leaf.nodes[i] == graph.input("x", i) for leaf in self.outputs() for i in wanted)

    def _inputs(self) -> list[int]:
        graph = self.program.graph
        return [graph.input("t", 0), *[graph.input("x", i) for i in range(len(self.system.states))]]

    def depends(self) -> set[int]:
        """Which of t (0) and the states (1, 2, ...) the results depend on."""
        rows = (jacobian(self.program.graph, leaf.nodes, self._inputs()) for leaf in self.outputs())
        return {k for matrix in rows for row in matrix for k in row}

    def values(self, t: float, x: np.ndarray, parameters: Sequence[float]) -> np.ndarray:
        """Values, shape (m,); NaN where there are none."""
        return np.where(self.form.wanted, self._kernels.values(t, x, parameters, self._numbers), 0.0)

    def slopes(self, t: float, x: np.ndarray, parameters: Sequence[float]) -> np.ndarray:
        """Exact derivatives by t (column 0) and the states, shape (m, n + 1); NaN where there are none."""
        read = np.zeros(len(x) + 1, dtype=bool)
        read[[0, *(i + 1 for i in self.existing)]] = True
        found = self._kernels.slopes(t, x, parameters, self._numbers)
        return np.where(self.form.wanted[:, None] & read, found, 0.0)

    def roundings(self, t: float, x: np.ndarray, parameters: Sequence[float]) -> np.ndarray:
        """Bounds of the rounding errors of the values, in units of the machine epsilon, shape (m,)."""
        return np.where(self.form.wanted, self._kernels.roundings(t, x, parameters, self._numbers), 0.0)


def _same(first: Program, second: Program) -> bool:
    """Whether two traces of a function are one; NaN is like NaN."""
    return first.tree == second.tree and repr(first.graph.nodes) == repr(second.graph.nodes)


def traced(
    report: Report,
    what: str,
    function: Callable[..., Any],
    system: System,
    form: Form,
    instants: int = 0,
    mode: str | None = None,
) -> Traced | None:
    """The traced function; a finding for all that is wrong with it, and None if it cannot be used."""
    place = place_of(function)
    try:
        found = Traced(function, system, form, instants, mode)
    except ContwalkError as error:
        where, sentence = split_place(error.sentence, place)
        mixed_up = isinstance(error.__cause__, TypeError)  # one argument taken for another, most often
        hint = f" Its form is {form.signature}, with parameters as p.name." if mixed_up else ""
        report.error(what, f"{sentence} {error.remedy}{hint}", where)
        return None
    if not found.repeats:
        report.error(what, AGAIN, place)
        return None
    usable = True
    for message in found.raises():
        where, sentence = split_place(message, place)
        if found.outputs():
            report.warning(
                what, f"On one of its paths it raises {sentence}. A run that gets there ends.", where
            )
        else:
            report.error(what, f"It raises {sentence}. Its form is {form.signature}.", where)
            usable = False
    for index in sorted(found.unwritten):
        usable = False
        if form.argument:
            every = "Every entry must be written." if form.needed is None else "That state exists there."
            report.error(what, f"It does not write {form.entry(index)}. {every}", place)
        else:
            report.error(what, f"It returns nothing. {form.signature} must return a number.", place)
    if usable and not form.argument and not instants and found.is_condition():
        report.error(what, "It gives True or False. A number is needed, whose sign changes there.", place)
        usable = False
    return found if usable else None
