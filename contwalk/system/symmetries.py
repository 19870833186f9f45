"""What motions have in common: images, families of solutions, and what no motion changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as attribute

from contwalk.errors import SystemDefinitionError
from contwalk.system.names import require_callable, require_name, require_texts

ROLES_OF_SYMMETRIES = ("relabel", "spatial")


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
        require_name("A symmetry", self.name)
        require_callable(f"The map of symmetry '{self.name}'", self.map)
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
        require_name("A neutral direction", self.name)
        require_callable(f"The generator of '{self.name}'", self.generator)
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
        require_name("A conserved quantity", self.name)
        require_texts(f"Conserved quantity '{self.name}'", self, "unit", "about")
        if not isinstance(self.function, Mapping):
            require_callable(f"The function of conserved quantity '{self.name}'", self.function)
            return
        for mode, function in self.function.items():
            require_callable(f"The function of conserved quantity '{self.name}' in mode '{mode}'", function)

    def __hash__(self) -> int:
        return hash(self.name)

    def of(self, mode: str) -> Callable[..., float]:
        """Its function in a mode."""
        return self.function[mode] if isinstance(self.function, Mapping) else self.function
