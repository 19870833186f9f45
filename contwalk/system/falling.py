"""That a machine has fallen, as an event in which its motions end."""

from __future__ import annotations

from contwalk.system.declarations import System, Transition
from contwalk.system.names import free_name

FALLEN = "fallen"


def name_of_fall(system: System) -> str:
    """`fallen`, or what is no transition's name."""
    return free_name(FALLEN, {transition.name for transition in system.transitions})


def falls(system: System) -> tuple[Transition, ...]:
    """A transition of that name out of each mode; none where the plugin does not say when it has fallen.

    It has fallen too where it begins to be in a mode like that.
    """
    fallen, name = system.fallen, name_of_fall(system)
    if fallen is None:
        return ()
    return tuple(
        Transition(name, mode.name, mode.name, fallen, "rising", level=True) for mode in system.modes
    )
