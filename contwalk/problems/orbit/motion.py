"""The motion over one period as a traced program, and the lifts of it that carry derivatives along.

Time runs from 0 to 1 over the closure of an orbit: the field is T f(T t, x, p), where T is an unknown, or
for a forced machine a multiple of period(p). In this form the period is a parameter like the others: its
derivatives need no formulas of their own.

A *lift* of the field integrates derivatives beside the state. They are fields again, made of the same graph:

| lift | states | what is integrated |
|---|---|---|
| `PLAIN` | x | the motion |
| `TANGENT` | x, v | and its derivative in one direction (v, w) of state and parameters |
| `MIXED` | x, v, y, z | and the derivative of x and v in a second direction (y, e) |
| `JET` | x, x1, x2, x3 | and the first three derivatives of the motion by the parameter of a curve of
motions |

Steps of an integrator commute with differentiation: on the same steps a lift gives the exact derivatives of
what the integrator makes of the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.blame import first_switched
from contwalk.fields.derivative import directional
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow import Field
from contwalk.memory import remembered
from contwalk.problems import conserving
from contwalk.problems.forcing import period_at
from contwalk.problems.kinks import Course, Kink, inputs
from contwalk.problems.tracing import (
    parameter_symbols,
    refuse_time,
    refuse_time_of,
    state_symbols,
    written,
)
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

PLAIN, TANGENT, MIXED, JET = "plain", "tangent", "mixed", "jet"
# Groups of state inputs of each lift, and groups of directions in the columns.
STATES = {PLAIN: "u", TANGENT: "uv", MIXED: "uvyz", JET: ("u", "u1", "u2", "u3")}
DIRECTIONS = {PLAIN: (), TANGENT: ("w",), MIXED: ("w", "e"), JET: ("c1", "c2", "c3")}


class Motion:
    """The field over one closure with its lifts, compiled when they are first used.

    The *columns* are the scalar unknowns beside the states: the period T (where it is unknown), a drift for
    each pinned neutral direction, and the free parameter, in this order.

    Parameters
    ----------
    system : System
    free : str or None
        Name of the free parameter; None for a path through the parameter space.
    moving : sequence of int
        On a path, the positions of the parameters that change along it.
    pins : sequence of Neutral
        Pinned neutral directions; drift_j times their generator is added to the field.
    periods : float
        A forced machine's closure lasts so many of its periods.
    holding : bool
        Whether conserved quantities are held at their values, as the equations of an orbit ask for.
    """

    def __init__(
        self,
        system: System,
        free: str | None,
        moving: Sequence[int],
        pins: Sequence[Neutral],
        periods: float,
        holding: bool = False,
    ) -> None:
        self.system = system
        self.states = len(system.states)
        self.pins = tuple(pins)
        self.forced = system.period is not None
        self._free = free
        self._moving = frozenset(moving)
        self._periods, self._holding = periods, holding and bool(system.conserved)
        self._field = rebound(system.modes[0].field)
        self._generators = [rebound(pin.generator) for pin in pins]
        self._period = None if system.period is None else rebound(system.period)
        count = len(system.parameters)
        self.groups = {"T": 0 if self.forced else 1, "a": len(pins), "l": 1, "b": count, "d": count}
        self._fields: dict[tuple[str, bool], Field] = {}
        self.kinks: dict[bytes, Kink] = {}  # that have been told of already

    @property
    def columns(self) -> list[tuple[str, int]]:
        """Inputs of the scalar unknowns, in their order."""
        period = [] if self.forced else [("T", 0)]
        return [*period, *[("a", j) for j in range(len(self.pins))], ("l", 0)]

    # -- tracing -----------------------------------------------------------------------------------------

    def parameters(self, tracer: Tracer) -> ParameterValues:
        """Symbols of the parameters by name."""
        return parameter_symbols(tracer, self.system.parameter_names, self._free, self._moving)

    def duration(self, tracer: Tracer, p: ParameterValues) -> Any:
        """Symbol of the closure's duration T."""
        return tracer.symbol("T", 0) if self._period is None else self._periods * self._period(p)

    def _right_side(self, tracer: Tracer) -> list[Any]:
        p = self.parameters(tracer)
        x = state_symbols(tracer, self.states)
        duration = self.duration(tracer, p)
        t = duration * tracer.symbol("t", 0)
        result = written(self._field, self.system.modes[0].name, t, x, p)
        for j, pin in enumerate(self.pins):
            v = written(self._generators[j], pin.name, t, x, p)
            result = [r + tracer.symbol("a", j) * v[i] for i, r in enumerate(result)]
        rates = [duration * r for r in result]
        if not self._holding:
            return rates
        away = conserving.returning(tracer, self.system, self.system.modes[0].name, t, x, p)
        return [r - a for r, a in zip(rates, away, strict=True)]

    @cached_property
    def program(self) -> Program:
        """The field over one closure, n outputs."""
        mode = self.system.modes[0]
        if not self.forced:
            refuse_time(self.system, mode.name, mode.field, f"field of mode '{mode.name}'")
        for quantity in self.system.conserved if self._holding else ():
            refuse_time_of(
                self.system, mode.name, quantity.of(mode.name), f"conserved quantity '{quantity.name}'"
            )
        for pin in () if self.forced else self.pins:
            refuse_time(self.system, mode.name, pin.generator, f"neutral direction '{pin.name}'")
        return trace(self._right_side)

    @cached_property
    def switching(self) -> Switching | None:
        """Where the field is smooth by pieces only; None where it is smooth."""
        unknowns = [*[("u", i) for i in range(self.states)], *self.columns]
        return Switching(self.program, unknowns, ("t", 0)) if choices_of(self.program) else None

    def course(
        self,
        values: np.ndarray,
        times: np.ndarray,
        states: np.ndarray,
        at: Callable[[np.ndarray], np.ndarray] | None = None,
    ) -> Course | None:
        """A motion as it is looked at for kinks; None where the field has none.

        Parameters
        ----------
        values : ndarray
            Scalars and fixed parameters.
        times, states : ndarray, shapes (k,) and (k, n)
        at : callable, optional
            States at any times.
        """
        if self.switching is None:
            return None
        names, function = self.system.parameter_names, self.system.modes[0].field
        given = inputs(self.groups, values, times, states)
        lam = given["l", 0]
        known = {n: given["b", k] + lam * given["d", k] for k, n in enumerate(names)}
        if self._free is not None:
            known[self._free] = lam
        forced = self.system.period is not None
        lasting = period_at(self.system, known) * self._periods if forced else given["T", 0]

        def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
            places = [(lasting * t, x.tolist()) for t, x in (before, after)]
            return first_switched(function, places[0], places[1], known)

        def evaluate(times: np.ndarray, states: np.ndarray) -> Inputs:
            return inputs(self.groups, values, times, states)

        return Course(self.switching, evaluate, times, states, at or _nowhere, where)

    # -- lifts -------------------------------------------------------------------------------------------

    def field(self, lift: str, implicit: bool = False) -> Field:
        """The compiled field of a lift; an implicit method needs the Jacobian of any."""
        key = lift, implicit or lift in (PLAIN, TANGENT)
        if key not in self._fields:
            states = [(group, i) for group in STATES[lift] for i in range(self.states)]
            groups = {**self.groups, **{group: len(self.columns) for group in DIRECTIONS[lift]}}
            program = lifted(self.program, self.states, self.columns, lift)
            self._fields[key] = Field(
                program,
                states,
                groups,
                self.columns,
                time=("t", 0),
                differentiable=key[1],
            )
        return self._fields[key]

    def constants(
        self, lift: str, scalars: np.ndarray, fixed: np.ndarray, *directions: np.ndarray
    ) -> np.ndarray:
        """What a lift's field depends on beside time and state.

        Parameters
        ----------
        scalars : ndarray, shape (k,)
            Values of `columns`.
        fixed : ndarray
            Groups `b` and `d` one after the other.
        *directions : ndarray, shape (k,)
            One for each group of `DIRECTIONS`.
        """
        return self.field(lift).constants(np.concatenate([scalars, fixed, *directions]))


