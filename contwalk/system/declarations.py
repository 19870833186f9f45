"""Declarations a plugin is made of. Data only: nothing here computes.

Rules of the contract
---------------------
1. `field(t, x, p, dx)`, `reset(t, x, p, x_plus)`, `Symmetry.map(t, x, p, x_image)` and
   `Neutral.generator(t, x, p, v)` write every entry of their last argument and return nothing;
   `guard(t, x, p)` returns a number.
2. `x` is indexed by constants, `p` is read by name (`p.omega`).
3. The functions are plain numeric Python: arithmetic, `math`, `numpy` scalars and loops with known bounds.
   Exact derivatives of every order are taken from them; a plugin never supplies one.
"""

from __future__ import annotations

import keyword
import math
import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as attribute
from difflib import get_close_matches
from functools import cached_property
from itertools import combinations
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from contwalk.errors import StartError, SystemDefinitionError, UnsupportedOperation, called
from contwalk.system.units import lasting, time_unit

ROLES_OF_TRANSITIONS = ("hard", "soft", "watched")
ROLES_OF_SYMMETRIES = ("relabel", "spatial")
DIRECTIONS = ("falling", "rising", "both")
SIDES = ("before", "after")
# Of hybrid orbits: signed square of the smallest difference between two multipliers, zero where a pair turns
# real.
SPLIT = "split"

# What branches, tables and figures call their own columns. `s`, `step` and `error` may be used: `branch["s"]`
# is then the state, and tables put its kind in front.
_OF_POINTS = "stable unstable admissible special special_point period spectrum spectrum_error trivial_error"
_OF_ROWS = "free state observables unknowns tangent weights residual iterations rhs seconds"
RESERVED = frozenset(f"{_OF_POINTS} {_OF_ROWS} max_re max_abs path {SPLIT}".split())
_COLUMN_OF_SPECTRUM = re.compile(r"(re|im)_\d+")


def nearest(name: str, known: Sequence[str]) -> str:
    """Words that name the nearest known name, for error messages; empty when nothing is near."""
    match = get_close_matches(name, list(known), n=1, cutoff=0.5)
    return f"Did you mean '{match[0]}'?" if match else ""


class ParameterValues(SimpleNamespace):
    """Parameters by name, as a plugin's functions read them: `p.omega`."""

    def __getattr__(self, name: str) -> Any:
        hint = nearest(name, list(vars(self)))
        raise AttributeError(f"the system has no parameter '{name}'" + (f" ({hint})" if hint else ""))

    def __setattr__(self, name: str, value: Any) -> None:
        raise UnsupportedOperation(
            f"The function writes to the parameters: p.{name} = ... is not possible.",
            "Parameters are read only: use a variable.",
        )

    def __delattr__(self, name: str) -> None:
        raise UnsupportedOperation(f"The function deletes p.{name}.", "Parameters are read only.")


def _a(kind: str) -> str:
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"


def _require_name(what: str, name: Any) -> None:
    if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
        raise SystemDefinitionError(
            f"{what} has the name {name!r}, which is not a valid Python identifier.",
            "Use letters, digits and underscores, not starting with a digit.",
        )
    written = unicodedata.normalize("NFKC", name)
    if written != name:  # Python reads p.name so, and would not find it
        raise SystemDefinitionError(
            f"{what} has the name {name!r} ({name!a}), which Python reads as {written!r} ({written!a}).",
            f"Name it {written!r}.",
        )


