"""Names of files that belong to an output."""

from __future__ import annotations

from pathlib import Path

from contwalk.errors import DatabaseError

SUFFIX = ".h5"


def output_of(path: str | Path, *asked: str | None) -> Path:
    """The first output that is asked for, or that of a run file of which nothing is said.

    Raises
    ------
    DatabaseError
        If it is no name of a file: `.`, `..` or `/`, beside which files have no name either.
    """
    output = Path(next((name for name in asked if name), f"{Path(path).stem}{SUFFIX}"))
    if output.name in ("", ".."):
        raise DatabaseError(f"{output} is a directory.", "Name a file in it, such as run.h5.")
    return output


def beside(output: Path, what: str) -> Path:
    """`X_what` beside the output `X.h5`; `X.txt_what` beside `X.txt`, for X.h5 may have files of its own."""
    stem = output.stem if output.suffix == SUFFIX else output.name
    return output.with_name(f"{stem}_{what}")
