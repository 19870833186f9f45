"""contwalk: pseudo-arclength continuation and bifurcation analysis of smooth and impacting machines.

The names below are the public interface; each is imported when it is first used, so that `import contwalk`
costs nothing.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from contwalk.version import __version__ as __version__

if TYPE_CHECKING:
    from contwalk.branch import Branch as Branch
    from contwalk.branch import SpecialPoint as SpecialPoint
    from contwalk.comparing.databases import diff as diff
    from contwalk.errors import ContwalkError as ContwalkError
    from contwalk.explorer.exploring import explore as explore
    from contwalk.plotting import plot_bifurcation_diagram as plot_bifurcation_diagram
    from contwalk.plotting import plot_eigenvalues as plot_eigenvalues
    from contwalk.plotting import plot_locus as plot_locus
    from contwalk.plotting import plot_stability_map as plot_stability_map
    from contwalk.plotting import save as save
    from contwalk.plugin_check.at_load import load_system as load_system
    from contwalk.plugin_check.at_load import system_from_text as system_from_text
    from contwalk.problems.equilibrium.equilibrium import Equilibrium as Equilibrium
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit as HybridOrbit
    from contwalk.problems.orbit.discretization import Discretization as Discretization
    from contwalk.problems.orbit.itinerary import Itinerary as Itinerary
    from contwalk.problems.orbit.itinerary import Leg as Leg
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit as PeriodicOrbit
    from contwalk.shortcuts.diagrams import DiagramFound as DiagramFound
    from contwalk.shortcuts.diagrams import diagram as diagram
    from contwalk.shortcuts.from_sympy import system_from_sympy as system_from_sympy
    from contwalk.shortcuts.models import model as model
    from contwalk.shortcuts.motions import motion as motion
    from contwalk.storage import open_database as open_database
    from contwalk.studies.loci import continue_locus as continue_locus
    from contwalk.studies.verbs import continue_branch as continue_branch
    from contwalk.studies.verbs import points as points
    from contwalk.studies.verbs import switch_branch as switch_branch
    from contwalk.workflow.run_file.reading import read_run_file as read_run_file
    from contwalk.workflow.runner import run as run

_HOMES = {
    "Branch": "contwalk.branch",
    "ContwalkError": "contwalk.errors",
    "Discretization": "contwalk.problems.orbit.discretization",
    "DiagramFound": "contwalk.shortcuts.diagrams",
    "Equilibrium": "contwalk.problems.equilibrium.equilibrium",
    "HybridOrbit": "contwalk.problems.hybrid.hybrid_orbit",
    "Itinerary": "contwalk.problems.orbit.itinerary",
    "Leg": "contwalk.problems.orbit.itinerary",
    "PeriodicOrbit": "contwalk.problems.orbit.periodic_orbit",
    "SpecialPoint": "contwalk.branch",
    "continue_branch": "contwalk.studies.verbs",
    "continue_locus": "contwalk.studies.loci",
    "diagram": "contwalk.shortcuts.diagrams",
    "diff": "contwalk.comparing.databases",
    "explore": "contwalk.explorer.exploring",
    "load_system": "contwalk.plugin_check.at_load",
    "model": "contwalk.shortcuts.models",
    "motion": "contwalk.shortcuts.motions",
    "open_database": "contwalk.storage",
    "plot_bifurcation_diagram": "contwalk.plotting",
    "plot_eigenvalues": "contwalk.plotting",
    "plot_locus": "contwalk.plotting",
    "plot_stability_map": "contwalk.plotting",
    "points": "contwalk.studies.verbs",
    "read_run_file": "contwalk.workflow.run_file.reading",
    "run": "contwalk.workflow.runner",
    "save": "contwalk.plotting",
    "switch_branch": "contwalk.studies.verbs",
    "system_from_sympy": "contwalk.shortcuts.from_sympy",
    "system_from_text": "contwalk.plugin_check.at_load",
}

__all__ = sorted(_HOMES)


class _Interface(ModuleType):
    """The package as a module whose public names stay what they are where a folder has the same name."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Interface


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'contwalk' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
