"""What a walker touches: the state of contact of each leg, and what can happen to it.

A toe is off the ground, on it and damped (it moves into the ground), or on it and not damped (it moves out
of it); where the ground never pulls it may be slack besides: it moves out so fast that nothing holds it down.
A knee is free or locked, and where its rebound is damped otherwise, locked and rebounding. Where scuffing is
disregarded, a leg whose toes have both left the ground *swings*: it touches nothing until its knee has
locked, even if the knee lets go again before the foot lands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from .model import CLIPPED, DISREGARDED, REBOUND, TWO_SIDED, Model
from .states import LEGS, TOES, anchor_names

OFF, DAMPED, UNDAMPED, SLACK = "off", "damped", "undamped", "slack"


@dataclass(frozen=True)
class LegContact:
    """What one leg touches: its toes, its knee's stop, whether it swings, and whether its knee rebounds."""

    toes: tuple[str, str]
    locked: bool
    swings: bool
    rebounds: bool = False

    @property
    def in_air(self) -> bool:
        """Whether no toe is on the ground."""
        return self.toes == (OFF, OFF)


Contacts = tuple[LegContact, LegContact]


def all_contacts(model: Model) -> Iterator[Contacts]:
    """All combinations, the one in which everything touches first."""
    toe = {TWO_SIDED: (DAMPED, OFF), CLIPPED: (DAMPED, UNDAMPED, SLACK, OFF)}.get(
        model.ground_damper, (DAMPED, UNDAMPED, OFF)
    )
    knees = [(True, False), (False, False), *([(True, True)] if model.knee_damper == REBOUND else [])]
    legs = [
        LegContact(toes, locked, swings, rebounds)
        for toes in product(toe, toe)
        for locked, rebounds in knees
        for swings in ((False, True) if toes == (OFF, OFF) and model.scuffing == DISREGARDED else (False,))
    ]
    return product(legs, legs)


def with_toe(contact: LegContact, toe: int, state: str, model: Model) -> LegContact:
    """A leg one of whose toes changes."""
    toes = tuple(state if number == toe else old for number, old in zip(TOES, contact.toes, strict=True))
    swings = toes == (OFF, OFF) and model.scuffing == DISREGARDED
    return LegContact(toes, contact.locked, swings, contact.rebounds)


def with_knee(contact: LegContact, locked: bool) -> LegContact:
    """A leg whose knee locks or lets go."""
    return replace(contact, locked=locked, swings=contact.swings and not locked, rebounds=False)


def with_rebound(contact: LegContact, rebounds: bool) -> LegContact:
    """A leg whose knee, on its stop, turns round."""
    return replace(contact, rebounds=rebounds)


def with_leg(contacts: Contacts, leg: int, contact: LegContact) -> Contacts:
    """A walker one of whose legs changes."""
    return tuple(contact if number == leg else old for number, old in zip(LEGS, contacts, strict=True))


def mirrored(contacts: Contacts) -> Contacts:
    """The walker in the mirror: its legs change places."""
    return contacts[1], contacts[0]


def flags(contacts: Contacts, model: Model) -> dict[str, float]:
    """What touches, as numbers 1 and 0 that the field multiplies by: all modes share it."""
    found = {}
    for leg, contact in zip(LEGS, contacts, strict=True):
        for toe, state in zip(TOES, contact.toes, strict=True):
            found[f"on{leg}{toe}"] = float(state != OFF)
            if model.ground_damper != TWO_SIDED:
                found[f"damped{leg}{toe}"] = float(state == DAMPED)
            if model.ground_damper == CLIPPED:
                found[f"rising{leg}{toe}"] = float(state == UNDAMPED)
                found[f"pressed{leg}{toe}"] = float(state in (DAMPED, UNDAMPED))
        found[f"stop{leg}"] = float(contact.locked)
        if model.knee_damper == REBOUND:
            found[f"rebound{leg}"] = float(contact.rebounds)
    return found


def mode_name(contacts: Contacts) -> str:
    """Name of a mode, as `swing1_toe21_toe22up_knee2`: what each leg does, and which knees are locked.

    A toe that moves out of the ground is followed by `up`, one that is slack by `slack`, a knee that rebounds
    by `back`. A leg off the ground is `swing`ing, or may land: `air`.
    """
    words = []
    for leg, contact in zip(LEGS, contacts, strict=True):
        if contact.in_air:
            words.append(f"{'swing' if contact.swings else 'air'}{leg}")
        for toe, state in zip(TOES, contact.toes, strict=True):
            if state != OFF:
                words.append(f"toe{leg}{toe}" + {UNDAMPED: "up", SLACK: "slack"}.get(state, ""))
        if contact.locked:
            words.append(f"knee{leg}" + "back" * contact.rebounds)
    return "_".join(words)


def mode_words(contacts: Contacts) -> str:
    """One line of meaning."""
    return "; ".join(_leg_words(leg, contact) for leg, contact in zip(LEGS, contacts, strict=True))


def _leg_words(leg: int, contact: LegContact) -> str:
    knee = ("knee rebounding" if contact.rebounds else "knee locked") if contact.locked else "knee free"
    if contact.in_air:
        return f"leg {leg} {'swings' if contact.swings else 'is in the air'}, its {knee}"
    toes = [f"{leg}{toe}" for toe, state in zip(TOES, contact.toes, strict=True) if state != OFF]
    up = [f"{leg}{toe}" for toe, state in zip(TOES, contact.toes, strict=True) if state in (UNDAMPED, SLACK)]
    on = f"toe {toes[0]}" if len(toes) == 1 else f"toes {toes[0]} and {toes[1]}"
    rising = f" ({' and '.join(up)} moving out)" if up else ""
    return f"leg {leg} on {on}{rising}, its {knee}"


def anchors_off(contacts: Contacts) -> tuple[str, ...]:
    """Names of the anchors that do not exist: those of the toes off the ground."""
    return tuple(
        name
        for leg, contact in zip(LEGS, contacts, strict=True)
        for toe, state in zip(TOES, contact.toes, strict=True)
        if state == OFF
        for name in anchor_names(leg, toe)
    )