def _nowhere(times: np.ndarray) -> np.ndarray:
    raise ValueError("the motion is known at its own times only")


def lifted(program: Program, states: int, columns: Sequence[tuple[str, int]], lift: str) -> Program:
    """The program that computes a lift's outputs from those of `program`: a field, a map or a guard."""
    graph = program.graph

    def moved(pairs: Mapping[str, str], along: Sequence[tuple[str, str]]) -> dict[int, int]:
        """Direction of every input: state groups by `pairs`, columns by the groups in `along`."""
        result = {graph.input(a, i): graph.input(b, i) for a, b in pairs.items() for i in range(states)}
        for source, target in along:
            for k, (group, index) in enumerate(columns):
                node = graph.input(group, index) if source == "" else graph.input(source, k)
                result[node] = graph.input(target, k)
        return result

    def change(outputs: tuple[int, ...]) -> list[int]:
        first = list(outputs)
        if lift == PLAIN:
            return first
        if lift == TANGENT:
            return first + directional(graph, first, moved({"u": "v"}, [("", "w")]))
        if lift == MIXED:
            pair = first + directional(graph, first, moved({"u": "v"}, [("", "w")]))
            return pair + directional(graph, pair, moved({"u": "y", "v": "z"}, [("", "e")]))
        one = directional(graph, first, moved({"u": "u1"}, [("", "c1")]))
        two = directional(graph, one, moved({"u": "u1", "u1": "u2"}, [("", "c1"), ("c1", "c2")]))
        chain = moved({"u": "u1", "u1": "u2", "u2": "u3"}, [("", "c1"), ("c1", "c2"), ("c2", "c3")])
        return first + one + two + directional(graph, two, chain)

    return program.transformed(change)


_KNOWN: dict[tuple, Motion] = {}
_MOST_KNOWN = 64


def motion_of(
    system: System,
    free: str | None,
    moving: Sequence[int],
    pins: Sequence[Neutral],
    periods: float,
    holding: bool = False,
) -> Motion:
    """As `Motion(...)`, traced and compiled only once for the same arguments."""
    key = (id(system), free, tuple(moving), tuple(id(pin) for pin in pins), periods, holding)
    # It keeps its system, and so its id.
    return remembered(_KNOWN, key, _MOST_KNOWN, lambda: Motion(system, free, moving, pins, periods, holding))
