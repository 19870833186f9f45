"""The motion along a stored orbit, by one verb."""

from __future__ import annotations

from contwalk.errors import ContwalkError
from contwalk.shortcuts.diagrams import DiagramFound
from contwalk.storage.file_database import FileDatabase
from contwalk.system import System
from contwalk.workflow.stored.orbit_motions import Motion, motion_along
from contwalk.workflow.stored.orbits import orbit_at


def motion(of: DiagramFound | FileDatabase, point: str, periods: int = 1) -> Motion:
    """The motion along an orbit of a diagram or a database, integrated once more, to an accuracy of 1e-7.

    Parameters
    ----------
    of : DiagramFound or FileDatabase
        What `cw.diagram` or `cw.open_database` gives; a plugin's code runs only where the database was opened
        with `trust=True`.
    point : str
        A special point or a row of a branch of orbits: `b2/PD1`, `b2/12`.
    periods : int
        How many of them.

    Returns
    -------
    Motion
        `times`, shape (k,), and `states`, (k, n); at an event, its instant twice, with the states on both
        sides. `events` are times and names, `period` is that of the orbit.

    Raises
    ------
    ContwalkError
        If there is no such point, or it is no orbit.
    """
    database = of.database if isinstance(of, DiagramFound) else of
    name, _, place = str(point).partition("/")
    known = database.branch_names()
    if name not in known or not place:
        raise ContwalkError(f"'{point}' is no point.", f"As in {known[0] if known else 'b1'}/3 or b1/HB1.")
    if not isinstance(periods, int) or periods < 1:
        raise ContwalkError(f"A motion over {periods} periods is none.", "Give a whole number from 1 up.")
    branch = database[name]
    if place.isdecimal():
        if int(place) >= len(branch):
            raise ContwalkError(f"Branch {name} has no row {place}.", f"They go from 0 to {len(branch) - 1}.")
        found = orbit_at(_system(of), branch, int(place))
    else:
        try:
            special = branch.special(place)
        except KeyError as error:
            raise ContwalkError(str(error.args[0]), "Name a special point, or the number of a row.") from None
        found = orbit_at(_system(of), branch, special)
    return motion_along(_system(of), found, periods)


def _system(of: DiagramFound | FileDatabase) -> System:
    return of.system if isinstance(of, DiagramFound) else of.system()
