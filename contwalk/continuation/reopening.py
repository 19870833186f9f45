"""From a stored point back to the problem that it solves, and to its place on the branch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from contwalk.branch import Branch, BranchInfo, SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.neutral import UNDECLARED, constant
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.problem import Problem, Sample
from contwalk.system import Neutral, Symmetry, System
from contwalk.system.declarations import nearest

if TYPE_CHECKING:  # compiled flows are imported only where orbits are computed
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

T = TypeVar("T")


def problem_of(
    system: System, info: BranchInfo, state: np.ndarray, discretization: Discretization | None = None
) -> Equilibrium | PeriodicOrbit | HybridOrbit:
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

    Raises
    ------
    DatabaseError
        If the system is not the one of the branch.
    """
    _check_states(system, info)
    stored = info.settings
    path = stored.get("path")
    ends = None if path is None else (dict(path[0]), dict(path[1]))
    parameters = {name: float(info.parameters[name]) for name in system.parameter_names}
    pins, free = _pins(system, info), info.free[0]
    if info.problem == "equilibrium":
        return Equilibrium(system, parameters, free, ends, pins, state, discretization)
    if info.problem == "hybrid_orbit":
        from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
        from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies
        from contwalk.problems.hybrid.word import named_word

        word = named_word(system, stored["legs"], stored.get("image", ""))
        given = pins, state, info.subharmonic, discretization or Discretization()
        kind = SoftOrbit if applies(system, word) else HybridOrbit
        hybrid = kind(system, word, parameters, free, ends, *given)
        return hybrid.turning(np.array(stored["turns"], dtype=float)).with_room(int(stored.get("room", 1)))
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

    orbit = PeriodicOrbit(
        system, parameters, free, ends, pins, state, info.subharmonic, discretization or Discretization()
    )
    symmetry = _symmetry(system, info)
    turns = np.array(stored.get("turns") or np.zeros(len(info.states)), dtype=float)
    if symmetry is None and not np.any(turns):
        return orbit
    closed = orbit.closing(turns, symmetry, int(stored.get("power", 1)), int(stored.get("fold", 1)))
    return closed.alike(int(stored.get("parts", 1)))


def reopened(
    system: System,
    branch: Branch,
    point: str | int | SpecialPoint,
    discretization: Discretization | None = None,
) -> tuple[Problem, Sample]:
    """The problem discretised for a stored point, and the point's sample on it, facing growing arclength.

    Parameters
    ----------
    system : System
    branch : Branch
    point : str, int or SpecialPoint
        A special point or its name, or the number of a row.
    discretization : Discretization, optional
        Other steps than those the branch was computed with.

    Raises
    ------
    DatabaseError, NotFinite
        If the system is not the one of the branch, or the motion from there ends.
    """
    place = stored_place(branch, point)
    z, weights = place.z, place.weights
    problem = problem_of(system, branch.info, z[: len(branch.info.states)], discretization)
    there: Problem = problem.at_stored(z, weights)
    return there, there.examine(z, place.tangent, weights, there.linearize(z), place.unstable)


@dataclass(frozen=True)
class StoredPlace:
    """Solution, tangent and weights of a stored point, each of shape (N + 1,), and its unstable count."""

    z: np.ndarray
    tangent: np.ndarray
    weights: np.ndarray
    unstable: int


def stored_place(branch: Branch, point: str | int | SpecialPoint) -> StoredPlace:
    """Where a special point, or the row of a number, lies on its branch."""
    special = branch.special(point) if isinstance(point, str) else point
    index = special.index if isinstance(special, SpecialPoint) else special
    row = branch.points[index]
    if isinstance(special, SpecialPoint):
        z, tangent = np.array(special.unknowns), np.array(special.tangent)
    else:
        z = branch.unknowns(index)
        tangent = np.array(row["tangent"][: len(z)])
    return StoredPlace(z, tangent, np.array(row["weights"][: len(z)]), int(row["unstable"]))


def _check_states(system: System, info: BranchInfo) -> None:
    missing = [name for name in system.parameter_names if name not in info.parameters]
    if info.states != system.state_names or missing:
        raise DatabaseError(
            f"Branch {info.name} is of another system or model than '{system.name}'.",
            "Put the plugin back as it was when the database was computed.",
        )


def _pins(system: System, info: BranchInfo) -> list[Neutral]:
    """The neutral directions that were pinned along the branch."""
    declared = {pin.name: pin for pin in system.neutral}
    undeclared = iter(info.settings.get("undeclared", ()))
    pins = []
    for name in info.settings.get("pins", ()):
        if name == UNDECLARED:
            pins.append(constant(np.array(next(undeclared))))
            continue
        pins.append(_declared("neutral direction", name, declared))
    return pins


def _symmetry(system: System, info: BranchInfo) -> Symmetry | None:
    """The symmetry up to which the orbits of a branch close."""
    if info.closure in (None, "full"):
        return None
    return _declared("symmetry", str(info.closure), {s.name: s for s in system.symmetries})


def _declared(what: str, name: str, known: Mapping[str, T]) -> T:
    if name not in known:
        raise DatabaseError(
            f"The system no longer declares the {what} '{name}'.",
            f"Put the plugin back as it was. {nearest(name, list(known))}".strip(),
        )
    return known[name]
