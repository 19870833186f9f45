"""Three-dimensional passive walker with a torso, knees and two toes on each foot, on compliant ground.

Equations, modes, parameters and observables: `docs/systems/walker3d.md`.
"""

from __future__ import annotations

from contwalk.system import Family, Mode, System

from .contacts import all_contacts, anchors_off, flags, mode_name, mode_words
from .drawing import make_draw
from .events import make_functions, make_transitions
from .falling import make_fallen
from .field import make_field
from .invariance import make_mirror, make_neutral
from .model import CHOICES, LOCKED, MIRRORED, Model
from .observables import make_observables, make_signals
from .parameters import make_parameters, make_presets
from .states import STATES
from .study import make_study

REFERENCE = (
    "J. Adolfsson (2000), 3D Passive Walkers: Code Implementation Issues, and "
    "Finding an Implementable 3D Passive Walker using Continuation Methods, KTH"
)


def build(**choices: str) -> System:
    """The walker of these model choices."""
    model = Model(**choices)
    torso = ("q4", "u4") if model.hip == LOCKED else ()
    states = tuple(state for state in STATES if state.name not in torso)
    contacts, field = tuple(all_contacts(model)), make_field(model)
    functions = make_functions(model)
    transitions = tuple(
        transition for each in contacts for transition in make_transitions(each, functions, model)
    )
    events = tuple(dict.fromkeys(transition.name for transition in transitions))
    return System(
        name="walker3d",
        about="three-dimensional passive walker with knees and two toes on each foot",
        states=STATES,
        parameters=make_parameters(model),
        modes=tuple(
            Mode(
                mode_name(each),
                field,
                about=mode_words(each),
                states=tuple(s.name for s in states if s.name not in anchors_off(each)),
                constants=flags(each, model),
            )
            for each in contacts
        ),
        transitions=transitions,
        symmetries=(make_mirror(contacts, events),) if model.legs == MIRRORED else (),
        neutral=make_neutral(model),
        observables=make_observables(model),
        signals=make_signals(model),
        presets=make_presets(model),
        draw=make_draw(model),
        fallen=make_fallen(model),
        study=make_study(model),
        reference=REFERENCE,
    )


SYSTEM = Family(
    name="walker3d",
    choices=CHOICES,
    build=build,
    about="three-dimensional passive walker with knees and two toes on each foot",
)
