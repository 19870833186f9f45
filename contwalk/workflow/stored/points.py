"""A point of a database as a place to start from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contwalk.errors import StartError
from contwalk.problems.stored_word import StoredWord
from contwalk.storage import open_database
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
    word : StoredWord, optional
        Of a hybrid orbit.
    """

    state: np.ndarray
    parameters: dict[str, float]
    period: float
    word: StoredWord | None = None


def stored_point(file: Path, point: str, system: System) -> StoredPoint:
    """A point by its name (`b1/HB1`) or its number (`b1/12`).

    Raises
    ------
    DatabaseError, StartError
        If the file cannot be read, is of another system, or has no such point.
    """
    names = system.state_names
    with open_database(file) as db:
        branch_name, point_name = point.split("/")
        branch = db.branch(branch_name)
        if branch.info.states != names:
            raise StartError(
                f"{file} holds states {', '.join(branch.info.states)}, not {', '.join(names)}.",
                "Start from a database of the same system and model.",
            )
        if point_name.isdigit():
            if int(point_name) >= len(branch):
                raise StartError(
                    f"Branch {branch_name} of {file} has {len(branch)} points, numbered from 0.",
                    "Give one of them.",
                )
            row = branch.points[int(point_name)]
            state, period = np.array(row["state"]), float(row["period"])
            unknowns = branch.unknowns(int(point_name))
            stored = {**branch.info.parameters, **dict(zip(branch.info.free, row["free"], strict=True))}
        else:
            try:
                special = branch.special(point_name)
            except KeyError as error:
                raise StartError(f"{file}: {error.args[0]}") from error
            state = np.array([special.state[name] for name in names])
            period, unknowns = float(special.period or np.nan), np.array(special.unknowns)
            stored = dict(special.parameters)
    fold = int(branch.info.settings.get("fold", 1))
    known = {k: float(v) for k, v in stored.items() if k in system.parameter_names}
    word = None
    if branch.info.problem == "hybrid_orbit":
        kept = branch.info.settings
        named = str(kept.get("image", "")), tuple(kept.get("pins", ()))
        word = StoredWord(kept["legs"], branch.info.subharmonic, unknowns, *named)
    return StoredPoint(state, {**system.defaults(), **known}, fold * period, word)