def _is_number(value: Any) -> bool:
    """Whether this is a real number, and no larger than floats are."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool):
        return abs(int(value)) < 10**300
    return isinstance(value, float | np.floating)


def _shown(value: Any) -> str:
    """A wrong value in a message: of functions and of declarations what they are called."""
    if callable(value):
        return f"the function {getattr(value, '__name__', type(value).__name__)}"
    if hasattr(value, "__dataclass_fields__") and hasattr(value, "name"):
        return f"{type(value).__name__}({value.name!r}, ...)"
    return repr(value)


def _require_texts(what: str, declared: Any, *names: str) -> None:
    for name in names:
        text = getattr(declared, name)
        if not isinstance(text, str):
            raise SystemDefinitionError(f"{what} has {name} {text!r}.", f"A {name} is a text.")


def _require_callable(what: str, function: Any) -> None:
    if not callable(function):
        raise SystemDefinitionError(f"{what} is {function!r}.", "It must be a function.")


def _require_side(what: str, side: Any) -> None:
    if side not in SIDES:
        raise SystemDefinitionError(f"{what} has side {side!r}.", f"Allowed: {', '.join(SIDES)}.")


@dataclass(frozen=True)
class State:
    """One state variable.

    Parameters
    ----------
    name : str
    unit : str
        Unit as text, `"1"` where dimensionless.
    scale : float, optional
        A typical magnitude. It only weighs the state in step lengths; without it one is estimated.
    about : str
        One line of meaning.
    period : float, optional
        For an angle, its period (`2 * math.pi`): states that differ by it are the same motion.
    """

    name: str
    unit: str = "1"
    scale: float | None = None
    about: str = ""
    period: float | None = None

    def __post_init__(self) -> None:
        _require_name("A state", self.name)
        _require_texts(f"State '{self.name}'", self, "unit", "about")
        for what, value in (("scale", self.scale), ("period", self.period)):
            if value is not None and not (_is_number(value) and 0 < value < math.inf):
                raise SystemDefinitionError(
                    f"State '{self.name}' has {what} {value!r}.", f"A {what} is a positive number."
                )


@dataclass(frozen=True)
class Parameter:
    """One parameter, with its default, unit, bounds (`None` where unbounded) and one line of meaning."""

    name: str
    default: float
    unit: str = "1"
    bounds: tuple[float | None, float | None] = (None, None)
    about: str = ""
    # Whether it is the value of a conserved quantity.
    conserved: ClassVar[bool] = False

    def __post_init__(self) -> None:
        _require_name("A parameter", self.name)
        _require_texts(f"Parameter '{self.name}'", self, "unit", "about")
        if not _is_number(self.default):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has the default {self.default!r}.", "A default is a number."
            )
        if not (isinstance(self.bounds, tuple | list) and len(self.bounds) == 2) or not all(
            bound is None or (_is_number(bound) and not math.isnan(bound)) for bound in self.bounds
        ):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has bounds {self.bounds!r}.",
                "Bounds are a pair of numbers, None where it is unbounded: (0.0, None).",
            )
        low, high = self.bounds
        if low is not None and high is not None and low > high:
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has bounds {self.bounds}.", "The lower bound comes first."
            )
        if not self.allows(self.default) and not (self.conserved and math.isnan(self.default)):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has the default {self.default}, outside its bounds "
                f"{self.interval()}.",
                "A default is a finite number within the bounds.",
            )

    def allows(self, value: float) -> bool:
        """Whether `value` lies within the bounds."""
        low, high = self.bounds
        return bool(np.isfinite(value)) and (low is None or value >= low) and (high is None or value <= high)

    def interval(self) -> str:
        """The bounds as text: `[0, inf)`."""
        low, high = self.bounds
        left = "(-inf" if low is None else f"[{low:g}"
        right = "inf)" if high is None else f"{high:g}]"
        return f"{left}, {right}"


class ConservedValue(Parameter):
    """The value of a conserved quantity: its default may be NaN, for what the start has of it."""

    conserved = True


@dataclass(frozen=True)
class Mode:
    """A smooth phase of motion with its vector field `field(t, x, p, dx)`.

    `states` names the states that exist in it; without it all do. One that does not exist is zero while the
    mode lasts: it is not integrated, the field need not write its rate, and a reset into the mode need not
    write its value.

    `constants` are numbers that the field, and the guards, resets and conditions of the mode, read as
    `p.name`. Modes with the same field function and the same names of constants are compiled once.
    """

    name: str
    field: Callable[..., None]
    about: str = ""
    states: tuple[str, ...] | None = None
    constants: Mapping[str, float] = attribute(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        _require_name("A mode", self.name)
        _require_callable(f"The field of mode '{self.name}'", self.field)
        if isinstance(self.states, str):
            raise SystemDefinitionError(
                f"Mode '{self.name}' has states {self.states!r}.", "Give a tuple of names, as in ('x', 'y')."
            )
        if not isinstance(self.constants, Mapping):
            raise SystemDefinitionError(
                f"Mode '{self.name}' has constants {self.constants!r}.", "Give a mapping: {'name': 1.0}."
            )
        for name, value in self.constants.items():
            _require_name(f"A constant of mode '{self.name}'", name)
            if not isinstance(value, int | float) or not math.isfinite(value):
                raise SystemDefinitionError(
                    f"The constant '{name}' of mode '{self.name}' is {value!r}.",
                    "It must be a finite number.",
                )

    @property
    def code(self) -> tuple:
        """Equal for modes that are compiled as one."""
        return (self.field, *self.constants) if self.constants else (self.name,)


@dataclass(frozen=True)
class Transition:
    """An event that leads from mode `source` to mode `target`.

    It happens where `guard(t, x, p)` passes zero in `direction` (`falling`, `rising`, `both`); then
    `reset(t, x, p, x_plus)` gives the state after it (without one the state is kept). `role` is `hard`,
    `soft` (the field switches continuously) or `watched` (reported, not acted on). `relabel` names a symmetry
    of role `relabel` that is applied after the reset: what was called leg 1 is called leg 2 from there on.

    With `level` it happens as well, at once, where mode `source` is entered with the guard past zero: which
    mode the machine is in then follows from where it is. Soft transitions always do.
    """

    name: str
    source: str
    target: str
    guard: Callable[..., float]
    direction: str = "falling"
    reset: Callable[..., None] | None = None
    role: str = "hard"
    about: str = ""
    relabel: str | None = None
    level: bool = False

    def __post_init__(self) -> None:
        _require_name("A transition", self.name)
        _require_callable(f"The guard of transition '{self.name}'", self.guard)
        if self.reset is not None:
            _require_callable(f"The reset of transition '{self.name}'", self.reset)
        if self.direction not in DIRECTIONS:
            raise SystemDefinitionError(
                f"Transition '{self.name}' has direction {_shown(self.direction)}.",
                f"Allowed: {', '.join(DIRECTIONS)}.",
            )
        if self.role not in ROLES_OF_TRANSITIONS:
            raise SystemDefinitionError(
                f"Transition '{self.name}' has role {_shown(self.role)}.",
                f"Allowed: {', '.join(ROLES_OF_TRANSITIONS)}.",
            )
        if self.level not in (True, False):
            raise SystemDefinitionError(
                f"Transition '{self.name}' has level {self.level!r}.", "Allowed: True, False."
            )
        if self.level and (self.direction == "both" or self.role == "watched"):
            raise SystemDefinitionError(
                f"Transition '{self.name}' has level=True, but "
                + ("no side of its guard is past zero." if self.direction == "both" else "does not act."),
                "Give it a direction, 'falling' or 'rising', and a role that acts, or leave level out.",
            )

    @property
    def at_entry(self) -> bool:
        """Whether it happens at once where its mode is entered with its guard past zero."""
        return self.level or self.role == "soft"


@dataclass(frozen=True)
class Symmetry:
    """A map of the state space that takes motions to motions: `map(t, x, p, x_image)`.

    `role` is `relabel` (both configurations are the same thing with names swapped) or `spatial` (the image
    is another motion). `modes` and `events` name the images of modes and of transitions, as far as they
    differ from themselves: the left foot's touchdown is the right foot's in a mirror.
    """

    name: str
    role: str
    map: Callable[..., None]
    about: str = ""
    modes: Mapping[str, str] = attribute(default_factory=dict)
    events: Mapping[str, str] = attribute(default_factory=dict)

    def __post_init__(self) -> None:
        _require_name("A symmetry", self.name)
        _require_callable(f"The map of symmetry '{self.name}'", self.map)
        for what, images in (("modes", self.modes), ("events", self.events)):
            if not isinstance(images, Mapping):
                raise SystemDefinitionError(
                    f"Symmetry '{self.name}' has {what} {images!r}.", "Give a mapping: {'name': 'its image'}."
                )
        if self.role not in ROLES_OF_SYMMETRIES:
            raise SystemDefinitionError(
                f"Symmetry '{self.name}' has role {self.role!r}.",
                f"Allowed: {', '.join(ROLES_OF_SYMMETRIES)}.",
            )


@dataclass(frozen=True)
class Neutral:
    """A direction along which solutions come in families: `generator(t, x, p, v)` writes it into `v`.

    Where it is neutral along a branch, one member of the family is held (pinned) and the zero eigenvalue that
    belongs to it is left out of the spectrum. `pin` names the state that is held; without it, motion
    along the generator is. `value` names the parameter that says where; without it, the start's own value.
    """

    name: str
    generator: Callable[..., None]
    pin: str | None = None
    value: str | None = None
    about: str = ""

    def __post_init__(self) -> None:
        _require_name("A neutral direction", self.name)
        _require_callable(f"The generator of '{self.name}'", self.generator)
        if self.value is not None and self.pin is None:
            raise SystemDefinitionError(
                f"Neutral direction '{self.name}' has value='{self.value}' but no pin.",
                "Name the state that is held with pin=.",
            )


@dataclass(frozen=True)
class Conserved:
    """A quantity that no motion changes, such as an energy: `function(t, x, p)` returns its value.

    Periodic orbits come in families then, one for each value. The value is a parameter of the quantity's
    name: orbits are continued at a given value of it, by default that of the start, or along it. `function`
    may be a mapping from modes to functions; transitions keep its value.
    """

    name: str
    function: Callable[..., float] | Mapping[str, Callable[..., float]]
    unit: str = "1"
    about: str = ""

    def __post_init__(self) -> None:
        _require_name("A conserved quantity", self.name)
        _require_texts(f"Conserved quantity '{self.name}'", self, "unit", "about")
        if not isinstance(self.function, Mapping):
            _require_callable(f"The function of conserved quantity '{self.name}'", self.function)
            return
        for mode, function in self.function.items():
            _require_callable(f"The function of conserved quantity '{self.name}' in mode '{mode}'", function)

    def __hash__(self) -> int:
        return hash(self.name)

    def of(self, mode: str) -> Callable[..., float]:
        """Its function in a mode."""
        return self.function[mode] if isinstance(self.function, Mapping) else self.function


@dataclass(frozen=True)
class Condition:
    """What must be positive at an event for the motion to be the machine's: `function(t, x, p)`.

    It is evaluated at transition `at`, with the state before it or after it (`side`). A contact that must
    push, a friction that must suffice, a speed that must point away from the ground are conditions; a
    clearance that must stay positive between events is a `watched` transition.
    """

    name: str
    function: Callable[..., float]
    at: str
    side: str = "before"
    unit: str = "1"
    about: str = ""

    def __post_init__(self) -> None:
        _require_name("A condition", self.name)
        _require_callable(f"The function of condition '{self.name}'", self.function)
        _require_side(f"Condition '{self.name}'", self.side)


@dataclass(frozen=True)
class Observable:
    """A number computed from a motion: `function(t, x, p)` with `t` of shape (k,) and `x` of shape (k, n).

    An equilibrium is handed over as a motion of one instant (k = 1). A motion through events has two
    instants at each: before and after. With `at` the number belongs to an event instead: `t` is its time and
    `x`, shape (n,), the state before or after it (`side`), where it happens for the first time in a period.
    """

    name: str
    function: Callable[..., float]
    unit: str = "1"
    about: str = ""
    at: str | None = None
    side: str = "before"

    def __post_init__(self) -> None:
        _require_name("An observable", self.name)
        _require_texts(f"Observable '{self.name}'", self, "unit", "about")
        _require_callable(f"The function of observable '{self.name}'", self.function)
        _require_side(f"Observable '{self.name}'", self.side)


@dataclass(frozen=True)
class Signal:
    """A quantity that figures show along a motion: `function(t, x, p)`, of the shapes that observables take.

    It returns an array of shape (k,), NaN where the quantity does not exist: the height of a foot, the force
    on it. Nothing is computed with it.
    """

    name: str
    function: Callable[..., Any]
    unit: str = "1"
    about: str = ""

    def __post_init__(self) -> None:
        _require_name("A signal", self.name)
        _require_callable(f"The function of signal '{self.name}'", self.function)


@dataclass(frozen=True)
class Study:
    """What `contwalk init` writes into a run file: a parameter along which something happens, and a start.

    `start` is as in a run file; without it `init` finds one. `parameters` go on top of the defaults, `events`
    of the run file say what happens at limits.
    """

    parameter: str
    range: tuple[float, float]
    start: Mapping[str, Any] | None = None
    parameters: Mapping[str, float] = attribute(default_factory=dict)
    events: Mapping[str, str] = attribute(default_factory=dict)

    def __post_init__(self) -> None:
        _require_name("A study", self.parameter)
        low, high = self.range
        if not low < high:
            raise SystemDefinitionError(
                f"The range of the study over '{self.parameter}' is ({low:g}, {high:g}).",
                "Give the lower end first.",
            )


@dataclass(frozen=True)
class Start:
    """A named equilibrium known in closed form.

    `states(p)` returns a list of states (each of length n); an empty list where none exists. `exists` says in
    words when it exists, for the error message.
    """

    name: str
    states: Callable[..., Sequence[Sequence[float]]]
    about: str = ""
    exists: str = ""

    def __post_init__(self) -> None:
        _require_name("A start", self.name)
        _require_callable(f"The states of start '{self.name}'", self.states)


def _identity(entry: Any) -> tuple[str, str]:
    """What no two declarations of a kind may share: a name, of transitions with the mode they leave."""
    return entry.name, entry.source if isinstance(entry, Transition) else ""


@dataclass(frozen=True)
class System:
    """A machine: states, parameters, modes, transitions, and what is known about them.

    Parameters
    ----------
    name : str
    states, parameters, modes, transitions, symmetries, neutral, observables, starts, conditions : tuple
    signals, conserved : tuple
        The declarations of this module.
    period : callable, optional
        `period(p)`, in seconds, of the forcing of a time-periodic system.
    presets : mapping, optional
        Named parameter sets: `{"name": {"parameter": value}}`.
    draw : callable, optional
        `draw(axes, t, x, p)` draws the machine at one instant on matplotlib axes. One that takes `so_far`,
        the motion until then, draws it where it has got to.
    reference : str
        Where the equations come from.
    """

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
    conditions: tuple[Condition, ...] = ()
    signals: tuple[Signal, ...] = ()
    study: Study | None = None
    conserved: tuple[Conserved, ...] = ()

    def __post_init__(self) -> None:
        _require_name("A system", self.name)
        _require_texts(f"System '{self.name}'", self, "reference", "about")
        for what, kind in _TUPLES.items():
            entries = getattr(self, what)
            if isinstance(entries, kind):
                entries = (entries,)
            if not isinstance(entries, Iterable):
                raise SystemDefinitionError(
                    f"System '{self.name}': {what} is {entries!r}.",
                    f"It must be a tuple of {kind.__name__}(...), as in {what}=({kind.__name__}(...),).",
                )
            entries = tuple(entries)
            for entry in entries:
                if not isinstance(entry, kind):
                    raise SystemDefinitionError(
                        f"System '{self.name}': {what} contains {_shown(entry)}.",
                        f"Each entry must be a {kind.__name__}(...).",
                    )
            twice = [
                key for key, count in Counter(_identity(entry) for entry in entries).items() if count > 1
            ]
            if twice:
                where = f", both times from mode '{twice[0][1]}'" if twice[0][1] else ""
                raise SystemDefinitionError(
                    f"System '{self.name}': {what} has '{twice[0][0]}' twice{where}.", "Names must differ."
                )
            object.__setattr__(self, what, entries)
        self._add_conserved()
        if self.period is not None:
            _require_callable(f"The period of system '{self.name}'", self.period)
        if self.draw is not None:
            _require_callable(f"draw of system '{self.name}'", self.draw)
        self._check_presets()
        for name in () if self.study is None else (self.study.parameter, *self.study.parameters):
            self.require_parameter(name)
        for what in ("states", "modes"):
            if not getattr(self, what):
                raise SystemDefinitionError(f"System '{self.name}' has no {what}.", f"Declare {what}=(...,).")
        self._check_references()

    def _add_conserved(self) -> None:
        """The values of conserved quantities are parameters, declared or not."""
        known, quantities = set(self.parameter_names), {entry.name for entry in self.conserved}
        declared = [
            ConservedValue(**vars(parameter)) if parameter.name in quantities else parameter
            for parameter in self.parameters
        ]
        added = [
            ConservedValue(entry.name, math.nan, entry.unit, about=entry.about)
            for entry in self.conserved
            if entry.name not in known
        ]
        object.__setattr__(self, "parameters", (*declared, *added))

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

    def _check_references(self) -> None:
        state_names, parameter_names = self.state_names, self.parameter_names
        self._check_names()
        modes = {mode.name: mode for mode in self.modes}
        for transition in self.transitions:
            for end in (transition.source, transition.target):
                if not isinstance(end, str) or end not in modes:
                    raise SystemDefinitionError(
                        f"Transition '{transition.name}' refers to mode {_shown(end)}, which is not "
                        "declared.",
                        f"Modes are referred to by their names. Declared: {', '.join(modes)}. "
                        f"{nearest(str(end), list(modes))}".strip(),
                    )
            self._check_relabel(transition)
        for mode in self.modes:
            for name in mode.constants:
                if name in parameter_names:
                    raise SystemDefinitionError(
                        f"Mode '{mode.name}' has the constant '{name}', which is a parameter.",
                        "Rename one of them.",
                    )
                if name in state_names:
                    raise SystemDefinitionError(
                        f"Mode '{mode.name}' has the constant '{name}', which is a state.",
                        "Rename the constant: p is for parameters and constants, states are read as x[0].",
                    )
        for symmetry in self.symmetries:
            self._check_images(symmetry)
        for mode in self.modes:
            if mode.states is not None and not mode.states:
                raise SystemDefinitionError(
                    f"Mode '{mode.name}' has no states: nothing moves in it.",
                    "Let it keep a state at rest: name the state in states=(...,), and write a rate of zero. "
                    "The reset of the transition that leads out may overwrite it.",
                )
            twice = [name for name, count in Counter(mode.states or ()).items() if count > 1]
            if twice:
                raise SystemDefinitionError(
                    f"Mode '{mode.name}' has the state '{twice[0]}' twice.", "Name each state once."
                )
            for name in mode.states or ():
                if name not in state_names:
                    raise SystemDefinitionError(
                        f"Mode '{mode.name}' has the state '{name}', which is not declared.",
                        f"Declared states: {', '.join(state_names)}. {nearest(name, state_names)}".strip(),
                    )
        for quantity in self.conserved:
            self._check_conserved(quantity)
        happening = list(dict.fromkeys(transition.name for transition in self.acting))
        places = {entry.name: entry.at for entry in self.conditions}
        places |= {entry.name: entry.at for entry in self.observables if entry.at is not None}
        for name, place in places.items():
            if place not in happening:
                raise SystemDefinitionError(
                    f"'{name}' is taken at '{place}', which is no transition that acts.",
                    f"Transitions that act: {', '.join(happening) or 'none'}.",
                )
        for neutral in self.neutral:
            if neutral.pin is not None and neutral.pin not in state_names:
                raise SystemDefinitionError(
                    f"Neutral direction '{neutral.name}' pins '{neutral.pin}', which is not a state.",
                    nearest(neutral.pin, state_names),
                )
            if neutral.value is not None and neutral.value not in parameter_names:
                raise SystemDefinitionError(
                    f"Neutral direction '{neutral.name}' takes its value from '{neutral.value}', "
                    "which is not a parameter.",
                    nearest(neutral.value, parameter_names),
                )

    def _check_conserved(self, quantity: Conserved) -> None:
        what = f"Conserved quantity '{quantity.name}'"
        if self.period is not None:
            raise SystemDefinitionError(
                f"{what} belongs to a system with a period.",
                "What a forced machine conserves is not continued: leave conserved out.",
            )
        if isinstance(quantity.function, Mapping):
            modes = [mode.name for mode in self.modes]
            for mode in quantity.function:
                if mode not in modes:
                    raise SystemDefinitionError(
                        f"{what} has a function for mode '{mode}', which is not declared.",
                        nearest(str(mode), modes) or f"Declared modes: {', '.join(modes)}.",
                    )
            missing = [mode for mode in modes if mode not in quantity.function]
            if missing:
                raise SystemDefinitionError(
                    f"{what} has no function for mode '{missing[0]}'.",
                    "Give one for each mode, or one function for all.",
                )

    def _check_presets(self) -> None:
        if not isinstance(self.presets, Mapping):
            raise SystemDefinitionError(
                f"System '{self.name}': presets is {self.presets!r}.",
                "It must be a mapping, as in presets={'name': {'parameter': 1.0}}.",
            )
        for preset, values in self.presets.items():
            if not isinstance(values, Mapping):
                raise SystemDefinitionError(
                    f"Preset '{preset}' is {values!r}.", "It must be a mapping: {'parameter': 1.0}."
                )
            for name, value in values.items():
                if name not in self.parameter_names:
                    raise SystemDefinitionError(
                        f"Preset '{preset}' sets '{name}', which is not a parameter.",
                        nearest(str(name), self.parameter_names)
                        or f"Known: {', '.join(self.parameter_names)}.",
                    )
                if not _is_number(value):
                    raise SystemDefinitionError(
                        f"Preset '{preset}' sets '{name}' to {value!r}.", "It must be a number."
                    )

    def _check_names(self) -> None:
        """A name stands for one thing in branches, tables and figures."""
        own = tuple(name for name in self.parameter_names if name not in self.conserved_names)
        kinds = {"state": self.state_names, "parameter": own, "conserved quantity": self.conserved_names}
        kinds |= {"observable": tuple(observable.name for observable in self.observables)}
        # Branches tell what must stay positive by its name, as an observable.
        watched = (transition.name for transition in self.transitions if transition.role == "watched")
        kinds |= {"condition": tuple(condition.name for condition in self.conditions)}
        kinds |= {"watched transition": tuple(dict.fromkeys(watched))}
        for kind, names in kinds.items():
            for name in names:
                if name in RESERVED or _COLUMN_OF_SPECTRUM.fullmatch(name):
                    raise SystemDefinitionError(
                        f"System '{self.name}' calls {_a(kind)} '{name}', as contwalk calls a result.",
                        f"Rename the {kind}, as in '{name}_of_{self.name}'.",
                    )
        kinds["signal"] = self.signal_names
        # An observable of a state's name is a measure of that state: `branch[name]` is the observable.
        allowed = {("state", "observable"), ("observable", "signal")}
        allowed |= {("condition", "signal"), ("watched transition", "signal")}  # the same along a motion
        for (kind, names), (other, others) in combinations(kinds.items(), 2):
            shared = next((name for name in names if name in others), None)
            if shared is not None and (kind, other) not in allowed:
                raise SystemDefinitionError(
                    f"System '{self.name}': '{shared}' is {_a(kind)} and {_a(other)}.", "Rename one of them."
                )

    def _check_images(self, symmetry: Symmetry) -> None:
        events = {transition.name for transition in self.transitions}
        known = {"mode": {mode.name for mode in self.modes}, "transition": events}
        for what, images in (("mode", symmetry.modes), ("transition", symmetry.events)):
            for name in [*images, *images.values()]:
                if name not in known[what]:
                    raise SystemDefinitionError(
                        f"Symmetry '{symmetry.name}' names the {what} '{name}', which is not declared.",
                        nearest(name, sorted(known[what])) or f"Name declared {what}s.",
                    )

    def _check_relabel(self, transition: Transition) -> None:
        known = [symmetry.name for symmetry in self.symmetries if symmetry.role == "relabel"]
        if transition.relabel is not None and transition.relabel not in known:
            raise SystemDefinitionError(
                f"Transition '{transition.name}' relabels by '{transition.relabel}', which is no symmetry of "
                "role 'relabel'.",
                f"Declared: {', '.join(known) or 'none'}.",
            )

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states in their order."""
        return tuple(state.name for state in self.states)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""
        return tuple(parameter.name for parameter in self.parameters)

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

    @cached_property
    def conserved_names(self) -> tuple[str, ...]:
        """Names of the parameters that are values of conserved quantities."""
        return tuple(quantity.name for quantity in self.conserved)

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
        wrong = [name for name, value in given.items() if not _is_number(value)]
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

    def states_of(self, mode: str) -> tuple[int, ...]:
        """Positions of the states that exist in a mode, in the order of the states."""
        names = self.mode(mode).states
        return tuple(i for i, name in enumerate(self.state_names) if names is None or name in names)

    def leaving(self, mode: str) -> tuple[Transition, ...]:
        """The transitions out of a mode, watched ones included, in their order."""
        return self._leaving.get(mode, ())

    @cached_property
    def _leaving(self) -> dict[str, tuple[Transition, ...]]:
        found: dict[str, list[Transition]] = {}
        for transition in self.transitions:
            found.setdefault(transition.source, []).append(transition)
        return {mode: tuple(transitions) for mode, transitions in found.items()}

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
    def signal_names(self) -> tuple[str, ...]:
        """Names of the signals."""
        return tuple(signal.name for signal in self.signals)

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Names of the observables, of a hybrid system with the margins that its branches tell as well."""
        own = tuple(observable.name for observable in self.observables)
        if not self.acting:
            return own
        return (*own, *(name for name in self.margins if name not in own), SPLIT)

    @property
    def acting(self) -> tuple[Transition, ...]:
        """The transitions that do something: all but the watched ones."""
        return tuple(transition for transition in self.transitions if transition.role != "watched")

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
}
