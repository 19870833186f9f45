"""What a branch database has to do, and what every database does alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from contwalk import tables
from contwalk.branch import (
    Branch,
    BranchInfo,
    Outcome,
    SpecialPoint,
    along,
    named,
    narrowed,
)
from contwalk.branch_point import SpecialPoints
from contwalk.branch_words import small_diagram, table_of_branches
from contwalk.errors import DatabaseError
from contwalk.storage.schema import is_branch_name
from contwalk.system.declarations import nearest

INTERRUPTED = Outcome(
    "stopped",
    "interrupted",
    "The run ended before this branch did; every point computed until then is stored. "
    "Go on with: contwalk continue FILE --resume",
)


RUNNING = Outcome(
    "stopped",
    "interrupted",
    "This branch is still being computed by another process; these are its points until now.",
)


@dataclass(frozen=True)
class RunHeader:
    """What is true of a whole run.

    Parameters
    ----------
    system : str
        Name of the system.
    model : mapping
        Declared model choices.
    config : str
        Text of the run file.
    provenance : mapping
        Versions, platform, hash of the plugin's source, time, tolerances (plain JSON values).
    """

    system: str
    model: Mapping[str, Any] = field(default_factory=dict)
    config: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)


class Database(ABC):
    """A store of branches, open for a while; the rules are stated in `contwalk.storage`.

    Every method that names a branch raises `DatabaseError` for one that does not exist; every method that
    writes raises it for a database that is closed or open for reading only. Used as a context manager it is
    closed at the end.
    """

    @property
    @abstractmethod
    def header(self) -> RunHeader:
        """The header given at creation, or the last one written."""

    @property
    @abstractmethod
    def path(self) -> Path | None:
        """Where the database is; None in memory."""

    @abstractmethod
    def write_header(self, header: RunHeader) -> None:
        """Replace the header: a run goes on with other settings."""

    @abstractmethod
    def start_branch(self, info: BranchInfo) -> None:
        """Begin a branch. `DatabaseError` if its name is taken."""

    @abstractmethod
    def append(self, name: str, row: np.ndarray | np.void) -> None:
        """Append one point, a record of dtype `info.point_dtype()`, shape (1,) or ().

        `DatabaseError` on a finished branch.
        """

    @abstractmethod
    def append_special(self, name: str, point: SpecialPoint) -> None:
        """Append a special point, whose row was appended before."""

    @abstractmethod
    def finish(self, name: str, outcome: Outcome, cost: Mapping[str, float]) -> None:
        """Say how the branch ended and what it cost (`seconds`, `rhs`)."""

    @abstractmethod
    def drop_outcome(self, name: str) -> None:
        """Reopen a finished branch."""

    @abstractmethod
    def truncate(self, name: str, rows: int, specials: Sequence[int]) -> None:
        """Keep the first `rows` points, and the special points of these numbers, as they were appended."""

    @abstractmethod
    def drop(self, name: str) -> None:
        """Remove a branch."""

    @abstractmethod
    def rows(self, name: str) -> np.ndarray:
        """Points in the order of appending, shape (k,), of dtype `info.point_dtype()`."""

    @abstractmethod
    def specials(self, name: str) -> list[SpecialPoint]:
        """Special points in the order of appending."""

    @abstractmethod
    def branch_names(self) -> list[str]:
        """Names in the order of creation."""

    @abstractmethod
    def branch(self, name: str) -> Branch:
        """The branch with its points sorted by `s` and its special points named."""

    @abstractmethod
    def write_note(self, key: str, text: str) -> None:
        """Keep a text under a key; the last one counts, and an empty one takes it back."""

    @abstractmethod
    def notes(self) -> dict[str, str]:
        """All notes."""

    @abstractmethod
    def close(self) -> None:
        """Release the file. Closing twice is allowed."""

    def branches(self) -> list[Branch]:
        """All branches in the order of creation."""
        return [self.branch(name) for name in self.branch_names()]

    def point_names(self, branch: str) -> list[str]:
        """Names of the special points of a branch."""
        return [point.name for point in self.branch(branch).special_points]

    def __getitem__(self, name: str) -> Branch:
        """As `branch`."""
        return self.branch(name)

    def __iter__(self) -> Iterator[Branch]:
        """All branches, as `branches`."""
        return iter(self.branches())

    def __len__(self) -> int:
        """How many branches there are."""
        return len(self.branch_names())

    def __contains__(self, name: object) -> bool:
        """Whether there is a branch of this name."""
        return name in self.branch_names()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        """`<database cascade.h5 of autobalancer: b1 b2>`."""
        where = "in memory" if self.path is None else str(self.path)
        try:
            names = " ".join(self.branch_names())
        except DatabaseError:  # it is closed: that is no reason to fail here
            return f"<database {where}, closed>"
        return f"<database {where} of {self.header.system}: {names or 'no branches'}>"

    def _repr_html_(self) -> str:
        """The branches as a small diagram, and as a table of HTML."""
        branches = self.branches()
        return small_diagram(branches) + tables.html(repr(self)[1:-1], table_of_branches(branches))


def assemble(
    info: BranchInfo,
    rows: np.ndarray,
    specials: Sequence[SpecialPoint],
    end: tuple[Outcome, Mapping[str, float]] | None,
    running: bool = False,
) -> Branch:
    """A `Branch` from what is stored in the order of appending.

    `rows` are records of dtype `info.point_dtype()`, shape (k,).
    `end` is None while it is not finished; `running` says whether it still may be.
    """
    info, points = narrowed(info, along(rows))
    last = max(len(points) - 1, 0)
    # A special point behind the last row can only be the one whose row was torn: keep it on the branch.
    kept = named(list(specials), points)
    special_points = SpecialPoints(replace(point, index=min(point.index, last)) for point in kept)
    if end is None:
        cost = {"seconds": float(rows["seconds"].sum()), "rhs": int(rows["rhs"].sum())}
        return Branch(info, points, special_points, RUNNING if running else INTERRUPTED, cost, complete=False)
    return Branch(info, points, special_points, end[0], {"seconds": 0.0, "rhs": 0, **end[1]})


def checked_row(info: BranchInfo, row: np.ndarray | np.void) -> np.ndarray:
    """The row as an array of one record, shape (1,); refused unless it has exactly the announced columns."""
    record = np.asarray(row)
    if record.dtype != info.point_dtype() or record.size != 1:
        raise DatabaseError(
            f"A point of branch {info.name} has the columns {record.dtype} and the shape {record.shape}.",
            f"One record of the columns {info.point_dtype()} is allowed.",
        )
    return record.reshape(1)


def check_new_name(name: str, names: Sequence[str]) -> None:
    """Refuse a branch name that is taken, or that cannot be part of `branch/point`."""
    if name in names:
        raise DatabaseError(f"Branch '{name}' exists already.", "Drop it first, or choose another name.")
    if not is_branch_name(name):
        raise DatabaseError(
            f"A branch cannot be named '{name}'.", "Use a name such as b1, without '/' or a leading dot."
        )


def unknown_branch(
    name: str, names: Sequence[str], where: str, points: Callable[[str], Iterable[str]] = lambda branch: ()
) -> DatabaseError:
    """The error for a branch that does not exist; `points` gives the names of the special points of one."""
    known = f"Known: {', '.join(names)}." if names else "It has no branches."
    meant = [f"'{each}/{point}'" for each in names for point in points(each) if point.lower() == name.lower()]
    suggested = f"Did you mean {' or '.join(meant[:2])}?" if meant else nearest(name, names)
    return DatabaseError(f"{where} has no branch '{name}'.", f"{suggested} {known}".strip())


def finished(name: str) -> DatabaseError:
    """The error for writing to a finished branch."""
    return DatabaseError(
        f"Branch {name} is finished; nothing can be appended.", "Reopen it with drop_outcome first."
    )
