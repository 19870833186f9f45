"""One kind of leg as traced and compiled functions: its field, the map at its end, and what is watched on it.

Time runs from 0 to 1 over a leg: the field is T f(s + T t, x, p), where the duration T and (of forced
machines) the starting time s are inputs like parameters; in this form derivatives by them need no formulas of
their own. Only states that exist in the mode are integrated. The map at the end applies the transition's
reset and relabelling, and evaluates its guard. All of them come as `PLAIN`, and lifted: see `lifts`.

The closure of a smooth orbit is a leg that no transition ends. Where it begins with the force's period, T is
a multiple of period(p), which is traced, and neither it nor s is an input.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError, UnsupportedOperation
from contwalk.fields.blame import first_switched
from contwalk.fields.derivative import directional
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Inputs, Switching, choices_of, may_jump
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow import CompiledField, Field, Restricted
from contwalk.flow.events.guard_derivatives import MOST_NODES
from contwalk.memory import remembered
from contwalk.problems import conserving
from contwalk.problems.forcing import period_at
from contwalk.problems.kinks import Course, inputs
from contwalk.problems.orbit.lifts import DIRECTIONS, PLAIN, STATES, TANGENT, lifted
from contwalk.problems.orbit.watching import Watched
from contwalk.problems.orbit.word import Leg
from contwalk.problems.tracing import parameter_symbols, refuse_time, refuse_time_of, time_refused
from contwalk.system import Condition, Neutral, System, Transition
from contwalk.system.declarations import ParameterValues

Scalar = Callable[[Any, Any, Any], Any]
At = Callable[[np.ndarray], np.ndarray]
ORDERS = {"plain": 1, "tangent": 2, "mixed": 4, "jet": 4}
# The time in a system that nobody has declared to depend on it.
TIME = "time"


class Passage:
    """A leg of one mode, ended by one transition, compiled when it is first used.

    The *columns* are its scalar inputs: duration T, starting time s (of forced systems), a drift for each
    pinned direction, and the free parameter, in this order.

    Parameters
    ----------
    system : System
    leg : Leg
    target : str
        Mode that it leads into.
    free : str or None
        Name of the free parameter; None for a path through the parameter space.
    moving : sequence of int
        On a path, positions of the parameters that change along it.
    pins : sequence of Neutral
    image : str
        Symmetry that is applied after the transition; none if empty.
    power : int
        How many times it is applied.
    periods : float, optional
        The leg begins with the force's period and lasts so many of them: T and s are no inputs.
    holding : bool
        Whether conserved quantities are held at their values, as the equations of an orbit ask for.
    """

    def __init__(
        self,
        system: System,
        leg: Leg,
        target: str,
        free: str | None,
        moving: Sequence[int],
        pins: Sequence[Neutral],
        image: str = "",
        power: int = 1,
        periods: float | None = None,
        holding: bool = True,
    ) -> None:
        self.system, self.leg, self.target, self.images = system, leg, target, [image] * power
        self._periods, self._holding = periods, holding and bool(system.conserved)
        self.forced = system.period is not None
        self.states = system.states_of(leg.mode)
        self._own = np.array(self.states, dtype=int)
        self._every = self._own.tolist() == list(range(len(system.states)))
        self.following = system.states_of(target)
        self._free, self._moving, self.pins = free, frozenset(moving), tuple(pins)
        count, timed = len(system.parameters), periods is None
        self.groups = {
            "T": int(timed),
            "s": int(timed and self.forced),
            "a": len(self.pins),
            "l": 1,
            "b": count,
            "d": count,
        }
        self._fields: dict[tuple, Any] = {}
        self._switching: dict[tuple[str, str], Switching | None] = {}
        self._lines: dict[bytes, str] = {}

    @property
    def columns(self) -> list[tuple[str, int]]:
        """Inputs of the scalars, in their order."""
        return [(group, j) for group in "Tsal" for j in range(self.groups[group])]

    @property
    def mapped(self) -> bool:
        """Whether anything happens at its end."""
        return self.leg.transition is not None or bool(self.images[0])

    # -- tracing -----------------------------------------------------------------------------------------

    def _arguments(self, tracer: Tracer) -> tuple[Any, np.ndarray, ParameterValues]:
        """Symbols for t, x and p; states that do not exist in the mode are zero."""
        x = np.full(len(self.system.states), 0.0, dtype=object)
        for k, i in enumerate(self.states):
            x[i] = tracer.symbol("u", k)
        p = self._parameters(tracer, self.system.mode(self.leg.mode).constants)
        return self._time(tracer, p), x, p

    def _duration(self, tracer: Tracer, p: ParameterValues) -> Any:
        if self._periods is None:
            return tracer.symbol("T", 0)
        assert self.system.period is not None
        return self._periods * rebound(self.system.period)(p)

    def _time(self, tracer: Tracer, p: ParameterValues) -> Any:
        if not self.forced:  # whatever reads it is refused: see `_compiled`
            return tracer.symbol(TIME, 0)
        since = self._duration(tracer, p) * tracer.symbol("t", 0)
        return since if self._periods is not None else tracer.symbol("s", 0) + since

    def _parameters(self, tracer: Tracer, constants: Mapping[str, Any]) -> ParameterValues:
        p = parameter_symbols(tracer, self.system.parameter_names, self._free, self._moving)
        return ParameterValues(**vars(p), **constants)

    def _rates(self, tracer: Tracer) -> list[Any]:
        return self._moving_states(tracer, self.states, *self._arguments(tracer))

    def _moving_states(
        self,
        tracer: Tracer,
        states: Sequence[int],
        t: Any,
        x: np.ndarray,
        p: ParameterValues,
        rest: float | None = None,
    ) -> list[Any]:
        """Rates of some states over the leg's own time; `rest` is that of states that do not exist."""
        mode = self.system.mode(self.leg.mode)
        rates = _written(rebound(mode.field), f"the field of mode '{mode.name}'", states, t, x, p, rest)
        for j, pin in enumerate(self.pins):
            out = _written(rebound(pin.generator), f"'{pin.name}'", states, t, x, p)
            rates = [r + tracer.symbol("a", j) * v for r, v in zip(rates, out, strict=True)]
        duration = self._duration(tracer, p)
        rates = [duration * r for r in rates]
        if not self._holding:
            return rates
        away = conserving.returning(tracer, self.system, mode.name, t, x, p)
        return [r - away[i] for r, i in zip(rates, states, strict=True)]

    @cached_property
    def program(self) -> Program:
        """The field over the leg."""
        return trace(self._rates)

    @cached_property
    def switching(self) -> Switching | None:
        """Where the field is smooth by pieces only; None where it is smooth."""
        shared = self._shared.program if self.system.mode(self.leg.mode).constants else self.program
        if not choices_of(shared):
            return None
        unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
        return Switching(self.program, unknowns, ("t", 0)) if choices_of(self.program) else None

    def _after(self, tracer: Tracer) -> list[Any]:
        """The state after the transition and its images, in the states of the target mode."""
        t, x, p = self._arguments(tracer)
        transition = self.leg.transition
        out = x
        if transition is not None and transition.reset is not None:
            out = np.full(len(x), None, dtype=object)
            rebound(transition.reset)(t, x, p, out)
        for name in (None if transition is None else transition.relabel, *self.images):
            if name:
                given = np.array([0.0 if entry is None else entry for entry in out], dtype=object)
                out = np.full(len(x), 0.0 if transition is None else None, dtype=object)
                rebound(self.system.symmetry(name).map)(t, given, p, out)
        for i in self.following:
            if out[i] is None:
                assert transition is not None
                raise SystemDefinitionError(
                    f"The reset of transition '{transition.name}' does not write "
                    f"'{self.system.state_names[i]}', which exists in mode '{self.target}'.",
                    "Write every state of the target mode.",
                )
        return [out[i] for i in self.following]

    @cached_property
    def end_program(self) -> Program:
        """The state after the transition, then its guard; of a collapsed leg the duration, which is zero."""
        transition = self.leg.transition
        if transition is None:
            return trace(self._after)
        if self.leg.collapsed:
            return trace(lambda tracer: [*self._after(tracer), tracer.symbol("T", 0)])
        guard = rebound(transition.guard)
        return trace(lambda tracer: [*self._after(tracer), guard(*self._arguments(tracer))])

    @cached_property
    def end_switching(self) -> Switching | None:
        """Where the map at the end is smooth by pieces only; None where it is smooth."""
        unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
        return Switching(self.end_program, unknowns, ("t", 0)) if choices_of(self.end_program) else None

    def switching_of(self, name: str, function: Scalar, side: str = "before") -> Switching | None:
        """Where a number on the leg, or after the transition at its end, is smooth by pieces only.

        None where it is smooth, or compares in too many ways.
        """
        key = name, side
        if key not in self._switching:
            copy = rebound(function)

            def value(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                return [copy(t, self._full_after(tracer) if side == "after" else x, p)]

            unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
            try:
                program = trace(value)
            except UnsupportedOperation:
                self._switching[key] = None
            else:
                chooses = choices_of(program)
                self._switching[key] = Switching(program, unknowns, ("t", 0)) if chooses else None
        return self._switching[key]

    def course(
        self, values: np.ndarray, times: np.ndarray, states: np.ndarray, at: At | None = None
    ) -> Course | None:
        """A motion over it as it is looked at for kinks of the field; None where it has none.

        Parameters
        ----------
        values : ndarray
            Scalars and fixed parameters.
        times, states : ndarray, shapes (k,) and (k, n_i)
        at : callable, optional
            States at any times.
        """
        if self.switching is None:
            return None
        mode, known = self.system.mode(self.leg.mode), self.parameters(values)
        start, lasting = self.clock(values)

        def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
            places = [(start + lasting * t, self.full(x).tolist()) for t, x in (before, after)]
            return first_switched(mode.field, places[0], places[1], {**known, **mode.constants})

        def evaluate(times: np.ndarray, states: np.ndarray) -> Inputs:
            return inputs(self.groups, values, times, states)

        ends = self.leg.transition is not None
        return Course(self.switching, evaluate, times, states, at or _nowhere, where, ends, self._lines)

    def parameters(self, values: np.ndarray) -> dict[str, float]:
        """The system's parameters by name, from scalars and fixed parameters."""
        given = inputs(self.groups, values, np.zeros(1), np.zeros((1, 0)))
        lam, names = given["l", 0], self.system.parameter_names
        known = {name: given["b", k] + lam * given["d", k] for k, name in enumerate(names)}
        return known if self._free is None else known | {self._free: lam}

    def clock(self, values: np.ndarray) -> tuple[float, float]:
        """The time at which it starts, and how long it lasts, from scalars and fixed parameters."""
        given = inputs(self.groups, values, np.zeros(1), np.zeros((1, 0)))
        if self._periods is None:
            return given.get(("s", 0), 0.0), given["T", 0]
        return given.get(("s", 0), 0.0), self._periods * period_at(self.system, self.parameters(values))

    # -- compiled ----------------------------------------------------------------------------------------

    def _compiled(self, key: tuple, program: Program, lift: str, outputs: int | None) -> Field:
        if key not in self._fields:
            states = [(group, i) for group in STATES[lift] for i in range(len(self.states))]
            groups = {**self.groups, **{group: len(self.columns) for group in DIRECTIONS[lift]}}
            if not self.forced:
                self.refuse_time(program)
            made = lifted(program, len(self.states), self.columns, lift)
            self._fields[key] = Field(
                made,
                states,
                groups,
                self.columns,
                time=("t", 0),
                differentiable=key[-1],
                outputs=outputs,
            )
        return self._fields[key]

    def refuse_time(self, program: Program) -> None:
        """Refuse functions that depend on time in a system that is not declared to."""
        if program.reads(TIME):
            mode = self.system.mode(self.leg.mode)
            refuse_time(self.system, mode.name, mode.field, f"field of mode '{mode.name}'")
            for quantity in self.system.conserved:
                what = f"conserved quantity '{quantity.name}'"
                refuse_time_of(self.system, mode.name, quantity.of(mode.name), what)
            for pin in self.pins:
                refuse_time(self.system, mode.name, pin.generator, f"neutral direction '{pin.name}'")
            transition = self.leg.transition
            if transition is not None:
                what = f"transition '{transition.name}'"
                refuse_time_of(self.system, mode.name, transition.guard, f"guard of {what}")
                if transition.reset is not None:
                    refuse_time(self.system, mode.name, transition.reset, f"reset of {what}")
            raise time_refused(self.system, mode.field, f"guard or reset at the end of mode '{mode.name}'")

    def field(self, lift: str, implicit: bool = False) -> CompiledField:
        """The compiled field of a lift; an implicit method needs the Jacobian of any."""
        key = "field", lift, implicit or lift in (PLAIN, TANGENT)
        if key in self._fields:
            known: CompiledField = self._fields[key]
            return known
        constants = self.system.mode(self.leg.mode).constants
        if not constants:
            return self._compiled(key, self.program, lift, None)
        n = len(self.system.states)
        places = [n * group + i for group in range(len(STATES[lift])) for i in self.states]
        restricted = Restricted(self._shared.field(lift, key[-1]), places, list(constants.values()))
        self._fields[key] = restricted
        return restricted

    @cached_property
    def _shared(self) -> SharedField:
        """What the modes of this one's field have in common."""
        mode, free = self.system.mode(self.leg.mode), (self._free, self._moving)
        kept = tuple(quantity.of(mode.name) for quantity in self.system.conserved)
        pins = tuple(id(pin) for pin in self.pins)
        kind = self._periods, self._holding
        key = id(self.system), mode.field, tuple(mode.constants), free, pins, kept, kind
        return remembered(_SHARED, key, _MOST_SHARED, lambda: SharedField(self))

    def whole_program(self) -> Program:
        """The field over the leg as if all states existed, with the mode's constants as inputs `m`."""
        names = self.system.mode(self.leg.mode).constants

        def whole(tracer: Tracer) -> list[Any]:
            n = len(self.system.states)
            x = np.array([tracer.symbol("u", i) for i in range(n)], dtype=object)
            constants = {name: tracer.symbol("m", k) for k, name in enumerate(names)}
            p = self._parameters(tracer, constants)
            return self._moving_states(tracer, range(n), self._time(tracer, p), x, p, rest=0.0)

        return trace(whole)

    def end(self, lift: str) -> Field:
        """The map at the end: state after the transition, and the guard; of a lift, each with its
        derivatives.

        Outputs come order by order: (x+, h), then their first derivatives, and so on.
        """
        width = len(self.following) + (self.leg.transition is not None)
        return self._compiled(("end", lift, True), self.end_program, lift, ORDERS[lift] * width)

    def watched_program(self, function: Scalar) -> Program:
        """A scalar along the leg, then the field over it."""
        copy = rebound(function)
        return trace(lambda tracer: [copy(*self._arguments(tracer)), *self._rates(tracer)])

    def watched(self, name: str, function: Scalar) -> Watched:
        """A scalar along the leg, with its rate over the leg's own time, T dh/dt."""
        key = "watched", name, True
        if key not in self._fields:
            self._fields[key] = self._watching([function])
        return self._fields[key]

    def _watching(self, functions: Sequence[Scalar]) -> Watched:
        """Scalars along the leg, each with its rate, as maps of the states and their rates."""
        copies, n = [rebound(function) for function in functions], len(self.states)
        program = trace(lambda tracer: [copy(*self._arguments(tracer)) for copy in copies])
        if not self.forced:
            self.refuse_time(program)
        graph = program.graph
        inputs = [graph.input("u", k) for k in range(n)]
        moving = {graph.input("t", 0): graph.one}
        moving |= {node: graph.input("r", k) for k, node in enumerate(inputs)}

        def measured(outputs: tuple[int, ...]) -> list[int]:
            changes = directional(graph, list(outputs), moving)
            return [node for pair in zip(outputs, changes, strict=True) for node in pair]

        states = [(group, k) for group in ("u", "r") for k in range(n)]
        map_ = Field(
            program.transformed(measured),
            states,
            self.groups,
            self.columns,
            time=("t", 0),
            outputs=2 * len(copies),
        )
        return Watched(lambda: self.field(PLAIN), len(self.columns), map_, may_jump(program))

    @cached_property
    def guards_jump(self) -> bool:
        """Whether a guard out of the mode may jump."""
        try:
            return self.guards().jumps
        except UnsupportedOperation:  # together they compare too often; each is looked at by itself
            return True

    @cached_property
    def leaving(self) -> tuple[Transition, ...]:
        """The transitions out of the leg's mode, watched ones included."""
        return self.system.leaving(self.leg.mode)

    def of_time_alone(self, transition: Transition) -> bool:
        """Whether a guard reads no state: a clock, a sampling instant."""
        key = "of time alone", transition.name, True
        if key not in self._fields:
            copy = rebound(transition.guard)
            self._fields[key] = not trace(lambda tracer: [copy(*self._arguments(tracer))]).reads("u")
        return bool(self._fields[key])

    def guards(self) -> Watched:
        """The guards of `leaving`, each with its rate as `watched` has it, evaluated together.

        Raises
        ------
        UnsupportedOperation
            If together they compare the state in too many ways.
        """
        key = "guards", True
        if key not in self._fields:
            self._fields[key] = self._watching([transition.guard for transition in self.leaving])
        return self._fields[key]

    def guard_derivative(self, transition: Transition, order: int) -> Field:
        """A derivative of a guard over the leg's own time along the motion, of an order from one, as a map.

        Raises
        ------
        UnsupportedOperation
            If its graph is larger than MOST_NODES.
        """
        key = "guard derivative", transition.name, order, True
        if key not in self._fields:
            copy = rebound(transition.guard)
            program = trace(lambda tracer: [copy(*self._arguments(tracer)), *self._rates(tracer)])
            graph = program.graph

            def derivative(outputs: tuple[int, ...]) -> list[int]:
                value, *rates = outputs
                inputs = [graph.input("u", k) for k in range(len(self.states))]
                moving = {graph.input("t", 0): graph.one, **dict(zip(inputs, rates, strict=True))}
                for _ in range(order):
                    if len(graph.nodes) > MOST_NODES:
                        raise UnsupportedOperation(
                            f"Derivative {order} of '{transition.name}' by time is too large.",
                            "Shorten the field or the guard.",
                        )
                    (value,) = directional(graph, [value], moving)
                return [value]

            self._compiled(key, program.transformed(derivative), PLAIN, 1)
        return self._fields[key]

    @cached_property
    def conditions(self) -> tuple[Condition, ...]:
        """The conditions at the leg's transition."""
        return tuple(c for c in self.system.conditions if c.at == self.leg.name)

    def conditioned(self) -> Field:
        """All conditions at the leg's transition, as a map of the state before it.

        Raises
        ------
        UnsupportedOperation
            If together they compare the state in too many ways.
        """
        key = "conditions", True
        if key not in self._fields:
            copies = [(rebound(c.function), c.side) for c in self.conditions]

            def all_of(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                after = self._full_after(tracer) if any(side == "after" for _, side in copies) else x
                return [copy(t, after if side == "after" else x, p) for copy, side in copies]

            self._compiled(key, trace(all_of), PLAIN, len(copies))
        return self._fields[key]

    def condition(self, condition: Condition) -> Field:
        """One condition at the leg's transition, as a map of the state before it."""
        key = "condition", condition.name, True
        if key not in self._fields:
            copy, after = rebound(condition.function), condition.side == "after"

            def value(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                return [copy(t, self._full_after(tracer) if after else x, p)]

            self._compiled(key, trace(value), PLAIN, 1)
        return self._fields[key]

    def _full_after(self, tracer: Tracer) -> np.ndarray:
        """The state after the transition, of full length."""
        there = np.full(len(self.system.states), 0.0, dtype=object)
        for i, entry in zip(self.following, self._after(tracer), strict=True):
            there[i] = entry
        return there

    def full(self, x: np.ndarray) -> np.ndarray:
        """States of the mode (k, n_i) or (n_i,) as states of the system; those that do not exist are zero."""
        if self._every:
            return np.array(x, dtype=float)
        result = np.zeros((*x.shape[:-1], len(self.system.states)))
        result[..., self._own] = x
        return result


def _nowhere(times: np.ndarray) -> np.ndarray:
    raise ValueError("the motion is known at its own times only")


def _written(
    function: Callable[..., Any],
    what: str,
    states: Sequence[int],
    t: Any,
    x: np.ndarray,
    p: ParameterValues,
    rest: float | None = None,
) -> list[Any]:
    """What a function writes into its last argument, in these states; `rest` stands where it writes nothing,
    which is wrong if that is None.
    """
    out = np.full(len(x), rest, dtype=object)
    function(t, x, p, out)
    for i in states:
        if out[i] is None:
            raise SystemDefinitionError(
                f"{what} does not write entry {i} of its last argument.",
                "Every entry must be written.",
            )
    return [out[i] for i in states]


class SharedField:
    """The field over a leg, compiled once for all modes that differ by constants and by what exists."""

    def __init__(self, one: Passage) -> None:
        self._one, self.program = one, one.whole_program()
        self._constants = len(one.system.mode(one.leg.mode).constants)
        self._fields: dict[tuple[str, bool], Field] = {}
        if not one.forced:
            one.refuse_time(self.program)

    def field(self, lift: str, differentiable: bool) -> Field:
        """Of a lift, with all states; its first parameters are the constants of the mode."""
        key = lift, differentiable
        if key not in self._fields:
            one, n = self._one, len(self._one.system.states)
            groups = {"m": self._constants, **one.groups}
            groups |= {group: len(one.columns) for group in DIRECTIONS[lift]}
            self._fields[key] = Field(
                lifted(self.program, n, one.columns, lift),
                [(group, i) for group in STATES[lift] for i in range(n)],
                groups,
                one.columns,
                time=("t", 0),
                differentiable=differentiable,
            )
        return self._fields[key]


# What modes share keeps its passage, and so its system and its identity.
_SHARED: dict[tuple, SharedField] = {}
_MOST_SHARED = 64
_KNOWN: dict[tuple, Passage] = {}
_MOST_KNOWN = 256


def passage_of(
    system: System,
    leg: Leg,
    target: str,
    free: str | None,
    moving: Sequence[int],
    pins: Sequence[Neutral],
    image: str = "",
    power: int = 1,
    periods: float | None = None,
    holding: bool = True,
) -> Passage:
    """As `Passage(...)`, traced and compiled only once for the same arguments."""
    kind = image, power, periods, holding
    key = (id(system), leg, target, free, tuple(moving), tuple(id(pin) for pin in pins), kind)
    # It keeps its system, and so its id.
    return remembered(
        _KNOWN, key, _MOST_KNOWN, lambda: Passage(system, leg, target, free, moving, pins, *kind)
    )


def closure_of(
    system: System,
    free: str | None,
    moving: Sequence[int],
    pins: Sequence[Neutral],
    periods: float,
    holding: bool = True,
    image: str = "",
    power: int = 1,
) -> Passage:
    """The one leg of a smooth system's orbits: of a forced one, over so many periods of the force."""
    mode, lasting = system.modes[0].name, None if system.period is None else periods
    return passage_of(system, Leg(mode), mode, free, moving, pins, image, power, lasting, holding)
