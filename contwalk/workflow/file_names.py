"""Names of files that belong to an output."""

from __future__ import annotations

from pathlib import Path

from contwalk.errors import DatabaseError

SUFFIX = ".h5"
_READ = "a run file or a plugin"
# What files are that end like this: databases are none of them. Those that a run reads are known by other
# means, and refused as what they are.
_OTHERS = {
    "a picture": (".png", ".pdf", ".svg", ".jpg", ".jpeg", ".eps", ".gif"),
    "a film or a page": (".mp4", ".html"),
    "a table": (".csv", ".json"),
    _READ: (".yaml", ".yml", ".py"),
}


def output_of(path: str | Path, *asked: str | None) -> Path:
    """The first output that is asked for, or that of a run file of which nothing is said.

    Raises
    ------
    DatabaseError
        If it is no name of a file: `.`, `..` or `/`, beside which files have no name either. If it ends as
        files of another kind do.
    """
    output = Path(next((name for name in asked if name), f"{Path(path).stem}{SUFFIX}"))
    if output.name in ("", ".."):
        raise DatabaseError(f"{output} is a directory.", "Name a file in it, such as run.h5.")
    for what, ends in _OTHERS.items():
        if output.suffix.lower() in ends and not (output.exists() and what == _READ):
            raise DatabaseError(
                f"The output {output} would be a database with the name of {what}.",
                f"Name it {output.with_suffix(SUFFIX).name}; figures and tables go beside it.",
            )
    return output


def beside(output: Path, what: str) -> Path:
    """`X_what` beside the output `X.h5`; `X.txt_what` beside `X.txt`, for X.h5 may have files of its own."""
    stem = output.stem if output.suffix == SUFFIX else output.name
    return output.with_name(f"{stem}_{what}")


def database_named(base: Path, name: str) -> Path:
    """The database that a run file in the folder `base` reads: beside the run file, or, where there is none,
    in the current directory, to which outputs go.
    """
    place, current = base / name, Path(name)
    return current if current.exists() and not place.exists() else place
