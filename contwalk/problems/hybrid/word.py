"""The word of a hybrid orbit: which mode follows which, through which transitions.

An orbit is a cycle of *legs*: a leg is a smooth piece in one mode, ended by a transition. The signature that
a user sees lists the transitions, beginning with the one that leads into the first leg. An orbit that meets
no event is one leg without a transition.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from contwalk.system import System, Transition


@dataclass(frozen=True)
class Leg:
    """A smooth piece in one mode.

    Parameters
    ----------
    mode : str
    transition : Transition, optional
        What ends it; None for an orbit without events.
    falls : bool
        Whether the guard falls through zero at its end; else it rises.
    """

    mode: str
    transition: Transition | None = None
    falls: bool = True

    @property
    def name(self) -> str:
        """Name of the transition."""
        return "" if self.transition is None else self.transition.name


@dataclass(frozen=True)
class Word:
    """The cycle of legs."""

    legs: tuple[Leg, ...]

    def __len__(self) -> int:
        return len(self.legs)

    @property
    def eventful(self) -> bool:
        """Whether there are events at all."""
        return self.legs[0].transition is not None

    @property
    def signature(self) -> tuple[str, ...]:
        """Names of the transitions, from the one that leads into the first leg."""
        if not self.eventful:
            return ()
        names = [leg.name for leg in self.legs]
        return (names[-1], *names[:-1])

    def target(self, i: int) -> str:
        """Mode that leg i leads into."""
        return self.legs[(i + 1) % len(self)].mode

    def repeated(self, times: int) -> Word:
        """The word run through several times."""
        return Word(self.legs * times)

    def has_parts(self, times: int) -> bool:
        """Whether the word is a shorter one, run through so many times."""
        part, rest = divmod(len(self), times)
        return not rest and self.legs == self.legs[:part] * times

    def relabelled(self, system: System) -> tuple[str | None, int]:
        """The symmetry up to which the orbit closes, and how many closures make a whole period.

        Names that are swapped an even number of times are the old ones again.
        """
        count: dict[str, int] = {}
        for leg in self.legs:
            if leg.transition is not None and leg.transition.relabel is not None:
                count[leg.transition.relabel] = count.get(leg.transition.relabel, 0) + 1
        odd = [name for name, number in count.items() if number % 2]
        return ("_".join(odd), 2) if odd else (None, 1)

    def inserted(self, i: int, leg: Leg) -> Word:
        """The word with leg i cut in two by another event: `leg` comes first."""
        return Word((*self.legs[:i], leg, *self.legs[i:]))

    def without(self, i: int) -> Word:
        """The word without the event that ends leg i; what follows it continues the leg."""
        legs = list(self.legs)
        if len(legs) == 1:
            return Word((replace(legs[0], transition=None),))
        following = (i + 1) % len(legs)
        legs[following] = replace(legs[following], mode=legs[i].mode)
        del legs[i]
        return Word(tuple(legs))


def named_word(system: System, legs: Sequence[tuple[str, str, bool]]) -> Word:
    """The word of stored legs: mode, transition (empty for none) and whether its guard falls."""
    return Word(
        tuple(
            Leg(mode, system.transition(name, mode) if name else None, bool(falls))
            for mode, name, falls in legs
        )
    )
