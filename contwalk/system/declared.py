"""What is declared of a machine, before anything of it is checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as attribute
from functools import cached_property
from typing import Any, TypeVar

from contwalk.system.modes import Condition, Mode, Transition
from contwalk.system.observables import Observable, Signal
from contwalk.system.special_points import KindOfPoint
from contwalk.system.starts import Start, Study
from contwalk.system.symmetries import Conserved, Neutral, Symmetry
from contwalk.system.variables import ConservedValue, Parameter, State

Kind = TypeVar("Kind", bound=KindOfPoint)


@dataclass(frozen=True)
class Declared:
    """What is declared of a machine, by kind, and the names of it; see `System`."""

    name: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    modes: tuple[Mode, ...]
    transitions: tuple[Transition, ...] = ()
    symmetries: tuple[Symmetry, ...] = ()
    neutral: tuple[Neutral, ...] = ()
    period: Callable[..., float] | None = None
    observables: tuple[Observable, ...] = ()
    starts: tuple[Start, ...] = ()
    presets: Mapping[str, Mapping[str, float]] = attribute(default_factory=dict)
    draw: Callable[..., None] | None = None
    reference: str = ""
    about: str = ""
    model: Mapping[str, Any] = attribute(default_factory=dict)
    source: str = ""
    loaded_from: str = ""
    conditions: tuple[Condition, ...] = ()
    signals: tuple[Signal, ...] = ()
    study: Study | None = None
    conserved: tuple[Conserved, ...] = ()
    fallen: Callable[..., float] | None = None
    point_types: tuple[KindOfPoint, ...] = ()

    @cached_property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states in their order."""
        return tuple(state.name for state in self.states)

    @cached_property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""
        return tuple(parameter.name for parameter in self.parameters)

    @cached_property
    def conserved_names(self) -> tuple[str, ...]:
        """Names of the parameters that are values of conserved quantities."""
        return tuple(quantity.name for quantity in self.conserved)

    @property
    def signal_names(self) -> tuple[str, ...]:
        """Names of the signals."""
        return tuple(signal.name for signal in self.signals)

    @cached_property
    def acting(self) -> tuple[Transition, ...]:
        """The transitions that do something: all but the watched ones."""
        return tuple(transition for transition in self.transitions if transition.role != "watched")

    def point_types_of(self, kind: type[Kind]) -> tuple[Kind, ...]:
        """The kinds of special points of its own that are of a class: of equilibria, or of orbits."""
        return tuple(own for own in self.point_types if isinstance(own, kind))

    @property
    def has_events(self) -> bool:
        """Whether its orbits meet events, or limits where watched transitions are touched."""
        return bool(self.transitions)


def with_conserved(system: Declared) -> tuple[Parameter, ...]:
    """The parameters, with the values of conserved quantities, declared as such or not."""
    # Not by `parameter_names`, which are kept and would be those from before.
    known, quantities = (
        {entry.name for entry in system.parameters},
        {entry.name for entry in system.conserved},
    )
    declared = [
        ConservedValue(**vars(parameter)) if parameter.name in quantities else parameter
        for parameter in system.parameters
    ]
    added = [
        ConservedValue(entry.name, math.nan, entry.unit, about=entry.about)
        for entry in system.conserved
        if entry.name not in known
    ]
    return (*declared, *added)
