"""A system in other units: each function of the plugin between a change to its own units and one back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.system import System
from contwalk.workflow.stress.units import Units

Function = Callable[..., Any]


class OwnParameters:
    """Parameters by name in the plugin's own units; the constants of modes are as they are."""

    def __init__(self, given: Any, factors: Mapping[str, float]) -> None:
        self._given, self._factors = given, factors

    def __getattr__(self, name: str) -> Any:
        value, factor = getattr(self._given, name), self._factors.get(name, 1.0)
        return value if factor == 1.0 else value / factor


class _Functions:
    """The functions of a system in other units; each has one image, since the same function is one event."""

    def __init__(self, units: Units) -> None:
        self._units, self._known = units, dict[tuple[int, str], tuple[Function, Function]]()

    def number(self, function: Function) -> Function:
        """Of t, x and p; what it returns has a unit of its own, which stays."""
        return self._kept(function, "number", self._number)

    def rate(self, function: Function) -> Function:
        """A field: rates of the states are written."""
        return self._kept(
            function, "rate", lambda f: self._writing(f, self._units.factors / self._units.time)
        )

    def state(self, function: Function) -> Function:
        """A reset or an image: states are written."""
        return self._kept(function, "state", lambda f: self._writing(f, self._units.factors))

    def scaled(self, function: Function, factor: float) -> Function:
        """Of p alone, or of t, x and p: what it returns is multiplied by the factor."""
        units = self._units
        factors = units.parameters

        def of_parameters(p: Any) -> Any:
            return function(OwnParameters(p, factors)) * factor

        return of_parameters

    def conserved(self, function: Function, factor: float) -> Function:
        """A conserved quantity, whose value is a parameter."""
        own = self.number(function)

        def quantity(t: Any, x: Any, p: Any) -> Any:
            return own(t, x, p) * factor

        return self._kept(function, f"conserved {factor}", lambda f: quantity)

    def starts(self, function: Function) -> Function:
        """Equilibria in closed form."""
        units = self._units

        def states(p: Any) -> list[list[float]]:
            found = function(OwnParameters(p, units.parameters))
            return [units.new(np.asarray(x, dtype=float)).tolist() for x in found]

        return states

    def _kept(self, function: Function, what: str, make: Callable[[Function], Function]) -> Function:
        key = id(function), what
        if key not in self._known:
            self._known[key] = function, make(function)  # the function itself, so that its id stays its own
        return self._known[key][1]

    def _number(self, function: Function) -> Function:
        places, factors, time = self._units.places, self._units.factors, self._units.time
        parameters = self._units.parameters

        def number(t: Any, x: Any, p: Any) -> Any:
            return function(t / time, x[..., places] / factors, OwnParameters(p, parameters))

        return number

    def _writing(self, function: Function, becomes: np.ndarray) -> Function:
        places, factors, time = self._units.places, self._units.factors, self._units.time
        parameters, number = self._units.parameters, len(self._units.places)

        def written(t: Any, x: Any, p: Any, result: Any) -> None:
            own = np.zeros(number)
            function(t / time, x[places] / factors, OwnParameters(p, parameters), own)
            for i in range(number):
                result[places[i]] = own[i] * becomes[i]

        return written


def rescaled_system(system: System, units: Units) -> System:
    """The same machine in other units. It draws nothing, and its figures have no signals."""
    made = _Functions(units)
    by_name = {state.name: state for state in system.states}
    states = tuple(
        replace(
            by_name[name],
            scale=_times(by_name[name].scale, units.states[name]),
            period=_times(by_name[name].period, units.states[name]),
        )
        for name in units.order
    )
    parameters = tuple(
        replace(
            each,
            default=each.default * units.parameters[each.name],
            bounds=(
                _times(each.bounds[0], units.parameters[each.name]),
                _times(each.bounds[1], units.parameters[each.name]),
            ),
        )
        for each in system.parameters
    )
    transitions = tuple(
        replace(
            each,
            guard=made.number(each.guard),
            reset=None if each.reset is None else made.state(each.reset),
        )
        for each in system.transitions
    )
    conserved = tuple(
        replace(
            each,
            function={
                mode: made.conserved(function, units.parameters[each.name])
                for mode, function in each.function.items()
            }
            if isinstance(each.function, Mapping)
            else made.conserved(each.function, units.parameters[each.name]),
        )
        for each in system.conserved
    )
    return replace(
        system,
        states=states,
        parameters=parameters,
        modes=tuple(replace(mode, field=made.rate(mode.field)) for mode in system.modes),
        transitions=transitions,
        symmetries=tuple(replace(each, map=made.state(each.map)) for each in system.symmetries),
        neutral=tuple(replace(each, generator=made.state(each.generator)) for each in system.neutral),
        conserved=conserved,
        period=None if system.period is None else made.scaled(system.period, units.time),
        observables=tuple(replace(o, function=made.number(o.function)) for o in system.observables),
        conditions=tuple(replace(each, function=made.number(each.function)) for each in system.conditions),
        starts=tuple(replace(start, states=made.starts(start.states)) for start in system.starts),
        presets={name: in_units(values, units) for name, values in system.presets.items()},
        fallen=None if system.fallen is None else made.number(system.fallen),
        draw=None,
        signals=(),
        study=None,
    )


def in_units(values: Mapping[str, float], units: Units) -> dict[str, float]:
    """Parameters, or what else is named, in the new units."""
    return {name: value * units.of(name) for name, value in values.items()}


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor
