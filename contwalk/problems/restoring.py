"""Problems from what is stored of their branches.

Each kind of solution has a function `restored(facts)`, in the module that stands beside its name below. The
engine names no kind: it asks here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, TypeVar

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.errors import DatabaseError
from contwalk.problems.held_quantities import held_quantity
from contwalk.problems.neutral import SUM, UNDECLARED, constant
from contwalk.problems.parameter_line import Ends
from contwalk.system import Neutral, System
from contwalk.system.declarations import nearest

T = TypeVar("T")

# Where problems of each kind are restored; imported when the first one is, as orbits need compiled flows.
RESTORED_BY = {
    "equilibrium": "contwalk.problems.equilibrium.restored",
    "periodic_orbit": "contwalk.problems.orbit.restored",
    "hybrid_orbit": "contwalk.problems.hybrid.restored",
    "locus": "contwalk.problems.locus.restored",
}


@dataclass(frozen=True)
class Facts:
    """What is stored of a branch, read for the system that it was computed with.

    `state`, shape (n,), is one on the branch, at which pins without a parameter hold their direction.
    """

    system: System
    info: BranchInfo
    parameters: dict[str, float]
    ends: Ends | None
    pins: list[Neutral]
    state: np.ndarray
    discretization: Any

    @property
    def free(self) -> str:
        """Name of the free parameter, or `path`."""
        return self.info.free[0]


def problem_of(system: System, info: BranchInfo, state: np.ndarray, discretization: Any = None) -> Any:
    """The equations of a stored branch; of orbits, not yet discretised (see `at_stored`, `adapted_to`).

    Parameters
    ----------
    system : System
        The one that the branch was computed with.
    info : BranchInfo
    state : ndarray, shape (n,)
        A state on the branch, at which pinned directions without a parameter are held. Another point of the
        branch holds them elsewhere: the same solutions, turned.
    discretization : Discretization, optional

    Returns
    -------
    Equilibrium, PeriodicOrbit, HybridOrbit or EquilibriumLocus

    Raises
    ------
    DatabaseError
        If the system is not the one of the branch.
    """
    _check_states(system, info)
    path = info.settings.get("path")
    ends = None if path is None else (dict(path[0]), dict(path[1]))
    parameters = {name: float(info.parameters[name]) for name in system.parameter_names}
    own = system.beginning_in(info.settings.get("mode"))
    facts = Facts(own, info, parameters, ends, pins_of(system, info), state, discretization)
    return import_module(RESTORED_BY[info.problem]).restored(facts)


def _check_states(system: System, info: BranchInfo) -> None:
    missing = [name for name in system.parameter_names if name not in info.parameters]
    if info.states != system.state_names or missing:
        raise DatabaseError(
            f"Branch {info.name} is of another system or model than '{system.name}'.",
            "Put the plugin back as it was when the database was computed.",
        )


def pins_of(system: System, info: BranchInfo) -> list[Neutral]:
    """The neutral directions that were pinned along the branch."""
    known = {pin.name: pin for pin in system.neutral}
    undeclared = iter(info.settings.get("undeclared", ()))
    pins = []
    for name in info.settings.get("pins", ()):
        if name in (UNDECLARED, SUM):
            pins.append(constant(np.array(next(undeclared)), name))
            continue
        if name in system.conserved_names:
            pins.append(held_quantity(system, name))
            continue
        pins.append(declared("neutral direction", name, known))
    return pins


def declared(what: str, name: str, known: Mapping[str, T]) -> T:
    """What the system declares under a name.

    Raises
    ------
    DatabaseError
        If it no longer does.
    """
    if name not in known:
        raise DatabaseError(
            f"The system no longer declares the {what} '{name}'.",
            f"Put the plugin back as it was. {nearest(name, list(known))}".strip(),
        )
    return known[name]
