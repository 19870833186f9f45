"""The itinerary of a hybrid orbit: which mode follows which, through which transitions.

An orbit is a cycle of *legs*: a leg is a smooth piece in one mode, ended by a transition. The signature that
a user sees lists the transitions, beginning with the one that leads into the first leg. An orbit that meets
no event is one leg without a transition; one that is looked at from an instant between events ends with such
a leg, which the first one continues.

A mode may be entered where the guard of a transition is past zero that acts at entry. It then lasts no time:
a leg that is collapsed, of which the itinerary tells as of any other. By a symmetry two transitions may
happen at one instant all along a branch. They follow each other as in any itinerary, and the leg between them
ends where its guard is zero: its duration is zero on the orbit, and not beside it.

An orbit that is its own mirror image half a period later is half a cycle: after the last transition the state
is the image of the first one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import takewhile
from math import gcd
from typing import Any

from contwalk.system import Symmetry, System, Transition


@dataclass(frozen=True)
class Leg:
    """A smooth piece in one mode.

    Parameters
    ----------
    mode : str
    transition : Transition, optional
        What ends it; None where only the closure ends there.
    falls : bool
        Whether the guard falls through zero at its end; else it rises.
    collapsed : bool
        Whether it lasts no time, because its guard is past zero where it begins.
    together : bool
        Whether its transition happens at the instant of the one before, by a symmetry.
    ordered : bool
        Whether it matters which of both acts first, so that derivatives tell of one side only.
    """

    mode: str
    transition: Transition | None = None
    falls: bool = True
    collapsed: bool = False
    together: bool = False
    ordered: bool = False

    @property
    def name(self) -> str:
        """Name of the transition."""
        return "" if self.transition is None else self.transition.name

    @property
    def momentary(self) -> bool:
        """Whether it lasts no time on an orbit."""
        return self.collapsed or self.together

    @property
    def soft(self) -> bool:
        """Whether a soft transition ends it."""
        return self.transition is not None and self.transition.role == "soft"


@dataclass(frozen=True)
class Itinerary:
    """The cycle of legs, and how it closes: onto itself, or onto its image under a declared symmetry.

    An orbit x that closes up to the symmetry S of order q, S x(T) = x(0), is q images of one closure (the
    thesis's equation 44 is the case q = 2). So no more than a q-th of it is integrated.

    Parameters
    ----------
    legs : tuple of Leg
    image : str
        The symmetry up to which it closes, applied at its end; empty if it closes onto itself.
    power : int
        How many times the symmetry is applied.
    order : int
        Of the symmetry, where there is one: so many closures make a period.
    """

    legs: tuple[Leg, ...]
    image: str = ""
    power: int = 1
    order: int = 2

    def __len__(self) -> int:
        return len(self.legs)

    @property
    def closures(self) -> int:
        """How many closures make a period, but for names that are swapped at events."""
        return self.order if self.image else 1

    @property
    def eventful(self) -> bool:
        """Whether the closure ends with an event; otherwise its phase is fixed by another equation."""
        return self.legs[-1].transition is not None

    def leading_in(self, system: System, i: int) -> str:
        """Name of the transition that leads into leg i; empty if there is none."""
        before = self.legs[i - 1]
        if i == 0 and self.image:
            before = imaged_leg(system, self.image, before)
        return before.name

    def at_start(self, system: System, i: int) -> list[str]:
        """Names of the transitions that happen where leg i begins, the one that leads into it first."""
        more = takewhile(lambda k: self.legs[i - k].together, range(1, len(self)))
        return [self.leading_in(system, (i - k) % len(self)) for k in (0, *more)]

    def signature(self, system: System) -> tuple[str, ...]:
        """Names of the transitions, from the one that leads into the first leg."""
        return tuple(self.leading_in(system, i) for i in range(len(self))) if self.eventful else ()

    def target(self, i: int) -> str:
        """Mode that leg i leads into."""
        return self.legs[(i + 1) % len(self)].mode

    def image_at(self, i: int) -> str:
        """The symmetry that is applied at the end of leg i."""
        return self.image if i == len(self) - 1 else ""

    @cached_property
    def ordered(self) -> bool:
        """Whether the order of events at one instant matters."""
        return any(leg.ordered for leg in self.legs)

    @property
    def single(self) -> bool:
        """Whether the closure is one leg that meets no event."""
        return len(self) == 1 and not self.eventful

    def repeated(self, times: int) -> Itinerary:
        """The itinerary run through several times."""
        return Itinerary(continued(self.legs * times))

    def gone_round(self, system: System, times: int) -> Itinerary:
        """What is met on several closures, each the inverse image of the one before."""
        legs, part = list(self.legs), self.legs
        for _ in range(times - 1):
            for _ in range((self.order - 1) * self.power if self.image else 0):
                part = tuple(imaged_leg(system, self.image, leg) for leg in part)
            legs += part
        order = self.closures // gcd(self.closures, times)
        if order == 1:
            return Itinerary(continued(legs))
        return Itinerary(continued(legs), self.image, times * self.power % self.order, order)

    def unfolded(self, system: System) -> Itinerary:
        """The itinerary of the whole period, where this one closes up to a symmetry."""
        if not self.image:
            return self
        return Itinerary(continued((*self.legs, *(imaged_leg(system, self.image, leg) for leg in self.legs))))

    def rotated(self, system: System, first: int) -> Itinerary:
        """The same cycle, beginning with another leg."""
        early = self.legs[:first]
        if self.image:
            early = tuple(imaged_leg(system, self.image, leg) for leg in early)
        return replace(self, legs=(*self.legs[first:], *early))

    def has_parts(self, system: System, times: int) -> bool:
        """Whether the itinerary is a shorter one, run through so many times.

        Of one that closes up to an image, every second time as its image.
        """
        if not self.eventful:
            return True
        part, rest = divmod(len(self), times)
        first = self.legs[:part]
        if not self.image:
            return not rest and self.legs == first * times
        second = tuple(imaged_leg(system, self.image, leg) for leg in first)
        alternating = (first + second) * (times // 2) + first
        return not rest and times % 2 == 1 and self.legs == alternating

    def has_halves(self, system: System) -> bool:
        """Whether the second half is the first one again, or its image.

        It may begin within a leg, which then goes on until it has begun again.
        """
        half = len(self) // 2
        part, second, rest = self.legs[:half], self.legs[half : 2 * half], self.legs[2 * half :]
        if self.image or not half or any(leg.transition or leg.mode != part[0].mode for leg in rest):
            return False
        images = [s.name for s in system.symmetries if s.role == "spatial"]
        return any(
            second == (tuple(imaged_leg(system, name, leg) for leg in part) if name else part)
            for name in ("", *images)
        )

    def relabelled(self, system: System) -> tuple[str | None, int]:
        """The symmetry up to which the orbit closes, and how many closures make a whole period.

        Names that are swapped an even number of times are the old ones again.
        """
        count: dict[str, int] = {}
        for leg in self.legs:
            if leg.transition is not None and leg.transition.relabel is not None:
                count[leg.transition.relabel] = count.get(leg.transition.relabel, 0) + 1
        if self.image:
            count[self.image] = 1
        odd = [name for name, number in count.items() if number % 2]
        return ("_".join(odd), self.order) if odd else (None, 1)

    def inserted(self, i: int, leg: Leg) -> Itinerary:
        """The itinerary with leg i cut in two by another event: `leg` comes first."""
        return replace(self, legs=(*self.legs[:i], leg, *self.legs[i:]))

    def without(self, i: int) -> Itinerary:
        """The itinerary without the event that ends leg i; what follows it continues the leg."""
        legs = list(self.legs)
        if len(legs) == 1:
            return replace(self, legs=(replace(legs[0], transition=None),))
        following = (i + 1) % len(legs)
        legs[following] = replace(legs[following], mode=legs[i].mode)
        del legs[i]
        return replace(self, legs=tuple(legs))


def continued(legs: Sequence[Leg]) -> tuple[Leg, ...]:
    """Legs of which each that no event ends, but for the last one, is one with its follower."""
    found: list[Leg] = []
    for leg in legs:
        if found and found[-1].transition is None:
            found[-1] = replace(leg, mode=found[-1].mode)
        else:
            found.append(leg)
    return tuple(found)


def has_image(system: System, symmetry: Symmetry, leg: Leg) -> bool:
    """Whether there is a transition that a leg's own one is taken to."""
    if leg.transition is None:
        return True
    source = leg.transition.source
    return symmetry.modes.get(source, source) in system.sources(symmetry.events.get(leg.name, leg.name))


def imaged_leg(system: System, image: str, leg: Leg) -> Leg:
    """The leg that follows when a leg's image does."""
    return image_of(system, system.symmetry(image), leg)


def image_of(system: System, symmetry: Symmetry, leg: Leg) -> Leg:
    """What a symmetry takes a leg to. Its guard may rise where that of the leg falls."""
    mode = symmetry.modes.get(leg.mode, leg.mode)
    if leg.transition is None:
        return replace(leg, mode=mode)
    source = leg.transition.source  # not the leg's mode where soft transitions lead from one to the other
    name, out_of = symmetry.events.get(leg.name, leg.name), symmetry.modes.get(source, source)
    transition = system.transition(name, out_of)
    falls = {"falling": True, "rising": False}.get(transition.direction, leg.falls)
    return replace(leg, mode=mode, transition=transition, falls=falls)


def stored_leg(leg: Leg) -> list[str | bool]:
    """What is kept of a leg: mode, transition, whether its guard falls; of one that lasts no time whether it
    is collapsed, whether it is together with the one before, and whether their order matters.
    """
    of_no_time = [leg.collapsed, *([True, leg.ordered] if leg.together else [])] if leg.momentary else []
    return [leg.mode, leg.name, leg.falls, *of_no_time]


def named_itinerary(system: System, legs: Sequence[Sequence[Any]], image: str = "") -> Itinerary:
    """The itinerary of stored legs; see `stored_leg`."""

    def out_of(mode: str, name: str) -> Transition | None:
        if not name:
            return None
        sources = system.sources(name)
        around = system.modes_around(mode)  # soft transitions may lie before it
        return system.transition(name, next(source for source in around if source in sources))

    named = [Leg(mode, out_of(mode, name), *map(bool, rest)) for mode, name, *rest in legs]
    return Itinerary(tuple(named), image)
