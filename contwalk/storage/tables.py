"""A run as tables: CSV files."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from contwalk.errors import DatabaseError
from contwalk.storage.csv_files import write_csv
from contwalk.storage.database import Database
from contwalk.storage.document import document
from contwalk.storage.failures import explained, refuse_existing

# Tables that are of no branch.
OWN = ("branches", "special_points")


def write_tables(db: Database, directory: str | Path, overwrite: bool = False) -> list[Path]:
    """Write `branches.csv`, `special_points.csv` and one table per branch, such as `b1.csv`.

    The directory is made where missing. Floats are written with as many digits as reading them back exactly
    needs.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    DatabaseError
        If tables of these names exist (unless `overwrite`), or the directory or a file cannot be written.
    """
    directory = Path(directory)
    if directory.exists() and not directory.is_dir():
        raise DatabaseError(
            f"{directory} is a file: tables are written into a directory, one for each branch.",
            "Name a directory, which is made where there is none.",
        )
    names = (*OWN, *db.branch_names())
    taken = [name.casefold() for name in names]
    for number, name in enumerate(names):
        if taken.index(name.casefold()) < number:
            raise DatabaseError(
                f"Branch '{name}' has a table of the same name as another one.",
                "Branches are named b1, b2 and so on by contwalk continue: compute the database again.",
            )
    refuse_existing([directory / f"{name}.csv" for name in names], overwrite, made=True)
    described = document(db)["branches"]
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise explained(directory, "create", error) from error
    written = [
        write_csv(directory / "branches.csv", *_table(map(_branch_row, described)), new=not overwrite),
        write_csv(directory / "special_points.csv", *_table(_special_rows(described)), new=not overwrite),
    ]
    for name in db.branch_names():
        columns = db.branch(name).columns()
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        written.append(write_csv(directory / f"{name}.csv", list(columns), rows, new=not overwrite))
    return written


def _branch_row(entry: Mapping[str, Any]) -> dict[str, Any]:
    row = {key: value for key, value in entry.items() if key not in ("special_points", "cost")}
    for key in ("free", "signature"):
        row[key] = " ".join(entry[key] or ())
    return row | {key: entry["cost"][key] for key in ("seconds", "rhs")}


def _special_rows(described: Sequence[Mapping[str, Any]]) -> Iterable[dict[str, Any]]:
    for entry in described:
        for point in entry["special_points"]:
            row = {"branch": entry["name"]}
            for key, value in point.items():
                if key in ("parameters", "state"):
                    row |= {f"{key}.{name}": number for name, number in value.items()}
                elif isinstance(value, list | dict):
                    row[key] = json.dumps(value)
                else:
                    row[key] = value
            yield row


def _table(rows: Iterable[Mapping[str, Any]]) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of a table whose rows may lack columns that others have."""
    rows = list(rows)
    header = list(dict.fromkeys(key for row in rows for key in row))
    return header, [[row.get(key) for key in header] for row in rows]
