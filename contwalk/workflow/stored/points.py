"""A point of a database as a place to start from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.stored_itinerary import StoredItinerary
from contwalk.storage import FileDatabase, open_database
from contwalk.system import System


@dataclass(frozen=True, eq=False)
class StoredPoint:
    """What a database says of a point.

    Parameters
    ----------
    state : ndarray, shape (n,)
    parameters : dict
        All of the system's: its defaults where the database has none.
    period : float
        Of the whole orbit; NaN for an equilibrium.
    itinerary : StoredItinerary, optional
        Of a hybrid orbit.
    mode : str, optional
        Of an equilibrium of a machine with several.
    """

    state: np.ndarray
    parameters: dict[str, float]
    period: float
    itinerary: StoredItinerary | None = None
    mode: str | None = None


def stored_point(file: Path, point: str, system: System) -> StoredPoint:
    """A point by its name (`b1/HB1`) or its number (`b1/12`).

    Raises
    ------
    DatabaseError, StartError
        If the file cannot be read, is of another system, or has no such point.
    """
    with open_database(file) as db:
        branch = branch_of(db, file, point, system)
        place = place_of(branch, file, point)
        if isinstance(place, int):
            row = branch.points[place]
            state, period, unknowns = np.array(row["state"]), float(row["period"]), branch.unknowns(place)
            stored = branch.parameters_at(place)
        else:
            state = np.array([place.state[name] for name in system.state_names])
            period, unknowns = float(place.period or np.nan), np.array(place.unknowns)
            stored = dict(place.parameters)
    fold = int(branch.info.settings.get("fold", 1))
    known = {k: float(v) for k, v in stored.items() if k in system.parameter_names}
    itinerary = None
    if branch.info.problem == "hybrid_orbit":
        kept = branch.info.settings
        named = str(kept.get("image", "")), tuple(kept.get("pins", ()))
        itinerary = StoredItinerary(kept["legs"], branch.info.subharmonic, unknowns, *named)
    mode = branch.info.settings.get("mode")
    return StoredPoint(state, {**system.defaults(), **known}, fold * period, itinerary, mode)


def branch_of(db: FileDatabase, file: Path, point: str, system: System) -> Branch:
    """The branch that a point lies on, given as `b1/HB1` or `b1/12`.

    Raises
    ------
    DatabaseError, StartError
        If the file has no such branch, or is of another system.
    """
    branch = db.branch(point.partition("/")[0])
    if branch.info.states != system.state_names:
        raise StartError(
            f"{file} holds states {', '.join(branch.info.states)}, not {', '.join(system.state_names)}.",
            "Name a database of the same system and model.",
        )
    return branch


def place_of(branch: Branch, file: Path, point: str) -> SpecialPoint | int:
    """The special point that `b1/HB1` names, or the number of the row that `b1/12` does.

    Raises
    ------
    StartError
        If the branch has none.
    """
    name = point.partition("/")[2]
    if not name.isdigit():
        try:
            return branch.special(name)
        except KeyError as error:
            raise StartError(f"{file}: {error.args[0]}") from error
    if int(name) >= len(branch):
        raise StartError(
            f"Branch {branch.name} of {file} has {len(branch)} points, numbered from 0.", "Give one of them."
        )
    return int(name)
