"""What a branch meets where its equations are smooth by pieces only, and what follows from it, in words."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from contwalk.errors import NotSmooth

REMEDY = (
    "Declare two modes, one for each side, with a transition between them whose guard is what is compared "
    "there."
)
PARTED = "Declare two transitions, one for each side, each with its own guard and reset"
CLOCK = "Declare a transition whose guard is a function of time (a clock)"
# What jumps by its lowest derivative that does.
_WHAT = ("", "slopes of ", "second derivatives of ")


@dataclass(frozen=True)
class Kink(ABC):
    """A place at which the equations are smooth by pieces only.

    Parameters
    ----------
    order : int
        The lowest derivative that jumps.
    where : str
        The plugin's line.
    of : str
        What jumps.
    """

    order: int
    where: str
    of: str = "the field"

    @property
    def refused(self) -> bool:
        """Whether no branch goes on beyond it: solutions beyond a jump are not near to those before."""
        return self.order == 0

    @abstractmethod
    def sentence(self, of: str) -> str:
        """What it means for `equilibria` or `orbits` of a branch."""

    @abstractmethod
    def refusal(self, of: str) -> NotSmooth:
        """Why `equilibria` or `orbits` do not go on beyond it, where it is refused."""


@dataclass(frozen=True)
class FieldKink(Kink):
    """A place of the field. `moves`: whether the instant at which it is passed depends on the unknowns."""

    moves: bool = True

    @property
    def refused(self) -> bool:
        """Whether derivatives of the motion are wrong."""
        return self.order == 0 and self.moves

    def sentence(self, of: str) -> str:
        """What it means for `equilibria` or `orbits` of a branch."""
        if self.order == 0 and not self.moves:
            return (
                f"Its {of} pass an instant at which the field jumps: {self.where}. Steps are short and rough "
                f"there. {CLOCK}, with a mode for each piece."
            )
        what = f"{_WHAT[self.order]}the field jump{'' if self.order else 's'}"
        if of == "equilibria":
            means = (
                "Eigenvalues jump there, and stability may change without a special point."
                if self.order < 2
                else "Coefficients of normal forms jump there."
            )
            return f"Its equilibria cross a place where {what}: {self.where}. {means}"
        met = f"Its orbits cross a place where {what}: {self.where}."
        if self.order == 1:
            return (
                f"{met} Multipliers and special points are right, but normal forms, and with them "
                f'criticality, are not known. {REMEDY} With role="soft" they are.'
            )
        return f"{met} Cubic coefficients, and with them criticality, are not known. {REMEDY}"

    def refusal(self, of: str) -> NotSmooth:
        """Why `equilibria` or `orbits` do not go on beyond it."""
        if of == "equilibria":
            return NotSmooth(
                f"Ahead lies a place where the field jumps: {self.where}. What is an equilibrium on one side "
                "of it is none on the other. Begin a branch on each side, or make the field continuous."
            )
        return NotSmooth(
            f"The motion crosses a place where the field jumps: {self.where}. Derivatives of the motion "
            f"are wrong there, and with them its multipliers. {REMEDY}"
        )


@dataclass(frozen=True)
class ParameterKink(Kink):
    """A value of the free parameter at which the equations change everywhere at once.

    `at` says which (`a = 0.5`).
    """

    at: str = field(default="", compare=False)

    def sentence(self, of: str) -> str:
        """What it means for `equilibria` or `orbits` of a branch."""
        what = f"{_WHAT[self.order]}{self.of} jump{'' if self.order else 's'}"
        means = (
            "The branch has a corner there, and special points near it may stay unlocated."
            if self.order < 2
            else "Coefficients of normal forms change at once there."
        )
        return (
            f"At {self.at}, whatever the states are, {what}: {self.where}. {means} End `range` there and "
            f"begin a branch on each side, or make {self.of} smooth."
        )

    def refusal(self, of: str) -> NotSmooth:
        """Why `equilibria` or `orbits` do not go on beyond it."""
        return NotSmooth(
            f"At {self.at}, whatever the states are, {self.of} jumps: {self.where}. {of.capitalize()} beyond "
            f"are not near to those before. End `range` there and begin a branch on each side, or make "
            f"{self.of} continuous."
        )


@dataclass(frozen=True)
class EventKink(Kink):
    """A place of a guard or a reset at the states of its own event."""

    def sentence(self, of: str) -> str:
        """What it means for orbits of a branch."""
        return (
            f"Its {of} pass a place where slopes of {self.of} jump: {self.where}. Multipliers jump "
            f"there, and special points near it may stay unlocated. {PARTED}, or make it smooth."
        )

    def refusal(self, of: str) -> NotSmooth:
        """Why orbits do not go on beyond it."""
        return NotSmooth(
            f"At its event {self.of} jumps: {self.where}. {of.capitalize()} beyond are not near to "
            f"those before. {PARTED}, or make it continuous."
        )


@dataclass(frozen=True)
class SteepKink(EventKink):
    """A place of a guard or a reset at which one of its slopes has no bound."""

    @property
    def refused(self) -> bool:
        """No derivative there tells solutions beyond it."""
        return True

    def refusal(self, of: str) -> NotSmooth:
        """Why orbits do not go on beyond it."""
        return NotSmooth(
            f"At its event slopes of {self.of} grow beyond all bounds: {self.where}. Multipliers of {of} "
            "beside it do so, too, and no step leads through. End `range` there, and begin a branch on the "
            "other side."
        )


@dataclass(frozen=True)
class Undefined(Kink):
    """A number that is only told, and that is none: `of` names it."""

    @property
    def refused(self) -> bool:
        """Nothing of the motion depends on it."""
        return False

    def sentence(self, of: str) -> str:
        """What it means for orbits of a branch."""
        return (
            f"On some of its {of} {self.of} is not a number: {self.where}. They are told to be not "
            "admissible, whatever they are. Return a number there, negative where the motion is not the "
            "machine's."
        )

    def refusal(self, of: str) -> NotSmooth:
        """As the sentence: no branch ends by it."""
        return NotSmooth(self.sentence(of))


@dataclass(frozen=True)
class JumpThroughZero(Kink):
    """A place at which a number that matters by its sign alone jumps through zero: a guard of another event,
    which `acts`, or what is told of the motion there. Of order 1 it comes to zero at a corner.
    """

    acts: bool = True

    @property
    def refused(self) -> bool:
        """Whether an event comes or goes by it."""
        return self.acts

    def sentence(self, of: str) -> str:
        """What it means for orbits of a branch."""
        return (
            f"Its {of} pass a place where {self.of} jumps through zero: {self.where}. They become "
            "admissible there, or cease to be, without a special point. Return a number that passes "
            "zero there smoothly instead."
        )

    def refusal(self, of: str) -> NotSmooth:
        """Why orbits do not go on beyond it."""
        if self.order:
            return NotSmooth(
                f"Away from its event {self.of} comes to zero at a corner: {self.where}. Its event begins to "
                "happen there, or ceases to, without its rate being zero, which a limit is located by. End "
                "`range` there and begin a branch on each side, or make the corner round."
            )
        return NotSmooth(
            f"Away from its event {self.of} jumps through zero: {self.where}. The event happens there, or "
            "ceases to, without a number that passes zero, which orbits are equations of. Return one that "
            "passes zero evenly, as a distance does."
        )


Own = TypeVar("Own", bound=Kink, covariant=True)


@dataclass(frozen=True)
class Met(Generic[Own]):
    """A kink on the straight way between two places, and after which part of it."""

    kink: Own
    share: float


def refuse(kinks: tuple[Kink, ...]) -> None:
    """Raise for an orbit that crosses a jump of the field, or whose event lies at one of its guard or reset.

    Raises
    ------
    NotSmooth
    """
    for kink in kinks:
        if kink.refused:
            raise kink.refusal("orbits")
