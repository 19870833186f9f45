"""What leaves the motion of the walker as it is: ways along the slope, its mirror, a free torso's pitch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.system import Neutral, Symmetry

from .contacts import Contacts, mirrored, mode_name
from .model import DAMPED, Model
from .states import P1, Q1, Q3, Q4, Q5, Q6, Q7, Q9, STATES, U1, U5, U6, U7, U9

# Of the mirror x -> -x across the hip line: states that change their sign, and what changes places with what.
_ODD = (Q1, Q5, Q6, P1, P1 + 2, P1 + 4, P1 + 6, U1, U5, U6)
_PLACES = (
    {Q7 + i: Q9 + i for i in range(2)}
    | {U7 + i: U9 + i for i in range(2)}
    | {P1 + i: P1 + 4 + i for i in range(4)}
)
_IMAGE = {**_PLACES, **{b: a for a, b in _PLACES.items()}}


def make_mirror(contacts: Sequence[Contacts], events: Sequence[str]) -> Symmetry:
    """The mirror image of a walker whose legs are: what leg 1 does, leg 2 does on the other side."""
    modes = {mode_name(each): mode_name(mirrored(each)) for each in contacts}
    images = {name: _event_image(name) for name in events}
    return Symmetry(
        "mirror",
        "spatial",
        _mirrored,
        about="left and right change places",
        modes={name: image for name, image in modes.items() if name != image},
        events={name: image for name, image in images.items() if name != image},
    )


def _mirrored(t: Any, x: Any, p: Any, x_image: Any) -> None:
    for place in range(len(STATES)):
        value = x[_IMAGE.get(place, place)]
        x_image[place] = -value if place in _ODD else value


def _event_image(name: str) -> str:
    """The same event of the other leg: toe12_on -> toe22_on, knee1_locks -> knee2_locks."""
    number = len("knee") if name.startswith("knee") else len("toe")
    other = "2" if name[number] == "1" else "1"
    return name[:number] + other + name[number + 1 :]


def _to_the_side(t: Any, x: Any, p: Any, v: Any) -> None:
    _along(Q1, v)


def _downhill(t: Any, x: Any, p: Any, v: Any) -> None:
    _along(Q3, v)


def _pitched(t: Any, x: Any, p: Any, v: Any) -> None:
    _along(Q4, v)


def _along(place: int, v: Any) -> None:
    """The anchors of the toes are relative to T and move with it."""
    for i in range(len(STATES)):
        v[i] = 1.0 if i == place else 0.0


def make_neutral(model: Model) -> tuple[Neutral, ...]:
    """Directions along which gaits come in families."""
    across = Neutral("across", _to_the_side, pin="q1", about="the same gait further to the side")
    along = Neutral("along", _downhill, pin="q3", about="the same gait further downhill")
    if model.hip == DAMPED:  # and its torso is balanced: for which parameters it is, is found at a start
        pitch = Neutral(
            "pitch", _pitched, pin="q4", about="the same gait with its balanced torso at another pitch"
        )
        return across, along, pitch
    return across, along
