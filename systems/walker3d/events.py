"""What happens to a walker: toes touch down and lift off, ground dampers switch, knees lock and let go.

Guards and resets are made once for a machine and shared by all modes, so that one event is one event in all
of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from contwalk.system import Transition

from .contacts import (
    DAMPED,
    OFF,
    SLACK,
    UNDAMPED,
    Contacts,
    LegContact,
    mode_name,
    with_knee,
    with_leg,
    with_rebound,
    with_toe,
)
from .dips import make_dips
from .model import CLIPPED, REBOUND, TWO_SIDED, Model
from .motion import toe_place, toe_velocity
from .states import KNEE, KNEE_RATE, LEGS, STATES, TOES, anchor

Guard = Callable[[Any, Any, Any], Any]


@dataclass(frozen=True)
class Functions:
    """Guards and resets, those of toes by leg and toe, those of knees by leg."""

    height: Mapping[tuple[int, int], Guard]
    rising: Mapping[tuple[int, int], Guard]
    landed: Mapping[tuple[int, int], Callable[..., None]]
    knee: Mapping[int, Guard]
    bending: Mapping[int, Guard]
    pressing: Mapping[tuple[int, int], Guard]
    dips: Mapping[tuple[int, int], Mapping[str, Guard]]


def make_functions(model: Model) -> Functions:
    """The functions of a machine."""
    ends = [(leg, toe) for leg in LEGS for toe in TOES]
    return Functions(
        height={end: _height(*end, model) for end in ends},
        rising={end: _rising(*end, model) for end in ends},
        landed={end: _landed(*end, model) for end in ends},
        knee={leg: _knee(leg) for leg in LEGS},
        bending={leg: _bending(leg) for leg in LEGS},
        pressing={end: _pressing(*end, model) for end in ends},
        dips={end: make_dips(*end, model) for end in ends},
    )


def make_transitions(contacts: Contacts, functions: Functions, model: Model) -> Iterator[Transition]:
    """The transitions out of the mode of these contacts."""
    source = mode_name(contacts)
    for leg, contact in zip(LEGS, contacts, strict=True):

        def to(changed: LegContact, leg: int = leg) -> str:
            return mode_name(with_leg(contacts, leg, changed))

        for toe in TOES:
            yield from _of_toe(leg, toe, contact, source, to, functions, model)
        yield from _of_knee(leg, contact, source, to, functions, model)


def _of_toe(
    leg: int,
    toe: int,
    contact: LegContact,
    source: str,
    to: Callable[[LegContact], str],
    functions: Functions,
    model: Model,
) -> Iterator[Transition]:
    name, end, state = f"toe{leg}{toe}", (leg, toe), contact.toes[toe - 1]
    if state == OFF:
        if contact.swings:
            for dip, guard in functions.dips[end].items():
                about = f"toe {leg}{toe} passes through the ground, {dip} the standing foot"
                yield Transition(f"{name}_{dip}", source, source, guard, role="watched", about=about)
        else:
            yield Transition(
                f"{name}_on",
                source,
                to(with_toe(contact, toe, DAMPED, model)),
                functions.height[end],
                reset=functions.landed[end],
                about=f"toe {leg}{toe} touches down, and is held where it does",
                level=True,
            )
        return
    if state == UNDAMPED:
        yield Transition(
            f"{name}_loads",
            source,
            to(with_toe(contact, toe, DAMPED, model)),
            functions.rising[end],
            role="soft",
            about=f"toe {leg}{toe} moves into the ground again: the damper acts",
        )
    elif state == DAMPED and model.ground_damper != TWO_SIDED:
        yield Transition(
            f"{name}_unloads",
            source,
            to(with_toe(contact, toe, UNDAMPED, model)),
            functions.rising[end],
            direction="rising",
            role="soft",
            about=f"toe {leg}{toe} moves out of the ground: the damper lets go",
        )
    if model.ground_damper == CLIPPED and state in (UNDAMPED, SLACK):
        falls = state == UNDAMPED
        yield Transition(
            f"{name}_{'slackens' if falls else 'presses'}",
            source,
            to(with_toe(contact, toe, SLACK if falls else UNDAMPED, model)),
            functions.pressing[end],
            direction="falling" if falls else "rising",
            role="soft",
            about=f"spring and damper would {'pull' if falls else 'push'} toe {leg}{toe} from here on",
        )
    if state in (UNDAMPED, SLACK) or model.ground_damper == TWO_SIDED:
        yield Transition(
            f"{name}_off",
            source,
            to(with_toe(contact, toe, OFF, model)),
            functions.height[end],
            direction="rising",
            about=f"toe {leg}{toe} lifts off",
            level=True,
        )


def _of_knee(
    leg: int,
    contact: LegContact,
    source: str,
    to: Callable[[LegContact], str],
    functions: Functions,
    model: Model,
) -> Iterator[Transition]:
    if contact.locked and model.knee_damper == REBOUND:
        back = contact.rebounds
        yield Transition(
            f"knee{leg}_{'returns' if back else 'rebounds'}",
            source,
            to(with_rebound(contact, not back)),
            functions.bending[leg],
            direction="falling" if back else "rising",
            role="soft",
            about=f"knee {leg} moves {'into' if back else 'off'} its stop",
        )
        if not back:
            return
    guard, target = functions.knee[leg], to(with_knee(contact, not contact.locked))
    if contact.locked:
        about = f"knee {leg} bends: its stop lets go"
        yield Transition(
            f"knee{leg}_unlocks", source, target, guard, direction="rising", about=about, level=True
        )
        return
    yield Transition(
        f"knee{leg}_locks",
        source,
        target,
        guard,
        about=f"knee {leg} straightens onto its stop",
        level=True,
    )


def _height(leg: int, toe: int, model: Model) -> Guard:
    def height(t: Any, x: Any, p: Any) -> Any:
        return toe_place(x, p, leg, toe, model)[1]

    return height


def _rising(leg: int, toe: int, model: Model) -> Guard:
    def rising(t: Any, x: Any, p: Any) -> Any:
        return toe_velocity(x, p, leg, toe, model)[1]

    return rising


def _knee(leg: int) -> Guard:
    place = KNEE[leg]

    def angle(t: Any, x: Any, p: Any) -> Any:
        return x[place]

    return angle


def _bending(leg: int) -> Guard:
    place = KNEE_RATE[leg]

    def rate(t: Any, x: Any, p: Any) -> Any:
        return x[place]

    return rate


def _pressing(leg: int, toe: int, model: Model) -> Guard:
    """What spring and damper of the ground do to a toe that moves out of it; the ground cannot pull."""

    def force(t: Any, x: Any, p: Any) -> Any:
        height, speed = toe_place(x, p, leg, toe, model)[1], toe_velocity(x, p, leg, toe, model)[1]
        return -(p.k_y * height + p.c_y_rebound * speed)

    return force


def _landed(leg: int, toe: int, model: Model) -> Callable[..., None]:
    """The anchor of the toe is put where it is; nothing else jumps."""
    a_side, a_down = anchor(leg, toe)

    def landed(t: Any, x: Any, p: Any, x_plus: Any) -> None:
        for i in range(len(STATES)):
            x_plus[i] = x[i]
        side, _, down = toe_place(x, p, leg, toe, model)
        x_plus[a_side] = side
        x_plus[a_down] = down

    return landed
