"""Whether the declarations of a machine fit together."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import combinations
from typing import Any

from contwalk.column_names import COLUMN_OF_SPECTRUM, RESERVED
from contwalk.errors import SystemDefinitionError
from contwalk.labels import EVERY_MEANING
from contwalk.system.at_one_instant import before_others
from contwalk.system.declared import Declared
from contwalk.system.modes import Mode, Transition
from contwalk.system.names import article, is_number, nearest, shown
from contwalk.system.special_points import KindOfPoint
from contwalk.system.symmetries import Conserved, Neutral, Symmetry


def _identity(entry: Any) -> tuple[str, str]:
    """What no two declarations of a kind may share: a name, of transitions with the mode they leave."""
    if isinstance(entry, KindOfPoint):  # several may share a label
        return type(entry).__name__, ""
    return entry.name, entry.source if isinstance(entry, Transition) else ""


def entries_of(system: Declared, what: str, kind: type) -> tuple[Any, ...]:
    """The declarations of a kind.

    Raises
    ------
    SystemDefinitionError
        If they are something else, or two have one name.
    """
    entries = getattr(system, what)
    if isinstance(entries, kind):
        entries = (entries,)
    if not isinstance(entries, Iterable):
        raise SystemDefinitionError(
            f"System '{system.name}': {what} is {entries!r}.",
            f"It must be a tuple of {kind.__name__}(...), as in {what}=({kind.__name__}(...),).",
        )
    entries = tuple(entries)
    for entry in entries:
        if not isinstance(entry, kind):
            raise SystemDefinitionError(
                f"System '{system.name}': {what} contains {shown(entry)}.",
                f"Each entry must be a {kind.__name__}(...).",
            )
    twice = [key for key, count in Counter(_identity(entry) for entry in entries).items() if count > 1]
    if twice:
        where = f", both times from mode '{twice[0][1]}'" if twice[0][1] else ""
        raise SystemDefinitionError(
            f"System '{system.name}': {what} has '{twice[0][0]}' twice{where}.", "Names must differ."
        )
    return entries


def check_labels(system: Declared) -> None:
    """Refuse kinds of special points whose labels are none, or mean something else already.

    Raises
    ------
    SystemDefinitionError
    """
    for kind in system.point_types:
        label = getattr(kind, "label", None)
        if not isinstance(label, str) or not re.fullmatch("[A-Z]{2,8}", label):
            raise SystemDefinitionError(
                f"System '{system.name}': the label of {type(kind).__name__} is {shown(label)}.",
                'Write two to eight capital letters, as in label = "SQ".',
            )
        if label in EVERY_MEANING:
            raise SystemDefinitionError(
                f"System '{system.name}': {label}, the label of {type(kind).__name__}, is that of every "
                f"{EVERY_MEANING[label]}.",
                f"Choose another one; taken are {', '.join(EVERY_MEANING)}.",
            )


def check_references(system: Declared) -> None:
    """Refuse a machine whose declarations refer to what is not declared.

    Raises
    ------
    SystemDefinitionError
    """
    _check_names(system)
    for transition in system.transitions:
        _check_ends(system, transition)
        _check_relabel(system, transition)
    _check_orders(system)
    for mode in system.modes:
        _check_constants(system, mode)
    for symmetry in system.symmetries:
        _check_images(system, symmetry)
    for mode in system.modes:
        _check_states(system, mode)
    for quantity in system.conserved:
        _check_conserved(system, quantity)
    _check_places(system)
    for neutral in system.neutral:
        _check_neutral(system, neutral)


def _check_ends(system: Declared, transition: Transition) -> None:
    modes = [mode.name for mode in system.modes]
    for end in (transition.source, transition.target):
        if not isinstance(end, str) or end not in modes:
            raise SystemDefinitionError(
                f"Transition '{transition.name}' refers to mode {shown(end)}, which is not declared.",
                f"Modes are referred to by their names. Declared: {', '.join(modes)}. "
                f"{nearest(str(end), modes)}".strip(),
            )


def _check_constants(system: Declared, mode: Mode) -> None:
    for name in mode.constants:
        if name in system.parameter_names:
            raise SystemDefinitionError(
                f"Mode '{mode.name}' has the constant '{name}', which is a parameter.",
                "Rename one of them.",
            )
        if name in system.state_names:
            raise SystemDefinitionError(
                f"Mode '{mode.name}' has the constant '{name}', which is a state.",
                "Rename the constant: p is for parameters and constants, states are read as x[0].",
            )


def _check_states(system: Declared, mode: Mode) -> None:
    state_names = system.state_names
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


def _check_places(system: Declared) -> None:
    happening = list(dict.fromkeys(transition.name for transition in system.acting))
    places = {entry.name: entry.at for entry in system.conditions}
    places |= {entry.name: entry.at for entry in system.observables if entry.at is not None}
    for name, place in places.items():
        if place not in happening:
            raise SystemDefinitionError(
                f"'{name}' is taken at '{place}', which is no transition that acts.",
                f"Transitions that act: {', '.join(happening) or 'none'}.",
            )


def _check_neutral(system: Declared, neutral: Neutral) -> None:
    state_names, parameter_names = system.state_names, system.parameter_names
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


def _check_conserved(system: Declared, quantity: Conserved) -> None:
    what = f"Conserved quantity '{quantity.name}'"
    if system.period is not None:
        raise SystemDefinitionError(
            f"{what} belongs to a system with a period.",
            "What a forced machine conserves is not continued: leave conserved out.",
        )
    if isinstance(quantity.function, Mapping):
        modes = [mode.name for mode in system.modes]
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


def check_presets(system: Declared) -> None:
    """Refuse presets of what are no parameters.

    Raises
    ------
    SystemDefinitionError
    """
    if not isinstance(system.presets, Mapping):
        raise SystemDefinitionError(
            f"System '{system.name}': presets is {system.presets!r}.",
            "It must be a mapping, as in presets={'name': {'parameter': 1.0}}.",
        )
    for preset, values in system.presets.items():
        if not isinstance(values, Mapping):
            raise SystemDefinitionError(
                f"Preset '{preset}' is {values!r}.", "It must be a mapping: {'parameter': 1.0}."
            )
        for name, value in values.items():
            if name not in system.parameter_names:
                raise SystemDefinitionError(
                    f"Preset '{preset}' sets '{name}', which is not a parameter.",
                    nearest(str(name), system.parameter_names)
                    or f"Known: {', '.join(system.parameter_names)}.",
                )
            if not is_number(value):
                raise SystemDefinitionError(
                    f"Preset '{preset}' sets '{name}' to {value!r}.", "It must be a number."
                )


def _check_names(system: Declared) -> None:
    """A name stands for one thing in branches, tables and figures."""
    own = tuple(name for name in system.parameter_names if name not in system.conserved_names)
    kinds = {"state": system.state_names, "parameter": own, "conserved quantity": system.conserved_names}
    kinds |= {"observable": tuple(observable.name for observable in system.observables)}
    # Branches tell what must stay positive by its name, as an observable.
    watched = (transition.name for transition in system.transitions if transition.role == "watched")
    kinds |= {"condition": tuple(condition.name for condition in system.conditions)}
    kinds |= {"watched transition": tuple(dict.fromkeys(watched))}
    for kind, names in kinds.items():
        for name in names:
            if name in RESERVED or COLUMN_OF_SPECTRUM.fullmatch(name):
                raise SystemDefinitionError(
                    f"System '{system.name}' calls {article(kind)} '{name}', as contwalk calls a result.",
                    f"Rename the {kind}, as in '{name}_of_{system.name}'.",
                )
    kinds["signal"] = system.signal_names
    # An observable of a state's name is a measure of that state: `branch[name]` is the observable.
    allowed = {("state", "observable"), ("observable", "signal")}
    allowed |= {("condition", "signal"), ("watched transition", "signal")}  # the same along a motion
    for (kind, names), (other, others) in combinations(kinds.items(), 2):
        shared = next((name for name in names if name in others), None)
        if shared is not None and (kind, other) not in allowed:
            raise SystemDefinitionError(
                f"System '{system.name}': '{shared}' is {article(kind)} and {article(other)}.",
                "Rename one of them.",
            )


def _check_images(system: Declared, symmetry: Symmetry) -> None:
    events = {transition.name for transition in system.transitions}
    known = {"mode": {mode.name for mode in system.modes}, "transition": events}
    for what, images in (("mode", symmetry.modes), ("transition", symmetry.events)):
        for name in [*images, *images.values()]:
            if name not in known[what]:
                raise SystemDefinitionError(
                    f"Symmetry '{symmetry.name}' names the {what} '{name}', which is not declared.",
                    nearest(name, sorted(known[what])) or f"Name declared {what}s.",
                )


def _check_orders(system: Declared) -> None:
    """Refuse declared orders of transitions that are not declared, do not act, or go round in a circle."""
    acting = {transition.name for transition in system.acting}
    for transition in system.transitions:
        for name in transition.together:
            if name not in acting:
                raise SystemDefinitionError(
                    f"Transition '{transition.name}' has together={transition.together}, but '{name}' is no "
                    "transition that acts.",
                    nearest(name, sorted(acting)) or f"Transitions that act: {', '.join(sorted(acting))}.",
                )
    names = ", ".join(
        f"'{name}'" for name, earlier in before_others(system.transitions).items() if name in earlier
    )
    if names:
        raise SystemDefinitionError(
            f"System '{system.name}': the orders declared by together contradict each other: by them each of "
            f"{names} comes before itself.",
            "Declare one order of them.",
        )


def _check_relabel(system: Declared, transition: Transition) -> None:
    known = [symmetry.name for symmetry in system.symmetries if symmetry.role == "relabel"]
    if transition.relabel is not None and transition.relabel not in known:
        raise SystemDefinitionError(
            f"Transition '{transition.name}' relabels by '{transition.relabel}', which is no symmetry of "
            "role 'relabel'.",
            f"Declared: {', '.join(known) or 'none'}.",
        )
