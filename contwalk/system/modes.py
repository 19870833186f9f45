"""What a machine does: modes of motion, and what happens between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as attribute

from contwalk.errors import SystemDefinitionError
from contwalk.system.names import require_callable, require_name, require_side, shown

ROLES_OF_TRANSITIONS = ("hard", "soft", "watched")
DIRECTIONS = ("falling", "rising", "both")
KINDS_OF_MODES = ("flow", "map")
# A map that has been made a machine, see `contwalk.system.maps`.
ITERATED = "iterated"


@dataclass(frozen=True)
class Mode:
    """A smooth phase of motion with its vector field `field(t, x, p, dx)`.

    `states` names the states that exist in it; without it all do. One that does not exist is zero while the
    mode lasts: it is not integrated, the field need not write its rate, and a reset into the mode need not
    write its value.

    Of `kind` `map` the field writes the next state, not rates: the system is a map, with no other mode.

    `constants` are numbers that the field, and the guards, resets and conditions of the mode, read as
    `p.name`. Modes with the same field function and the same names of constants are compiled once.
    """

    name: str
    field: Callable[..., None]
    about: str = ""
    states: tuple[str, ...] | None = None
    constants: Mapping[str, float] = attribute(default_factory=dict, hash=False)
    kind: str = "flow"

    def __post_init__(self) -> None:
        require_name("A mode", self.name)
        if self.kind not in (*KINDS_OF_MODES, ITERATED):
            raise SystemDefinitionError(
                f"Mode '{self.name}' has kind {shown(self.kind)}.", f"Allowed: {', '.join(KINDS_OF_MODES)}."
            )
        require_callable(f"The field of mode '{self.name}'", self.field)
        if isinstance(self.states, str):
            raise SystemDefinitionError(
                f"Mode '{self.name}' has states {self.states!r}.", "Give a tuple of names, as in ('x', 'y')."
            )
        if not isinstance(self.constants, Mapping):
            raise SystemDefinitionError(
                f"Mode '{self.name}' has constants {self.constants!r}.", "Give a mapping: {'name': 1.0}."
            )
        for name, value in self.constants.items():
            require_name(f"A constant of mode '{self.name}'", name)
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

    `together` names transitions in the order in which they act where they have the same instant, as two feet
    have that land together. It may stand at any of them. Those that commute need none: whichever acts first,
    mode and state are the same after both.
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
    together: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_name("A transition", self.name)
        require_callable(f"The guard of transition '{self.name}'", self.guard)
        if self.reset is not None:
            require_callable(f"The reset of transition '{self.name}'", self.reset)
        if self.direction not in DIRECTIONS:
            raise SystemDefinitionError(
                f"Transition '{self.name}' has direction {shown(self.direction)}.",
                f"Allowed: {', '.join(DIRECTIONS)}.",
            )
        if self.role not in ROLES_OF_TRANSITIONS:
            raise SystemDefinitionError(
                f"Transition '{self.name}' has role {shown(self.role)}.",
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

        if isinstance(self.together, list):
            object.__setattr__(self, "together", tuple(self.together))
        names = self.together
        listed = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
        if not listed or len(set(names)) != len(names) or len(names) == 1:
            raise SystemDefinitionError(
                f"Transition '{self.name}' has together={shown(names)}.",
                "Give the names of two transitions or more, in the order in which they act where they have "
                "the same instant, as in together=('left', 'right').",
            )

    @property
    def at_entry(self) -> bool:
        """Whether it happens at once where its mode is entered with its guard past zero."""
        return self.level or self.role == "soft"


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
        require_name("A condition", self.name)
        require_callable(f"The function of condition '{self.name}'", self.function)
        require_side(f"Condition '{self.name}'", self.side)
