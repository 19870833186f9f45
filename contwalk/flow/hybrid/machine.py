"""A hybrid machine at given parameters: what moves it in each mode, and what its transitions do."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.field import Field
from contwalk.flow.events.guard import EPSILON, Guard
from contwalk.flow.events.jump_instants import JumpInstants
from contwalk.flow.forcing import answered
from contwalk.flow.hybrid.code import HybridCode, ModeCode, hybrid_code
from contwalk.flow.hybrid.guard_taylor import GuardTaylor
from contwalk.system import System, Transition


class ModeFlow:
    """One mode at given parameters.

    Attributes
    ----------
    name : str
    states : ndarray of int
        Positions of the states that exist in it.
    field : CompiledField
    p, c : ndarray
        Parameters, and the field's constants made from them.
    transitions : tuple of Transition
        Those out of it, watched ones included, in the order of their declaration.
    guards : tuple of Guard
        Theirs; they take states of the mode only, as the field does.
    """

    def __init__(self, code: ModeCode, p: np.ndarray) -> None:
        self.code, self.name, self.states = code, code.name, code.states
        self.field, self.p, self.c = code.field, p, code.field.constants(p)
        self.transitions: tuple[Transition, ...] = code.transitions
        self.guards: tuple[Guard, ...] = code.guards
        self._constants: dict[int, np.ndarray] = {}

    @cached_property
    def guard_taylor(self) -> GuardTaylor:
        """Memory for an instant at which a motion begins."""
        return GuardTaylor(self.field, self.c, self.p)

    @cached_property
    def jump_instants(self) -> JumpInstants | None:
        """Where guards jump, or their slopes do, whatever the states are; None if nowhere."""
        if not self.code.time_choices or self.period is None:
            return None
        return JumpInstants(self.code.time_choices, self.p, self.period)

    @cached_property
    def period(self) -> float | None:
        """That of the forcing; None where there is none, or none that could be one.

        Raises
        ------
        PluginError
            If the plugin's function fails.
        """
        system = self.code.system
        if system.period is None:
            return None
        period = answered(system, dict(zip(system.parameter_names, self.p.tolist(), strict=True)))
        return period if 0.0 < period < math.inf else None

    def constants(self, field: CompiledField) -> np.ndarray:
        """The constants, shape (k,), of another field of the same parameters."""
        if id(field) not in self._constants:
            self._constants[id(field)] = field.constants(self.p)
        return self._constants[id(field)]

    def passed(self, last: str | None) -> frozenset[str]:
        """As `System.passed` of the mode."""
        return frozenset() if last is None else self.code.system.passed(last, self.name)

    def left_at_zero(self, last: str | None) -> frozenset[str]:
        """Transitions whose guards are zero right after one of a name has led here."""
        return frozenset() if last is None else self.code.system.left_at_zero(last, self.name)

    def acting(self, number: int) -> bool:
        """Whether a transition does something."""
        return self.transitions[number].role != "watched"

    def scales(self, t: float, x: np.ndarray, weights: np.ndarray, span: float) -> np.ndarray:
        """What typical changes of the states make of the guards; shape (g,).

        Parameters
        ----------
        t, x
            Time, and the states of the mode.
        weights : ndarray
            Their magnitudes.
        span : float
            A typical time, for guards that depend on time alone.
        """
        if not self.guards:
            return np.empty(0)
        slopes = [guard.slopes(t, x, self.p, np.zeros(len(x))) for guard in self.guards]
        # math.hypot, since squares of what is large or small in units of the guard overflow or vanish.
        by_states = np.array([math.hypot(*(each.gradient[1:] * weights)) for each in slopes])
        of_time = np.array([max(abs(each.value), abs(each.gradient[0]) * span) for each in slopes])
        found = np.where(by_states > 0.0, by_states, of_time)
        return np.where(np.isfinite(found) & (found > 0.0), found, 1.0)


class HybridMachine:
    """A hybrid system at given parameters.

    Attributes
    ----------
    system : System
    parameters : dict
    p : ndarray
        Their values in the order of the system.
    """

    def __init__(self, code: HybridCode, parameters: Mapping[str, float]) -> None:
        self.code, self.system = code, code.system
        self.parameters = {name: float(parameters[name]) for name in self.system.parameter_names}
        self.p = np.array(list(self.parameters.values()), dtype=float)
        self._modes: dict[str, ModeFlow] = {}
        self._constants: dict[tuple[str, str], np.ndarray] = {}

    def at(self, parameters: Mapping[str, float]) -> HybridMachine:
        """The same machine with these parameters changed; nothing is compiled anew."""
        return HybridMachine(self.code, {**self.parameters, **parameters})

    def mode(self, name: str) -> ModeFlow:
        """A mode by its name; compiled when it is first used."""
        if name not in self._modes:
            self._modes[name] = ModeFlow(self.code.mode(name), self.p)
        return self._modes[name]

    @cached_property
    def guards_jump_in_time(self) -> bool:
        """Whether guards, or their slopes, jump at instants of time in some mode, whatever the states are."""
        if self.system.period is None:
            return False
        return any(self.mode(mode.name).jump_instants is not None for mode in self.system.modes)

    def transition(self, name: str, source: str | None = None) -> Transition:
        """A transition by its name, and the mode it leads out of where several have the name."""
        return self.system.transition(name, source)

    def jump(self, transition: Transition) -> tuple[Field, np.ndarray]:
        """Reset and relabelling of a transition as a map, and its constants, shape (k,).

        The map's inputs are the time and the states of the source, its outputs the states of the target and,
        last, the guard.
        """
        key, jump = (transition.name, transition.source), self.code.jump(transition)
        if key not in self._constants:
            self._constants[key] = jump.constants(self.p)
        return jump, self._constants[key]

    def full(self, mode: str, x: np.ndarray) -> np.ndarray:
        """States of a mode, shape (.., m), among all states, shape (.., n); those that do not exist are 0."""
        result = np.zeros((*np.shape(x)[:-1], len(self.system.states)))
        result[..., self.mode(mode).states] = x
        return result

    def existing(self, mode: str, x: Sequence[float] | np.ndarray) -> np.ndarray:
        """A full-length state with 0 for what does not exist in the mode."""
        return self.full(mode, np.asarray(x, dtype=float)[..., self.mode(mode).states])


def hybrid_machine(system: System, parameters: Mapping[str, float]) -> HybridMachine:
    """The machine of a system at these values of all parameters."""
    return HybridMachine(hybrid_code(system), parameters)


def applied(machine: HybridMachine, transition: Transition, t: float, x: np.ndarray) -> np.ndarray:
    """The full-length state after a transition: its reset, then its relabelling; NaN where they fail."""
    jump, c = machine.jump(transition)
    before = np.asarray(x, dtype=float)[machine.mode(transition.source).states]
    return machine.full(transition.target, jump(0.0, np.concatenate([[t], before]), c)[:-1])


def displaced(flow: ModeFlow, t: float, x: np.ndarray) -> np.ndarray:
    """How far rounding of an event's time carries each state: as fast as it goes; of full length."""
    own = np.asarray(x, dtype=float)[flow.states]
    found = np.zeros(len(flow.code.system.states))
    found[flow.states] = np.abs(flow.field(t, own, flow.c)) * EPSILON * abs(t)
    return found


def landed(
    machine: HybridMachine, transition: Transition, t: float, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """As `applied`, with how far rounding carries each state after it: both of shape (n,)."""
    jump, c = machine.jump(transition)
    source = machine.mode(transition.source)
    before = np.asarray(x, dtype=float)[source.states]
    at, moved = np.concatenate([[t], before]), displaced(source, t, x)[source.states]
    given = np.concatenate([[EPSILON * abs(t)], EPSILON * np.abs(before) + moved])
    after = jump(0.0, at, c)[:-1]
    noise = EPSILON * np.abs(after) + np.abs(jump.jacobian(0.0, at, c)[:-1]) @ given
    return machine.full(transition.target, after), machine.full(transition.target, noise)
