"""The functions of one kind of leg as programs: its field over the leg's own time, and the map at its end.

Time runs from 0 to 1 over a leg: the field is T f(s + T t, x, p), where the duration T and (of forced
machines) the starting time s are inputs like parameters; in this form derivatives by them need no formulas of
their own. Only states that exist in the mode are integrated. The map at the end applies the transition's
reset and relabelling, and evaluates its guard.

The closure of a smooth orbit is a leg that no transition ends. Where it begins with the force's period, T is
a multiple of period(p), which is traced, and neither it nor s is an input.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.problems import conserving
from contwalk.problems.orbit.itinerary import Leg
from contwalk.problems.tracing import parameter_symbols, refuse_time, refuse_time_of, time_refused
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

Scalar = Callable[[Any, Any, Any], Any]
# The time in a system that nobody has declared to depend on it.
TIME = "time"


@dataclass(frozen=True)
class ScalarInputs:
    """What a leg's functions depend on beside states, duration and starting time.

    Parameters
    ----------
    free : str or None
        Name of the free parameter; None for a path through the parameter space.
    moving : tuple of int
        On a path, positions of the parameters that change along it.
    pins : tuple of Neutral
        Pinned directions, along each of which there is a drift.
    """

    free: str | None
    moving: tuple[int, ...] = ()
    pins: tuple[Neutral, ...] = ()


@dataclass(frozen=True)
class Closing:
    """What follows the transition at the end of a leg that closes an orbit, and when it does.

    Parameters
    ----------
    image : str
        Symmetry that is applied after the transition; none if empty.
    power : int
        How many times it is applied.
    periods : float, optional
        The leg begins with the force's period and lasts so many of them: T and s are no inputs.
    """

    image: str = ""
    power: int = 1
    periods: float | None = None

    @property
    def images(self) -> list[str]:
        """The symmetries that are applied, one after the other."""
        return [self.image] * self.power


NOTHING_MORE, ONE_PERIOD = Closing(), Closing(periods=1.0)


class TracedLeg:
    """A leg of one mode, ended by one transition, as programs.

    The *columns* are its scalar inputs: duration T, starting time s (of forced systems), a drift for each
    pinned direction, and the free parameter, in this order.

    Parameters
    ----------
    system : System
    leg : Leg
    target : str
        Mode that it leads into.
    inputs : ScalarInputs
    closing : Closing
    holding : bool
        Whether conserved quantities are held at their values, as the equations of an orbit ask for.
    """

    def __init__(
        self,
        system: System,
        leg: Leg,
        target: str,
        inputs: ScalarInputs,
        closing: Closing = NOTHING_MORE,
        holding: bool = True,
    ) -> None:
        self.system, self.leg, self.target = system, leg, target
        self.inputs, self.closing, self.holding = inputs, closing, holding and bool(system.conserved)
        self.forced = system.period is not None
        self.states, self.following = system.states_of(leg.mode), system.states_of(target)
        count, timed = len(system.parameters), closing.periods is None
        self.groups = {
            "T": int(timed),
            "s": int(timed and self.forced),
            "a": len(inputs.pins),
            "l": 1,
            "b": count,
            "d": count,
        }

    @property
    def columns(self) -> list[tuple[str, int]]:
        """Inputs of the scalars, in their order."""
        return [(group, j) for group in "Tsal" for j in range(self.groups[group])]

    @property
    def mapped(self) -> bool:
        """Whether anything happens at its end."""
        return self.leg.transition is not None or bool(self.closing.image)

    def _arguments(self, tracer: Tracer) -> tuple[Any, np.ndarray, ParameterValues]:
        """Symbols for t, x and p; states that do not exist in the mode are zero."""
        x = np.full(len(self.system.states), 0.0, dtype=object)
        for k, i in enumerate(self.states):
            x[i] = tracer.symbol("u", k)
        p = self._parameters(tracer, self.system.mode(self.leg.mode).constants)
        return self._time(tracer, p), x, p

    def _duration(self, tracer: Tracer, p: ParameterValues) -> Any:
        if self.closing.periods is None:
            return tracer.symbol("T", 0)
        assert self.system.period is not None
        return self.closing.periods * rebound(self.system.period)(p)

    def _time(self, tracer: Tracer, p: ParameterValues) -> Any:
        if not self.forced:  # whatever reads it is refused: see `CompiledLeg`
            return tracer.symbol(TIME, 0)
        since = self._duration(tracer, p) * tracer.symbol("t", 0)
        return since if self.closing.periods is not None else tracer.symbol("s", 0) + since

    def _parameters(self, tracer: Tracer, constants: Mapping[str, Any]) -> ParameterValues:
        p = parameter_symbols(tracer, self.system.parameter_names, self.inputs.free, self.inputs.moving)
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
        for j, pin in enumerate(self.inputs.pins):
            out = _written(rebound(pin.generator), f"'{pin.name}'", states, t, x, p)
            rates = [r + tracer.symbol("a", j) * v for r, v in zip(rates, out, strict=True)]
        duration = self._duration(tracer, p)
        rates = [duration * r for r in rates]
        if not self.holding:
            return rates
        away = conserving.returning(tracer, self.system, mode.name, t, x, p)
        return [r - away[i] for r, i in zip(rates, states, strict=True)]

    @cached_property
    def program(self) -> Program:
        """The field over the leg."""
        return trace(self._rates)

    def _after(self, tracer: Tracer) -> list[Any]:
        """The state after the transition and its images, in the states of the target mode."""
        t, x, p = self._arguments(tracer)
        transition = self.leg.transition
        out = x
        if transition is not None and transition.reset is not None:
            out = np.full(len(x), None, dtype=object)
            rebound(transition.reset)(t, x, p, out)
        for name in (None if transition is None else transition.relabel, *self.closing.images):
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

    def _full_after(self, tracer: Tracer) -> np.ndarray:
        """The state after the transition, of full length."""
        there = np.full(len(self.system.states), 0.0, dtype=object)
        for i, entry in zip(self.following, self._after(tracer), strict=True):
            there[i] = entry
        return there

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

    def watched_program(self, function: Scalar) -> Program:
        """A scalar along the leg, then the field over it."""
        copy = rebound(function)
        return trace(lambda tracer: [copy(*self._arguments(tracer)), *self._rates(tracer)])

    def refuse_time(self, program: Program) -> None:
        """Refuse functions that depend on time in a system that is not declared to."""
        if program.reads(TIME):
            mode = self.system.mode(self.leg.mode)
            refuse_time(self.system, mode.name, mode.field, f"field of mode '{mode.name}'")
            for quantity in self.system.conserved:
                what = f"conserved quantity '{quantity.name}'"
                refuse_time_of(self.system, mode.name, quantity.of(mode.name), what)
            for pin in self.inputs.pins:
                refuse_time(self.system, mode.name, pin.generator, f"neutral direction '{pin.name}'")
            transition = self.leg.transition
            if transition is not None:
                what = f"transition '{transition.name}'"
                refuse_time_of(self.system, mode.name, transition.guard, f"guard of {what}")
                if transition.reset is not None:
                    refuse_time(self.system, mode.name, transition.reset, f"reset of {what}")
            raise time_refused(self.system, mode.field, f"guard or reset at the end of mode '{mode.name}'")


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
                f"{what} does not write entry {i} of its last argument.", "Every entry must be written."
            )
    return [out[i] for i in states]
