"""The plugin contract: how a machine is described.

A plugin is one Python file that exports `SYSTEM`. The functions have fixed signatures and write their
last argument; everything else is a declaration around them. See `docs/reference/plugin.md`.
"""

from contwalk.system.declarations import (
    Condition,
    Conserved,
    Mode,
    Neutral,
    Observable,
    Parameter,
    Signal,
    Start,
    State,
    Study,
    Symmetry,
    System,
    Transition,
)
from contwalk.system.family import Choice, Family
from contwalk.system.loading import list_systems, load_system

__all__ = [
    "Choice",
    "Condition",
    "Conserved",
    "Family",
    "Mode",
    "Neutral",
    "Observable",
    "Parameter",
    "Signal",
    "Start",
    "State",
    "Study",
    "Symmetry",
    "System",
    "Transition",
    "list_systems",
    "load_system",
]
