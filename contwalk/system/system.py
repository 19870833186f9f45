"""A machine, and what is looked up of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.column_names import SPLIT
from contwalk.errors import StartError, SystemDefinitionError, called
from contwalk.memory import memory_of, remembered
from contwalk.system.at_one_instant import before_others, in_declared_order
from contwalk.system.checks import check_labels, check_presets, check_references, entries_of
from contwalk.system.declared import Declared, with_conserved
from contwalk.system.maps import iterated
from contwalk.system.modes import Condition, Mode, Transition
from contwalk.system.names import is_number, nearest, require_callable, require_name, require_texts
from contwalk.system.observables import Observable, Signal, with_extremes
from contwalk.system.parameter_values import ParameterValues
from contwalk.system.special_points import KindOfPoint
from contwalk.system.starts import Start
from contwalk.system.symmetries import Conserved, Neutral, Symmetry
from contwalk.system.units import lasting, time_unit
from contwalk.system.variables import Parameter, State

_TUPLES: dict[str, type] = {
    "states": State,
    "parameters": Parameter,
    "modes": Mode,
    "transitions": Transition,
    "symmetries": Symmetry,
    "neutral": Neutral,
    "observables": Observable,
    "starts": Start,
    "conditions": Condition,
    "signals": Signal,
    "conserved": Conserved,
    "point_types": KindOfPoint,
}


@dataclass(frozen=True)
class System(Declared):
    """A machine: states, parameters, modes, transitions, and what is known about them.

    Parameters
    ----------
    name : str
    states, parameters, modes, transitions, symmetries, neutral, observables, starts, conditions : tuple
    signals, conserved, point_types : tuple
        The declarations of this module.
    period : callable, optional
        `period(p)`, in seconds, of the forcing of a time-periodic system.
    presets : mapping, optional
        Named parameter sets: `{"name": {"parameter": value}}`.
    draw : callable, optional
        `draw(axes, t, x, p)` draws the machine at one instant on matplotlib axes. One that takes `so_far`,
        the motion until then, draws it where it has got to.
    fallen : callable, optional
        `fallen(t, x, p)` at a state of full length, positive where the machine has fallen: tests of survival
        end there.
    reference : str
        Where the equations come from.
    """

    def __post_init__(self) -> None:
        require_name("A system", self.name)
        require_texts(f"System '{self.name}'", self, "reference", "about")
        for what, kind in _TUPLES.items():
            object.__setattr__(self, what, entries_of(self, what, kind))
        iterated(self)
        object.__setattr__(self, "parameters", with_conserved(self))
        object.__setattr__(self, "observables", with_extremes(self.observables, self.signals))
        if self.period is not None:
            require_callable(f"The period of system '{self.name}'", self.period)
        if self.draw is not None:
            require_callable(f"draw of system '{self.name}'", self.draw)
        if self.fallen is not None:
            require_callable(f"fallen of system '{self.name}'", self.fallen)
        check_labels(self)
        check_presets(self)
        for name in () if self.study is None else (self.study.parameter, *self.study.parameters):
            self.require_parameter(name)
        for what in ("states", "modes"):
            if not getattr(self, what):
                raise SystemDefinitionError(f"System '{self.name}' has no {what}.", f"Declare {what}=(...,).")
        check_references(self)

    def __repr__(self) -> str:
        counted = {
            "state": self.states,
            "parameter": self.parameters,
            "mode": self.modes,
            "transition": self.transitions,
        }
        told = [
            f"{len(entries)} {what}{'' if len(entries) == 1 else 's'}"
            for what, entries in counted.items()
            if entries
        ]
        return f"<System '{self.name}': {', '.join(told)}>"

    def defaults(self) -> dict[str, float]:
        """Default values of all parameters."""
        return {parameter.name: float(parameter.default) for parameter in self.parameters}

    def require_parameter(self, name: str) -> None:
        """Refuse a name that is no parameter.

        Raises
        ------
        SystemDefinitionError
        """
        if name not in self.parameter_names:
            known = self.parameter_names
            raise SystemDefinitionError(
                f"'{name}' is not a parameter of '{self.name}'.",
                f"Known: {', '.join(known)}. {nearest(str(name), known)}".strip(),
            )

    def all_parameters(self, given: Mapping[str, Any]) -> dict[str, float]:
        """Values of all parameters, in their order, from a mapping that has them all.

        Raises
        ------
        SystemDefinitionError
            If one is missing, unknown, or no number.
        """
        given = dict.fromkeys(self.conserved_names, math.nan) | dict(given)
        missing = [name for name in self.parameter_names if name not in given]
        if missing:
            raise SystemDefinitionError(
                f"The parameters of '{self.name}' lack {', '.join(missing)}.",
                "Give a value of each; system.defaults() | {'name': value} changes some of the defaults.",
            )
        for name in given:
            self.require_parameter(name)
        wrong = [name for name, value in given.items() if not is_number(value)]
        if wrong:
            raise SystemDefinitionError(
                f"The parameter {wrong[0]} of '{self.name}' is {given[wrong[0]]!r}.", "Give a number."
            )
        return {name: float(given[name]) for name in self.parameter_names}

    @cached_property
    def time_unit(self) -> str:
        """The unit of time that the declared units imply; empty where they imply none."""
        declared: list[Any] = [*self.states, *self.parameters, *self.observables, *self.signals]
        return time_unit(quantity.unit for quantity in [*declared, *self.conditions])

    def lasting(self, time: float, form: str = ".6g") -> str:
        """A duration or an instant with the unit of time."""
        return lasting(time, self.time_unit, form)

    def mode(self, name: str) -> Mode:
        """The mode of this name."""
        return self._modes[name]

    @cached_property
    def _modes(self) -> dict[str, Mode]:
        return {mode.name: mode for mode in self.modes}

    @property
    def mode_kept(self) -> dict[str, str]:
        """Of which mode its equilibria are, where it has several, as their stored branches keep it."""
        return {"mode": self.modes[0].name} if len(self.modes) > 1 else {}

    def beginning_in(self, mode: str | None) -> System:
        """The same system with another mode as the first one: that of its equilibria. It is made once.

        None leaves the first one as it is.
        """
        if mode in (None, self.modes[0].name):
            return self
        order = tuple(sorted(self.modes, key=lambda each: each.name != mode))
        return remembered(memory_of(self, "modes"), mode, len(order), lambda: replace(self, modes=order))

    def states_of(self, mode: str) -> tuple[int, ...]:
        """Positions of the states that exist in a mode, in the order of the states."""
        names = self.mode(mode).states
        return tuple(i for i, name in enumerate(self.state_names) if names is None or name in names)

    def leaving(self, mode: str) -> tuple[Transition, ...]:
        """The transitions out of a mode, watched ones included: as declared, but for a declared order."""
        return self._leaving.get(mode, ())

    @cached_property
    def _leaving(self) -> dict[str, tuple[Transition, ...]]:
        found: dict[str, list[Transition]] = {}
        for transition in self.transitions:
            found.setdefault(transition.source, []).append(transition)
        return {mode: in_declared_order(each, self.earlier_at_once) for mode, each in found.items()}

    @cached_property
    def earlier_at_once(self) -> dict[str, frozenset[str]]:
        """Names of the transitions that act before one of a name where they have the same instant."""
        return before_others(self.transitions)

    def transition(self, name: str, source: str | None = None) -> Transition:
        """A transition by its name, and by the mode that it leads out of where several have the name.

        Raises
        ------
        ValueError
            If there is none, or more than one.
        """
        found = [source] if source is not None else self.sources(name)
        if len(found) != 1:
            raise ValueError(f"{len(found)} transitions '{name}'")
        return next(transition for transition in self.leaving(found[0]) if transition.name == name)

    def sources(self, name: str) -> tuple[str, ...]:
        """The modes that transitions of a name lead out of."""
        return self._sources.get(name, ())

    @cached_property
    def _sources(self) -> dict[str, tuple[str, ...]]:
        found: dict[str, list[str]] = {}
        for transition in self.transitions:
            found.setdefault(transition.name, []).append(transition.source)
        return {name: tuple(sources) for name, sources in found.items()}

    def modes_around(self, mode: str) -> tuple[str, ...]:
        """The modes that soft transitions lead to from a mode, itself first."""
        found = [mode]
        for name in found:  # grows meanwhile
            for transition in self.leaving(name):
                if transition.role == "soft" and transition.target not in found:
                    found.append(transition.target)
        return tuple(found)

    def symmetry(self, name: str) -> Symmetry:
        """The symmetry of this name."""
        return next(symmetry for symmetry in self.symmetries if symmetry.name == name)

    @property
    def margins(self) -> tuple[str, ...]:
        """Names of what must stay positive: watched transitions and conditions."""
        watched = [transition.name for transition in self.transitions if transition.role == "watched"]
        return tuple(dict.fromkeys([*watched, *(condition.name for condition in self.conditions)]))

    def left_at_zero(self, last: str, mode: str) -> frozenset[str]:
        """Transitions out of a mode whose guards are zero right after one named `last` has led into it.

        It is one of them where there is one of its name; so is its reverse, which has the same guard.
        """
        guards = self._entering.get((last, mode), ())
        return frozenset({last} | {t.name for t in self.leaving(mode) if t.guard in guards})

    def passed(self, last: str, mode: str) -> frozenset[str]:
        """Transitions out of a mode whose guards one named `last` has just passed in their own direction.

        They are edges: where the guard goes on that way, it has to come back before they happen again.
        """
        if (last, mode) not in self._passed:
            ways = self._entering.get((last, mode), {})
            self._passed[last, mode] = frozenset(
                t.name for t in self.leaving(mode) if not t.at_entry and t.direction in ways.get(t.guard, ())
            )
        return self._passed[last, mode]

    @cached_property
    def _passed(self) -> dict[tuple[str, str], frozenset[str]]:
        """Answers of `passed`, which is asked for every guard of every leg of each solution."""
        return {}

    @cached_property
    def _entering(self) -> dict[tuple[str, str], dict[Callable[..., float], set[str]]]:
        """Guards of the transitions of a name into a mode, and the directions in which they pass zero."""
        found: dict[tuple[str, str], dict[Callable[..., float], set[str]]] = {}
        for transition in self.transitions:
            into = found.setdefault((transition.name, transition.target), {})
            into.setdefault(transition.guard, set()).add(transition.direction)
        return found

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Names of the observables, of a hybrid system with the margins that its branches tell as well."""
        own = tuple(observable.name for observable in self.observables)
        if not self.has_events:
            return own
        return (*own, *(name for name in self.margins if name not in own), SPLIT)

    def start(self, name: str) -> Start:
        """The named start; `StartError` with the known names otherwise."""
        for start in self.starts:
            if start.name == name:
                return start
        known = [start.name for start in self.starts]
        raise StartError(
            f"System '{self.name}' has no equilibrium named '{name}'.",
            f"Known: {', '.join(known)}. {nearest(name, known)}".strip()
            if known
            else "It names none: give the state itself, as in start: {state: {...}}.",
        )

    def named_states(self, name: str, parameters: Mapping[str, float]) -> list[np.ndarray]:
        """States of the named start at these parameters, each of shape (n,).

        Raises
        ------
        StartError
            Where the equilibrium does not exist at these parameters.
        """
        start = self.start(name)
        found = called(f"start '{name}'", start.states, ParameterValues(**parameters))
        states = [np.asarray(x, dtype=float) for x in found]
        if not states:
            reason = f" It exists {start.exists}." if start.exists else ""
            raise StartError(
                f"The equilibrium '{name}' of '{self.name}' does not exist at these parameters.{reason}",
                "Change the parameters of the start.",
            )
        for x in states:
            if x.shape != (len(self.states),):
                raise SystemDefinitionError(
                    f"Start '{name}' of '{self.name}' gives a state of shape {x.shape}.",
                    f"It must have {len(self.states)} entries.",
                )
        return states
